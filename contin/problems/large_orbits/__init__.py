"""Periodic orbits of large systems: collocation whose linear systems are solved interval by interval."""
