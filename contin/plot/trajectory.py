"""Time series beside a phase portrait."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.errors import InputError
from contin.plot.dress import dress
from contin.plot.house_style import chosen_size, style
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.vocabulary import PALETTE
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MANY: Final = 500  # points of a section, drawn smaller
MOST_PANELS: Final = 6  # states drawn against time


def figure(
    columns: Record, states: Sequence[str], *, look: Look = PLAIN_LOOK, closed: bool = False, ax: Axes | None = None,
    section: Record | None = None,
) -> Figure:  # fmt: skip
    """Each of the first states against t, and column y against column x (default: the first two states).

    columns : "t" and everything that may be drawn, of equal length. One state alone is drawn against time only.
    closed : a periodic orbit, which has no start and no end.
    ax : draw y over x into these instead (one state: over t).
    section : the same columns at the crossings of a Poincare section, which are the portrait then.
    """
    chosen = [look.y] if isinstance(look.y, str) else list(look.y or [])
    for name in (look.x, *chosen):
        if name is not None and name not in columns:
            raise InputError(f"there is no column {name!r} to draw; there are {', '.join(columns)}")
    shown = (chosen if len(chosen) > 1 else list(states))[:MOST_PANELS]
    across, up = _portrait_axes(look.x, chosen, states)
    look.check_columns(["t", *shown, across, *([up] if up else [])])
    if ax is not None:
        return _into(ax, columns, look, (across, up) if up else ("t", across), closed, section)
    from contin.plot.picture import picture

    with style(look.style):
        width, height = look.size or chosen_size(8.8 if up else 5.6, max(3.4, 1.15 * len(shown)))
        drawing = picture(width, height)
        grid = drawing.add_gridspec(len(shown), 2 if up else 1, width_ratios=[1.5, 1.0] if up else [1.0])
        _series(drawing, grid, columns, shown, look)
        if up:
            _portrait(drawing.add_subplot(grid[:, 1]), columns, look, across, up, closed, section)
            if not closed and look.legend == "below":
                drawing.legend(loc="outside lower right", ncols=2, frameon=False)
            elif not closed and look.legend == "inside":
                drawing.axes[-1].legend(loc="best")
        if look.title:
            drawing.suptitle("\n".join(textwrap.wrap(look.title, int(12.0 * width))), fontsize="large")
    return drawing


def _portrait_axes(x: str | None, chosen: Sequence[str], states: Sequence[str]) -> tuple[str, str | None]:
    """What the portrait shows: of several y without x the first two; no column over itself unless it is asked for."""
    if x is None and len(chosen) > 1:
        return chosen[0], chosen[1]
    up = chosen[0] if chosen else next((name for name in states if name != (x or states[0])), None)
    return x or next((name for name in states if name != up), states[0]), up


def drawn(
    columns: Record, states: Sequence[str], ax: Axes | None, options: Mapping[str, object], closed: bool = False,
    section: Record | None = None,
) -> Figure:  # fmt: skip
    """`figure` with the options as a user writes them."""
    return figure(columns, states, look=Look.of(options), closed=closed, ax=ax, section=section)


def _into(
    ax: Axes, columns: Record, look: Look, names: tuple[str, str], closed: bool, section: Record | None
) -> Figure:
    """Draw one panel into the user's axes."""
    with style(look.style):
        _portrait(ax, columns, look, *names, closed, section)
        if look.title:
            ax.set_title(look.title)
    drawing = ax.get_figure(root=True)
    assert drawing is not None
    return drawing


def _series(drawing: Figure, grid: Any, columns: Record, shown: Sequence[str], look: Look) -> None:
    """Each column against time, one above the other."""
    first: Any = None
    for k, name in enumerate(shown):
        ax = drawing.add_subplot(grid[k, 0], sharex=first)
        first = first or ax
        ax.plot(columns["t"], columns[name], color=PALETTE[k % len(PALETTE)], linewidth=0.9)
        ax.margins(x=0.01)
        dress(ax, look, "t", name)
        if k < len(shown) - 1:
            ax.tick_params(labelbottom=False)
            ax.set_xlabel("")


def _portrait(
    ax: Axes, columns: Record, look: Look, across: str, up: str, closed: bool, section: Record | None
) -> None:
    shown = columns if section is None else section
    u, v = np.asarray(shown[across]), np.asarray(shown[up])
    if section is None:
        ax.plot(u, v, color=PALETTE[0], linewidth=0.8)
    else:
        ax.plot(u, v, ".", color=PALETTE[0], markersize=3.0 if len(u) < MANY else 1.5, label="section")
    if section is None and len(u) and not closed:
        ax.plot(u[:1], v[:1], "o", color="white", markeredgecolor="black", markersize=5, label="start")
        ax.plot(u[-1:], v[-1:], "o", color="black", markersize=4, label="end")
    dress(ax, look, across, up)
