"""Diagrams as data series, drawn by matplotlib or as interactive HTML."""
