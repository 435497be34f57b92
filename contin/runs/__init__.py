"""Run files: what they may say, and carrying them out."""
