"""Compiled numerics (numba): dense algebra, eigenvalues, marching; a model reaches them as a pointer."""
