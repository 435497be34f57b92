"""Coefficients at special points and what they mean."""
