"""Formulas of other languages as trees, and trees as text in contin's grammar."""
