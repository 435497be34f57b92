"""Curves of special solutions: equations of any discretisation, and scalars that vanish along the curve."""
