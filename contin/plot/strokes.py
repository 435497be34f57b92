"""The curves and marks of one panel on matplotlib axes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.plot.bounded import bounded
from contin.plot.look import Look
from contin.plot.series import Curve, Panel, is_constant
from contin.plot.smooth import smooth
from contin.plot.vocabulary import style_of
from contin.records import Fields

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

STABLE: Final[Fields] = {"linestyle": "-", "linewidth": 1.9}
UNSTABLE: Final[Fields] = {"linestyle": (0, (3.2, 1.8)), "linewidth": 1.1}
CIRCLES: Final[Fields] = {  # on orbits: filled where stable, open where unstable
    "linestyle": "none", "marker": "o", "markersize": 3.4, "markeredgewidth": 0.8, "markevery": (0.02, 0.05),
}  # fmt: skip
PLAIN: Final[Fields] = {"linestyle": "-", "linewidth": 1.5}  # loci
BENEATH: Final[Fields] = {"linestyle": "-", "linewidth": 6.0, "alpha": 0.3}  # under a curve that hides this one
SAMPLES: Final = 40  # points of a curve that are compared with another's
COVERS: Final = 0.9  # part of a curve that another one must hide


def draw_panel(ax: Axes, panel: Panel, colours: Mapping[str, str], look: Look) -> None:
    """Draw a panel: stable solid, unstable dashed, a curve that others lie upon with a wide pale band beneath."""
    frame = _extent(panel)
    hidden = _hidden(panel, frame)
    for curve in panel.curves:
        for portion in curve.portions:
            style = PLAIN if portion.stable is None else STABLE if portion.stable else UNSTABLE
            x, y = smooth(portion.x, portion.y, frame)
            if curve.name in hidden:
                ax.plot(x, y, color=colours[curve.name], solid_capstyle="butt", zorder=1.5, **BENEATH)
            ax.plot(x, y, color=colours[curve.name], solid_capstyle="round", zorder=2.0, **style)
            if curve.kind == "orbit":
                face = colours[curve.name] if portion.stable else "white"
                ax.plot(x, y, color=colours[curve.name], markerfacecolor=face, zorder=2.1, **CIRCLES)
        _draw_marks(ax, curve, colours[curve.name])
    _scale(ax, panel, look)
    ax.set_xlabel(panel.x_label)
    ax.set_ylabel(panel.y_label)
    ax.grid(True, color="0.92", linewidth=0.6, zorder=0)
    ax.set_axisbelow(True)


def _draw_marks(ax: Axes, curve: Curve, colour: str) -> None:
    for x, y, mark in curve.marks:
        look = style_of(mark.type)
        stroke = look.marker in "x12"  # shapes without a face
        ax.plot(
            [x], [y], look.marker,
            markersize=5.5 if look.marker != "*" else 8.0,
            markerfacecolor=colour if stroke else "white",
            markeredgecolor="black",
            markeredgewidth=1.3 if stroke else 0.9,
            zorder=3.0,
        )  # fmt: skip


def _scale(ax: Axes, panel: Panel, look: Look) -> None:
    """Limits and logarithmic axes: the user's, else those of what is bounded."""
    ax.margins(0.04, 0.08)
    if panel.x in look.log:
        ax.set_xscale("log")
        _plain_numbers(ax.xaxis, ax.get_xlim())
    if panel.y in look.log:
        ax.set_yscale("log")
        _plain_numbers(ax.yaxis, look.limits.get(panel.y) or ax.get_ylim())
    elif panel.y not in look.limits:
        curves = [(portion.x, portion.y) for curve in panel.curves for portion in curve.portions]
        limits = bounded(curves, np.array([y for curve in panel.curves for _, y, _ in curve.marks]))
        if limits is not None:
            ax.set_ylim(*limits)
    low, high = ax.get_ylim()
    if is_constant(np.array([low, high])):
        centre = (low + high) / 2
        ax.set_ylim(centre - 0.5 * (abs(centre) or 1.0), centre + 0.5 * (abs(centre) or 1.0))
    if panel.x in look.limits:
        ax.set_xlim(*look.limits[panel.x])
    if panel.y in look.limits:
        ax.set_ylim(*look.limits[panel.y])


def _plain_numbers(axis: Axis, limits: Sequence[float]) -> None:
    """Ordinary numbers instead of powers of ten on a logarithmic axis of less than two decades."""
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    if limits[0] > 0.0 and limits[1] < 100.0 * limits[0]:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(ScalarFormatter())
        axis.set_minor_formatter(NullFormatter())


def _extent(panel: Panel) -> tuple[float, float]:
    """Width and height of all that a panel shows."""
    portions = [portion for curve in panel.curves for portion in curve.portions]
    if not portions:
        return 1.0, 1.0
    xs, ys = np.concatenate([portion.x for portion in portions]), np.concatenate([portion.y for portion in portions])
    return _range(xs), _range(ys)


def _range(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return (float(np.ptp(finite)) if len(finite) else 0.0) or 1.0


def _hidden(panel: Panel, frame: tuple[float, float]) -> set[str]:
    """Curves that lie under one that is drawn later."""
    paths = [(curve.name, [np.stack([p.x, p.y], axis=1) / frame for p in curve.portions]) for curve in panel.curves]
    return {name for k, (name, own) in enumerate(paths) if any(_covers(later, own) for _, later in paths[k + 1 :])}


def _covers(upper: list[Array], lower: list[Array]) -> bool:
    """Whether most points of one polyline lie on the other, closer than the width of a line."""
    if not upper or not lower:
        return False
    low, high = np.vstack(upper), np.vstack(lower)
    if np.any(np.nanmin(low, axis=0) > np.nanmax(high, axis=0) + 0.01) or np.any(
        np.nanmax(low, axis=0) < np.nanmin(high, axis=0) - 0.01
    ):
        return False
    points = high[:: max(1, len(high) // SAMPLES)]
    distances = np.min([_distances(points, path) for path in upper], axis=0)
    return float(np.mean(distances < 0.003)) >= COVERS


def _distances(points: Array, path: Array) -> Array:
    """From each point to a polyline."""
    if len(path) < 2:
        return np.asarray(np.hypot(*(points - path[0]).T))
    a, d = path[:-1], np.diff(path, axis=0)
    squares = np.maximum(np.sum(d * d, axis=1), 1e-300)
    along = np.clip(np.einsum("ijk,jk->ij", points[:, None] - a[None], d) / squares, 0.0, 1.0)
    gaps = points[:, None] - a[None] - along[..., None] * d[None]
    found: Array = np.nanmin(np.hypot(gaps[..., 0], gaps[..., 1]), axis=1)
    return found


def angle_ticks(ax: Axes, panel: Panel, periods: Mapping[str, float]) -> None:
    """Ticks in multiples of pi on axes that show an angle of period 2 pi."""
    names = ["\u2212\u03c0", "\u2212\u03c0/2", "0", "\u03c0/2", "\u03c0"]  # letters: formulas take long to set
    for name, axis, limits in ((panel.x, ax.xaxis, ax.get_xlim()), (panel.y, ax.yaxis, ax.get_ylim())):
        period = periods.get(name)
        if (
            period is not None
            and math.isclose(period, 2 * math.pi, rel_tol=1e-9)
            and limits[1] - limits[0] > math.pi / 2
        ):
            axis.set_ticks(list(np.linspace(-math.pi, math.pi, 5)), names)
