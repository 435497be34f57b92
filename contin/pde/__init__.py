"""Partial differential equations on intervals, rectangles and circles, as ordinary large sparse systems."""
