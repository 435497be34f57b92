"""Folds, period doublings, tori and branch points of a family: equations, borders, verification."""
