"""The picture of a phase diagram: curves by type, points of codimension two, regions shaded and labelled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from contin.plot.smooth import smooth
from contin.plot.vocabulary import PALETTE, locus_words, style_of

COLOURS: Final = {
    "LP": PALETTE[0], "HB": PALETTE[1], "BP": PALETTE[2], "PD": PALETTE[3], "NS": PALETTE[4], "LPC": PALETTE[5],
    "BPC": "#8C564B", "HOM": PALETTE[6],
}  # fmt: skip
SHADES: Final = ("#f7f7f7", "#e3eef7", "#c6dcee", "#a9cae4")  # none, one, two, three or more stable states
MARKED: Final = 14  # names of points are written while there are no more than this
NAMED: Final = 2e-3  # a region with less of the box is not named in it
EXPLAINED: Final = 0.06  # one with more is described in words, too
QUIET: Final = frozenset({"UZ", "R3", "R4"})


def draw(
    data: Mapping[str, Any], branches: Sequence[Mapping[str, Any]], title: str | None = None, scan: Any = None
) -> Any:
    """A matplotlib figure that belongs to no window.

    data : the `phase` section of the results.  branches : those of the results; the curves in `data` are drawn.
    scan : ((k, 2) points, (k,) values) of a brute-force scan, drawn beneath.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from contin.plot.figure import STYLE

    curves = [b for b in branches if b["name"] in set(data["curves"])]
    with rc_context(STYLE):
        figure = Figure(figsize=(6.6, 5.0), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        axes.spines[["top", "right"]].set_visible(True)
        _shade(axes, data)
        if scan is not None:
            points, values = (np.asarray(part) for part in scan)
            axes.scatter(points[:, 0], points[:, 1], c=values, s=6, cmap="Greys", alpha=0.6, linewidths=0, zorder=1)
        _curves(axes, data, curves)
        _points(axes, data, curves)
        _names(axes, data)
        first, second = data["parameters"]
        axes.set(xlabel=first, ylabel=second, xlim=data["range"][first], ylim=data["range"][second])
        if title:
            axes.set_title(title, fontsize=10)
        handles, labels = axes.get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=min(3, len(handles)), frameon=False)
    return figure


def _shade(axes: Any, data: Mapping[str, Any]) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for region in data["regions"]:
        rings = [np.array([*ring, ring[0]]) for ring in (region["outline"], *region["holes"])]
        codes = np.concatenate([[Path.MOVETO, *([Path.LINETO] * (len(r) - 2)), Path.CLOSEPOLY] for r in rings])
        shade = SHADES[min(region["stable"] + region.get("stable_orbits", 0), len(SHADES) - 1)]
        axes.add_patch(PathPatch(Path(np.concatenate(rings), codes), facecolor=shade, edgecolor="none", zorder=0))


def _curves(axes: Any, data: Mapping[str, Any], curves: Sequence[Mapping[str, Any]]) -> None:
    seen: set[str] = set()
    first, second = data["parameters"]
    for branch in curves:
        code = branch["locus"] or ""
        x, y = (np.asarray(branch["columns"][name], dtype=float) for name in (first, second))
        colour = COLOURS.get(code, PALETTE[-1])
        neutral = np.asarray(branch["columns"].get("neutral") or np.zeros(len(x)), bool)
        cuts = np.flatnonzero(np.diff(neutral.astype(int))) + 1
        for rows in np.split(np.arange(len(x)), cuts):
            kind = "neutral" if neutral[rows[0]] else code
            words = "neutral saddles" if neutral[rows[0]] else locus_words(code)
            joined = np.append(rows, rows[-1] + 1) if rows[-1] + 1 < len(x) else rows
            extent = tuple(hi - lo for lo, hi in (data["range"][first], data["range"][second]))
            line = {"lw": 0.8, "ls": ":"} if neutral[rows[0]] else {"lw": 1.7}
            label = None if kind in seen else words
            axes.plot(*smooth(x[joined], y[joined], extent), color=colour, label=label, zorder=2, **line)
            seen.add(kind)


def _points(axes: Any, data: Mapping[str, Any], curves: Sequence[Mapping[str, Any]]) -> None:
    marked: list[tuple[str, float, float]] = []
    seen: set[str] = set()
    names = data["parameters"]
    width = [data["range"][name][1] - data["range"][name][0] for name in names]
    for branch in curves:
        for p in branch["points"]:
            x, y = (p["values"][name] for name in names)
            near = (
                abs(x - a) < 1e-6 * width[0] and abs(y - b) < 1e-6 * width[1] for t, a, b in marked if t == p["type"]
            )
            if p["type"] in QUIET or any(near):
                continue
            style = style_of(p["type"])
            label = None if p["type"] in seen else f"{p['type']}: {style.words}"
            axes.plot([x], [y], style.marker, color="black", ms=5.5, mec="white", mew=0.7, ls="", label=label, zorder=4)
            seen.add(p["type"])
            marked.append((p["type"], x, y))
    if len(marked) <= MARKED:
        for type_, x, y in marked:
            axes.annotate(type_, (x, y), xytext=(4, 4), textcoords="offset points", fontsize=7.5, zorder=5)


def _names(axes: Any, data: Mapping[str, Any]) -> None:
    first, second = data["parameters"]
    for region in data["regions"]:
        if region["area"] < NAMED:
            continue
        words = region["words"].replace("stable, ", "stable,\n")
        text = f"{region['name']}\n{words}" if region["area"] > EXPLAINED else region["name"]
        place = region["point"][first], region["point"][second]
        axes.text(*place, text, ha="center", va="center", fontsize=7.5, color="#333333", zorder=3)
