"""Periodic orbits of flows whose states jump at events: fixed points of the map from jump to jump, and their families."""
