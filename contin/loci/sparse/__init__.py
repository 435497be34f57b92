"""Curves of folds and Hopf points of large systems in two parameters."""
