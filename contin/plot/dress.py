"""What a user says of a picture's axes, for pictures of every kind: limits, logarithmic scales, names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.plot.look import Look
from contin.plot.typeset import typeset

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def dress(ax: Axes, look: Look, x: str, y: str) -> None:
    """Names, scales and limits of axes that show column y over column x."""
    ax.set_xlabel(typeset(x))
    ax.set_ylabel(typeset(y))
    if x in look.log:
        ax.set_xscale("log")
    if y in look.log:
        ax.set_yscale("log")
    if x in look.limits:
        ax.set_xlim(*look.limits[x])
    if y in look.limits:
        ax.set_ylim(*look.limits[y])
