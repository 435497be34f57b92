"""Hysteresis sweeps drawn as triangles that point the way the parameter went, alone or over a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.errors import InputError
from contin.plot.figure import figure as diagram_figure
from contin.plot.figure import image_names
from contin.plot.house_style import style
from contin.plot.look import Look
from contin.plot.series import from_document, panels
from contin.plot.vocabulary import PALETTE
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UP, DOWN = PALETTE[0], PALETTE[1]
ON_DIAGRAM, ON_DIAGRAM_DOWN = "0.1", "0.5"  # the diagram has the colours


def figure(
    columns: Record, parameter: str, names: Sequence[str], *, title: str | None = None, y: str | None = None,
    over: Record | None = None,
) -> Figure:  # fmt: skip
    """Largest and smallest value of quantity y (default: the first) against the parameter.

    over : a result document; its diagram of y is drawn beneath (of orbits, their column y.max).
    """
    from contin.plot.picture import picture

    quantity = y or names[0]
    if quantity not in names:
        raise InputError(f"there is no quantity {quantity!r} in the sweep; there are {', '.join(names)}")
    with style():
        if over is None:
            drawing: Figure = picture(5.4, 4.0)
            ax = drawing.subplots()
            ax.set_xlabel(parameter)
            ax.set_ylabel(quantity)
            if title:
                drawing.suptitle(title, fontsize=10)
        else:
            drawing, ax = _diagram(over, parameter, quantity, title)
        values, directions = np.asarray(columns[parameter]), np.asarray(columns["direction"])
        colours = (UP, DOWN) if over is None else (ON_DIAGRAM, ON_DIAGRAM_DOWN)
        for direction, marker, colour, words in ((1, "^", colours[0], "up"), (-1, "v", colours[1], "down")):
            chosen = directions == direction
            if not np.any(chosen):
                continue
            for what, face in (("max", colour), ("min", "none")):
                ax.plot(
                    values[chosen], np.asarray(columns[f"{quantity}.{what}"])[chosen], marker, markersize=4.0,
                    markerfacecolor=face, markeredgecolor=colour, markeredgewidth=0.8, linestyle="none",
                    label=f"sweep {words}: {what}",
                )  # fmt: skip
        if over is None:
            drawing.legend(loc="outside lower center", ncols=4, frameon=False)
        else:
            ax.legend(loc="best", framealpha=0.9, fontsize=6.5, ncols=2)
    return drawing


def _diagram(over: Record, parameter: str, quantity: str, title: str | None) -> tuple[Figure, Any]:
    sources = from_document(over)
    if not sources:
        raise InputError("the results to draw over hold no branch")
    model = over["model"]
    drawing = diagram_figure(
        panels(sources, x=parameter, y=quantity, periods=model.get("periods"), units=model.get("units")),
        look=Look(title=title), images=image_names(sources), periods=model.get("periods"),
    )  # fmt: skip
    return drawing, drawing.axes[0]
