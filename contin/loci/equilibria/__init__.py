"""Curves of special points of equilibria and fixed points in two parameters."""
