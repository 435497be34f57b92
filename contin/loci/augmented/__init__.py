"""Equations of any discretisation that solve bordered systems, and scalars that vanish along the curve."""
