"""Periodic orbits of flows whose states jump at events: fixed points of maps from jump to jump."""
