"""Branches and diagrams in one picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from contin.continuation.branch import Branch
from contin.diagram.diagram import Diagram
from contin.errors import InputError
from contin.plot.figure import picture_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw(*results: object, ax: Axes | None = None, **options: object) -> Figure:
    """A matplotlib figure of branches, diagrams and lists of them together: solid stable, dashed unstable.

    ax : draw into these axes instead.  options : x, y, labels, limits, log, size, legend, title, style
    (`contin.plot.look.Look`). Curves in two parameters have panels of their own. Raises InputError.
    """
    branches = list(_branches(results))
    if not branches:
        raise InputError("there is nothing to draw: give branches or diagrams")
    return picture_of(branches, ax, options)


def _branches(results: Iterable[object]) -> Iterable[Branch]:
    for result in results:
        if isinstance(result, Branch):
            yield result
        elif isinstance(result, Diagram):
            yield from result.branches
        elif isinstance(result, list | tuple):
            yield from _branches(result)
        else:
            raise InputError(f"draw takes branches and diagrams; got {type(result).__name__}")
