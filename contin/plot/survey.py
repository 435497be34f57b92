"""A survey as bars: how far each parameter may go, as a ratio to its value, before something happens."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.errors import InputError
from contin.plot.canvas import canvas, finish, fixed, several
from contin.plot.house_style import style
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.vocabulary import colour_of, style_of
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

RATIO: Final = "ratio"  # to the value of the parameter: the horizontal axis
LINE: Final = 0.21  # inches a parameter
MOST: Final = 60  # parameters in a panel: those to which something happens first


def figure(
    document: Record, *, look: Look = PLAIN_LOOK, ax: Axes | None = None, attractor: str | None = None
) -> Figure:
    """One panel an attractor, the parameter that matters most on top; a marker where a bifurcation ends the bar.

    look : its x is `ratio`, its y the parameters that are shown (default: all).
    ax : draw one attractor into these axes instead.  attractor : draw this one alone.
    """
    columns, names = document["survey"], list(document["attractors"])
    if attractor is not None and attractor not in names:
        raise InputError(f"attractor: the survey has no {attractor!r}; it has {', '.join(names)}")
    names = names if attractor is None else [attractor]
    fixed(look, "a survey", RATIO)
    look.check_columns([RATIO])
    wanted, known = several(look.y), list(dict.fromkeys(columns["parameter"]))
    for name in wanted:
        if name not in known:
            raise InputError(f"y: the survey has no parameter {name!r}; it has {', '.join(known)}")
    of = list(zip(columns["attractor"], columns["parameter"], strict=True))
    rows = {a: [k for k, (b, p) in enumerate(of) if a == b and (not wanted or p in wanted)][:MOST] for a in names}
    height = 1.3 + LINE * max((len(r) for r in rows.values()), default=1)
    with style(look.style):
        drawing, axes = canvas(look, ax, names, (1.4 + 4.2 * len(names), max(height, 2.2)))
        seen: dict[str, Line2D] = {}
        for one, name in zip(axes, names, strict=True):
            _panel(one, columns, rows[name], float(document["factor"]), look, seen)
            if len(names) > 1:
                one.set_title(name, fontsize=9)
        words = [f"{code}  {style_of(code).words}" for code in seen]
        finish(drawing, axes, look, ax, list(seen.values()), words, document["model"], 3)
    return drawing


def drawn(document: Record, ax: Axes | None, options: Mapping[str, object], attractor: str | None = None) -> Figure:
    """`figure` with the options as a user writes them."""
    return figure(document, look=Look.of(options), ax=ax, attractor=attractor)


def _panel(ax: Axes, columns: Record, rows: list[int], factor: float, look: Look, seen: dict[str, Line2D]) -> None:
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
                if look.writes(code):
                    away = 5 if side == "above" else -5
                    ax.annotate(
                        code, (ratio, position), (away, 0), textcoords="offset points", fontsize=6.5, va="center",
                        ha="left" if away > 0 else "right", zorder=4,
                    )  # fmt: skip
            elif columns[f"{side}.end"][k] not in ("bound",):
                ax.plot(ratio, position, "|", color="0.3", markersize=8, zorder=3)
        ax.plot(ends, [position, position], "-", color="0.75", linewidth=5.0, solid_capstyle="butt", zorder=1)
    ax.axvline(1.0, color="0.2", linewidth=0.8, zorder=2)
    ax.set_yticks(range(len(rows)), [columns["parameter"][k] for k in rows], fontsize=8)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.set_xlim(*look.limits.get(RATIO, (0.85 / factor, factor / 0.85)))
    ax.set_xlabel("parameter / its value")
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(axis="y", length=0)
