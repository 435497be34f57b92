"""Models in the formats of other programs: read into plain model documents, written from models."""
