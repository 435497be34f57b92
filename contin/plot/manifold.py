"""Manifolds: the orbits on them, in space where there are three states or more, else in the plane."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.errors import InputError
from contin.plot.house_style import style
from contin.plot.vocabulary import PALETTE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from contin.plot.series import Source

OWN: Final = ("orbit", "angle", "s", "t")  # columns that are no states
THIN, THICK = 0.5, 1.1


def figure(sources: Sequence[Source], *, title: str | None = None, axes: Sequence[str] = ()) -> Figure:
    """Curves as lines, surfaces as the orbits on them; `axes` : two or three columns, by default the first states."""
    from contin.plot.picture import picture

    states = [name for name in sources[0].columns if name not in OWN]
    shown = list(axes) or states[:3]
    for name in shown:
        if name not in sources[0].columns:
            raise InputError(f"there is no column {name!r} to draw; there are {', '.join(sources[0].columns)}")
    if len(shown) < 2:
        raise InputError("a manifold is drawn in two or three columns; this model has one state")
    with style():
        drawing = picture(6.4, 5.6 if len(shown) > 2 else 4.4)
        ax: Any = drawing.add_subplot(projection="3d") if len(shown) > 2 else drawing.add_subplot()
        for k, source in enumerate(sources):
            surface = "angle" in source.columns
            orbit = np.asarray(source.columns["orbit"])
            pieces = [np.flatnonzero(orbit == one) for one in np.unique(orbit)] if surface else [np.arange(len(orbit))]
            for row, piece in enumerate(pieces):
                line = [np.asarray(source.columns[name], dtype=float)[piece] for name in shown]
                label = source.name if row == 0 else None
                width, alpha = (THIN, 0.6) if surface else (THICK, 1.0)
                ax.plot(*line, color=PALETTE[k % len(PALETTE)], linewidth=width, alpha=alpha, label=label)
        ax.set_xlabel(shown[0])
        ax.set_ylabel(shown[1])
        if len(shown) > 2:
            ax.set_zlabel(shown[2])
            ax.set_box_aspect(None, zoom=0.85)
        drawing.legend(loc="outside lower right", ncols=3, frameon=False)
        if title:
            drawing.suptitle("\n".join(textwrap.wrap(title, int(12.0 * drawing.get_figwidth()))), fontsize=10)
    return drawing
