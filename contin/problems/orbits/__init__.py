"""Periodic orbits: collocation, special points, ends, starts."""
