"""Curves of special solutions in two and three parameters, and the points of codimension two on them."""
