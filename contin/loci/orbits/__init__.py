"""Curves of folds, period doublings and torus bifurcations of periodic orbits in two parameters."""
