"""Curves of special periodic orbits in two parameters, the orbits found by shooting."""
