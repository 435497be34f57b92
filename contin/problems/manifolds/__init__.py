"""Stable and unstable manifolds of equilibria and fixed points."""
