"""Hysteresis sweeps drawn as triangles that point the way the parameter went, alone or over a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.errors import InputError
from contin.model.advice import closest
from contin.plot.canvas import canvas, finish, fixed, several
from contin.plot.dress import dress
from contin.plot.figure import figure as diagram_figure
from contin.plot.figure import image_names
from contin.plot.house_style import chosen_palette, style
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.series import from_document, panels
from contin.plot.vocabulary import PALETTE
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ON_DIAGRAM: tuple[str, str] = ("0.1", "0.5")  # the diagram has the colours


def figure(
    columns: Record, parameter: str, names: Sequence[str], *, look: Look = PLAIN_LOOK, ax: Axes | None = None,
    over: Record | None = None,
) -> Figure:  # fmt: skip
    """Largest and smallest value of quantities (default: the first) against the parameter, a panel each.

    over : a result document; its diagram of the quantity is drawn beneath (of orbits, their column y.max).
    ax : draw one quantity into these axes instead.
    """
    fixed(look, "a sweep", parameter)
    shown = several(look.y) or [names[0]]
    for quantity in shown:
        if quantity not in names:
            advice = closest(quantity, names) or f"there are {', '.join(names)}"
            raise InputError(f"there is no quantity {quantity!r} in the sweep: {advice}")
    look.check_columns([parameter, *shown])
    with style(look.style):
        if over is not None:
            drawing, axes = _diagram(over, parameter, shown, look, ax)
        else:
            drawing, axes = canvas(look, ax, shown, (max(5.4, 4.4 * len(shown)), 4.0))
        colours: Sequence[str] = chosen_palette(PALETTE) if over is None else ON_DIAGRAM
        for one, quantity in zip(axes, shown, strict=True):
            _triangles(one, columns, parameter, quantity, colours)
            dress(one, look, parameter, quantity)
        handles, words = axes[0].get_legend_handles_labels()
        if over is None:
            finish(drawing, axes, look, ax, handles, words)
        elif look.legend != "none" and handles:  # the lines of the diagram have theirs
            if earlier := axes[0].get_legend():
                axes[0].add_artist(earlier)
            axes[0].legend(handles, words, loc="best", framealpha=0.9, fontsize=6.5, ncols=2)
    return drawing


def drawn(
    columns: Record, parameter: str, names: Sequence[str], ax: Axes | None, options: Mapping[str, object]
) -> Figure:
    """`figure` with the options as a user writes them."""
    return figure(columns, parameter, names, look=Look.of(options), ax=ax)


def _triangles(ax: Axes, columns: Record, parameter: str, quantity: str, colours: Sequence[str]) -> None:
    """Filled at the largest value, open at the smallest."""
    values, directions = np.asarray(columns[parameter]), np.asarray(columns["direction"])
    for direction, marker, colour, words in ((1, "^", colours[0], "up"), (-1, "v", colours[1], "down")):
        chosen = directions == direction
        if not np.any(chosen):
            continue
        for what, face in (("max", colour), ("min", "none")):
            ax.plot(
                values[chosen], np.asarray(columns[f"{quantity}.{what}"], dtype=float)[chosen], marker,
                markersize=4.0, markerfacecolor=face, markeredgecolor=colour, markeredgewidth=0.8, linestyle="none",
                label=f"sweep {words}: {what}",
            )  # fmt: skip


def _diagram(
    over: Record, parameter: str, shown: Sequence[str], look: Look, ax: Axes | None
) -> tuple[Figure, list[Axes]]:
    """The branches beneath, with axes for the sweep's quantities."""
    sources = from_document(over)
    if not sources:
        raise InputError("the results to draw over hold no branch")
    model = over["model"]
    drawing = diagram_figure(
        panels(sources, x=parameter, y=list(shown), periods=model.get("periods"), units=model.get("units")),
        look=replace(look, x=None, y=None), images=image_names(sources), periods=model.get("periods"), ax=ax,
    )  # fmt: skip
    return drawing, [ax] if ax is not None else list(drawing.axes)
