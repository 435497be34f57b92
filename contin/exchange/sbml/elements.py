"""The type of libsbml's objects, which have no annotations."""

from typing import Any, TypeAlias

Element: TypeAlias = Any
"""A document, a model, an element of it, or a node of its MathML."""


def assigned(model: Element) -> frozenset[str]:
    """Identifiers that events assign."""
    return frozenset(
        a.getVariable() for event in model.getListOfEvents() for a in event.getListOfEventAssignments() if a.isSetMath()
    )
