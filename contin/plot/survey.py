"""A survey as bars: how far each parameter may go, as a ratio to its value, before something happens."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.plot.house_style import style
from contin.plot.vocabulary import colour_of, style_of
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

LINE: Final = 0.21  # inches a parameter
MOST: Final = 60  # parameters in a panel: those to which something happens first


def figure(document: Record) -> Figure:
    """One panel an attractor, the parameter that matters most on top; a marker where a bifurcation ends the bar."""
    from contin.plot.picture import picture

    columns, names = document["survey"], list(document["attractors"])
    rows = {name: [k for k, a in enumerate(columns["attractor"]) if a == name][:MOST] for name in names}
    height = 1.3 + LINE * max((len(r) for r in rows.values()), default=1)
    with style():
        drawing = picture(1.4 + 4.2 * len(names), max(height, 2.2))
        axes = drawing.subplots(1, len(names), squeeze=False)[0]
        seen: dict[str, Line2D] = {}
        for ax, name in zip(axes, names, strict=True):
            _panel(ax, columns, rows[name], float(document["factor"]), seen)
            ax.set_title(name if len(names) > 1 else "", fontsize=9)
        drawing.suptitle(document["model"], fontsize=10)
        if seen:
            drawing.legend(
                list(seen.values()), [style_of(code).words for code in seen], loc="outside lower center",
                ncols=min(3, len(seen)), frameon=False, fontsize=8,
            )  # fmt: skip
    return drawing


def _panel(ax: Axes, columns: Record, rows: list[int], factor: float, seen: dict[str, Line2D]) -> None:
    ax.set_xscale("log")
    for position, k in enumerate(rows):
        value = columns["value"][k]
        ends = []
        for side, limit in (("below", 1.0 / factor), ("above", factor)):
            ratio = abs(columns[side][k] / value) if value else limit
            ratio = float(np.clip(ratio, 1.0 / factor, factor)) or limit
            ends.append(ratio)
            code = columns[f"{side}.type"][k]
            if code:
                style = style_of(code)
                (mark,) = ax.plot(
                    ratio, position, style.marker, color=colour_of(code), markersize=5.5, zorder=3, linestyle="none",
                    markeredgecolor="white", markeredgewidth=0.5,
                )  # fmt: skip
                seen.setdefault(code, mark)
            elif columns[f"{side}.end"][k] not in ("bound",):
                ax.plot(ratio, position, "|", color="0.3", markersize=8, zorder=3)
        ax.plot(ends, [position, position], "-", color="0.75", linewidth=5.0, solid_capstyle="butt", zorder=1)
    ax.axvline(1.0, color="0.2", linewidth=0.8, zorder=2)
    ax.set_yticks(range(len(rows)), [columns["parameter"][k] for k in rows], fontsize=8)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlim(0.9 / factor, 1.1 * factor)
    ax.set_xlabel("parameter / its value")
    for spine in ("top", "right", "left"):
        ax.spines[spine].set_visible(False)
    ax.tick_params(axis="y", length=0)
