"""A phase plane with matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.plot.canvas import canvas, finish, fixed
from contin.plot.dress import dress
from contin.plot.house_style import style
from contin.plot.look import Look
from contin.plot.typeset import typeset
from contin.plot.vocabulary import PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.plane.plane_parts import PlaneParts

ARROWS: Final = 21  # along each side
FILLS: Final = {
    "stable": ("full", "black"),
    "unstable": ("none", "white"),
    "saddle": ("left", "black"),
    "neutral": ("top", "0.6"),
}
WORDS: Final = {"stable": "stable", "unstable": "unstable", "saddle": "saddle", "neutral": "neutral or degenerate"}
DASHES: Final = {"unstable": "-", "stable": "--"}
SIZE: Final = (5.2, 5.0)


def drawn(plane: PlaneParts, ax: Axes | None, options: Mapping[str, object]) -> Figure:
    """Everything, with a legend below (inside, where `ax` is the caller's)."""
    look = Look.of(options)
    x, y = plane.field.names
    fixed(look, "a phase plane", x, y)
    look.check_columns([x, y])
    with style(look.style):
        drawing, [axes] = canvas(look, ax, [f"{y} over {x}"], SIZE)
        _draw(plane, axes, look)
        handles, words = axes.get_legend_handles_labels()
        finish(drawing, [axes], look, ax, handles, words, plane.field.title, 3)
    return drawing


def _draw(plane: PlaneParts, ax: Axes, look: Look) -> None:
    x, y = plane.field.names
    periods = plane.field.periods
    _arrows(plane, ax)
    for k, (name, curves) in enumerate(zip((x, y), plane.nullclines, strict=True)):
        moved = f"{typeset(name)} stays" if plane.field.is_map else f"d{typeset(name)}/dt = 0"
        for number, curve in enumerate(curves):
            ax.plot(*curve.T, color=PALETTE[k], linewidth=1.1, zorder=2, label=moved if number == 0 else None)
    seen: set[str] = set()
    for half in plane.separatrices:
        label = f"{half.kind} manifold"
        points = _wrapped(half.flight.points, periods, plane.window)
        ax.plot(
            *points.T, color="black", linewidth=1.0, linestyle=DASHES[half.kind], zorder=3, label=_once(label, seen)
        )
    for cycle in plane.cycles:
        label = "stable cycle" if cycle.stable else "unstable cycle"
        points = _wrapped(cycle.points, periods, plane.window)
        ax.plot(
            *points.T, color=PALETTE[3], linewidth=1.8, linestyle="-" if cycle.stable else "--", zorder=4,
            label=_once(label, seen),
        )  # fmt: skip
    for flight in plane.trajectories:
        points = _wrapped(flight.points, periods, plane.window)
        if plane.field.is_map:
            ax.plot(*points.T, ".", color=PALETTE[2], markersize=2.5, zorder=3, label=_once("iterates", seen))
        else:
            ax.plot(*points.T, color=PALETTE[2], linewidth=0.9, zorder=3, label=_once("trajectory", seen))
            _head(ax, points, plane.window)
    for rest in plane.rests:
        fill, colour = FILLS[rest.stability]
        ax.plot(
            *rest.u, "o", markersize=7, color=colour, fillstyle=fill, markerfacecoloralt="white",
            markeredgecolor="black", markerfacecolor="white" if fill == "none" else colour, zorder=6, linestyle="none",
            label=_once(WORDS[rest.stability], seen),
        )  # fmt: skip
    ax.set_xlim(*plane.window[0])
    ax.set_ylim(*plane.window[1])
    dress(ax, look, x, y)
    units = plane.field.units
    for name, setter in ((x, ax.set_xlabel), (y, ax.set_ylabel)):
        setter(typeset(name) + (f" ({units[name]})" if name in units else ""))


def _once(label: str, seen: set[str]) -> str | None:
    if label in seen:
        return None
    seen.add(label)
    return label


def arrow_places(window: Array) -> Array:
    """Where arrows stand, (ARROWS^2, 2)."""
    widths = window[:, 1] - window[:, 0]
    fractions = (np.arange(ARROWS) + 0.5) / ARROWS
    x, y = np.meshgrid(*(low + fractions * width for low, width in zip(window[:, 0], widths, strict=True)))
    return np.column_stack([x.ravel(), y.ravel()])


def _arrows(plane: PlaneParts, ax: Axes) -> None:
    """The direction field: arrows of one length, as steep as trajectories are in the picture."""
    widths = plane.window[:, 1] - plane.window[:, 0]
    points = arrow_places(plane.window)
    scaled = plane.field.motion(points) / widths
    with np.errstate(all="ignore"):
        unit = scaled / np.asarray(elementary.hypot(*scaled.T))[:, None]
    good = np.isfinite(unit).all(axis=1)
    ax.quiver(
        *points[good].T,
        *unit[good].T,
        color="0.75",
        scale=1.6 * ARROWS,
        width=0.0022,
        headwidth=4.0,
        pivot="mid",
        zorder=1,
    )


def _head(ax: Axes, points: Array, window: Array) -> None:
    """An arrow head in the middle of the part of a trajectory that is seen."""
    inside = np.flatnonzero(np.all((points >= window[:, 0]) & (points <= window[:, 1]), axis=1))
    if len(inside) < 8:
        return
    k = int(inside[len(inside) // 3])
    k = min(k, len(points) - 2)
    if np.isfinite(points[k : k + 2]).all():
        ax.annotate(
            "", points[k + 1], points[k], arrowprops={"arrowstyle": "-|>", "color": PALETTE[2], "lw": 0.9}, zorder=3
        )


def _wrapped(points: Array, periods: Array, window: Array) -> Array:
    """Angles brought into the window, with a gap where they go around."""
    if not np.any(periods > 0.0):
        return points
    found = points.copy()
    turns = np.zeros_like(points)
    for k in np.flatnonzero(periods > 0.0):
        turns[:, k] = np.floor((points[:, k] - window[k, 0]) / periods[k])
        found[:, k] -= periods[k] * turns[:, k]
    cuts = np.flatnonzero(np.any(np.diff(turns, axis=0) != 0.0, axis=1)) + 1
    return np.asarray(np.insert(found, cuts, np.nan, axis=0))
