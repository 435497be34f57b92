"""Families of periodic orbits by shooting: smooth and piecewise-smooth flows, one segment or several."""
