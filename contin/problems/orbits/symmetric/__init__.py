"""Declared symmetries acting on orbits."""
