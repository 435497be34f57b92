"""The type of libsbml's objects, which have no annotations."""

from typing import Any, TypeAlias

Element: TypeAlias = Any
"""A document, a model, an element of it, or a node of its MathML."""
