"""Time series beside a phase portrait."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.errors import InputError
from contin.plot.house_style import style
from contin.plot.vocabulary import PALETTE
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_PANELS: Final = 6  # states drawn against time


def figure(
    columns: Record, states: Sequence[str], *, title: str | None = None, x: str | None = None,
    y: str | None = None, closed: bool = False,
) -> Figure:  # fmt: skip
    """Each of the first states against t, and column y against column x (default: the first two states).

    columns : "t" and everything that may be drawn, of equal length. One state alone is drawn against time only.
    closed : a periodic orbit, which has no start and no end.
    """
    from contin.plot.picture import picture

    for name in (x, y):
        if name is not None and name not in columns:
            raise InputError(f"there is no column {name!r} to draw; there are {', '.join(columns)}")
    shown = list(states)[:MOST_PANELS]
    across = x or states[0]
    up = y or (states[1] if len(states) > 1 else None)
    with style():
        drawing = picture(8.8 if up else 5.6, max(3.4, 1.15 * len(shown)))
        grid = drawing.add_gridspec(len(shown), 2 if up else 1, width_ratios=[1.5, 1.0] if up else [1.0])
        first: Any = None
        for k, name in enumerate(shown):
            ax = drawing.add_subplot(grid[k, 0], sharex=first)
            first = first or ax
            ax.plot(columns["t"], columns[name], color=PALETTE[k % len(PALETTE)], linewidth=0.9)
            ax.set_ylabel(name)
            if k < len(shown) - 1:
                ax.tick_params(labelbottom=False)
            else:
                ax.set_xlabel("t")
            ax.margins(x=0.01)
        if up:
            ax = drawing.add_subplot(grid[:, 1])
            u, v = np.asarray(columns[across]), np.asarray(columns[up])
            ax.plot(u, v, color=PALETTE[0], linewidth=0.8)
            if len(u) and not closed:
                ax.plot(u[:1], v[:1], "o", color="white", markeredgecolor="black", markersize=5, label="start")
                ax.plot(u[-1:], v[-1:], "o", color="black", markersize=4, label="end")
            ax.set_xlabel(across)
            ax.set_ylabel(up)
            if not closed:
                drawing.legend(loc="outside lower right", ncols=2, frameon=False)
        if title:
            drawing.suptitle(title, fontsize=10)
    return drawing
