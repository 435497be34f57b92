"""XPPAUT's .ode files."""
