"""Nullclines: level curves f = 0 of scalar functions, from a grid, every vertex refined onto the curve.

Marching squares puts vertices on grid lines, where a component changes its sign; along the line the zero is bracketed,
so that the Illinois method finds it to rounding. A component that jumps through zero, or has a pole there, changes its
sign too: such vertices are no zeros, and cut the curve.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

ITERATIONS: Final = 60
BESIDE: Final = 1e-8  # of a cell: next to a zero of a continuous component its values are as small
JUMP: Final = 1e-3  # ... than this part of those a cell away
OFFSETS: Final = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])

Field = Callable[[Array], Array]


def nullcline(functions: Sequence[Field], window: Array, cells: int) -> tuple[Array, ...]:
    """Curves (K, 2) on which one of the functions vanishes, in the window [[x0, x1], [y0, y1]].

    functions : of points (K, 2), (K,), nan where they have no value.  cells : along each side.
    """
    x, y = (_nodes(low, high, cells) for low, high in window)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return tuple(
        curve
        for function in functions
        for curve in _curves(function, function(grid).reshape(len(y), len(x)), (x, y))
    )


def _nodes(low: float, high: float, cells: int) -> Array:
    """Equal cells in the window, and half a cell beyond: a zero along the window's edge is between two nodes."""
    step = (high - low) / cells
    return np.concatenate([[low - 0.5 * step], np.linspace(low, high, cells + 1), [high + 0.5 * step]])


def _curves(component: Field, values: Array, axes: tuple[Array, Array]) -> list[Array]:
    if not np.any(values > 0.0) or not np.any(values <= 0.0):
        return []
    from contourpy import contour_generator

    found = []
    for line in contour_generator(*axes, np.ma.masked_invalid(values)).lines(0.0):
        refined = _refined(component, np.asarray(line), axes)
        parts = _pieces(refined, _is_zero(component, refined, axes))
        found += [part for part in parts if len(part) > 1]
    return found


def _refined(component: Field, line: Array, axes: tuple[Array, Array]) -> Array:
    """The vertices on the curve, each moved along its grid line."""
    low, high = line.copy(), line.copy()
    for k, axis in enumerate(axes):  # a vertex lies on a line of one axis, between two points of the other
        place = np.clip(np.searchsorted(axis, line[:, k]) - 1, 0, len(axis) - 2)
        nearest = np.minimum(np.abs(axis[place] - line[:, k]), np.abs(axis[place + 1] - line[:, k]))
        between = nearest > 1e-9 * (axis[1] - axis[0])
        low[between, k], high[between, k] = axis[place][between], axis[place + 1][between]
    a, b, fa, fb = low, high, component(low), component(high)
    size = np.maximum(np.abs(fa), np.abs(fb))
    bracketed = fa * fb < 0.0
    middle = line
    for _ in range(ITERATIONS):
        with np.errstate(all="ignore"):
            fraction = np.clip(np.nan_to_num(fa / (fa - fb), nan=0.5), 0.02, 0.98)
        middle = np.where(bracketed[:, None], a + fraction[:, None] * (b - a), line)
        value = component(middle)
        left = fa * value > 0.0
        a, b = np.where(left[:, None], middle, a), np.where(left[:, None], b, middle)
        fa, fb = np.where(left, value, 0.5 * fa), np.where(left, 0.5 * fb, value)  # Illinois: the end that stays
        if np.all(np.abs(value[bracketed]) <= 1e-15 * size[bracketed]):
            break
    return np.asarray(middle)


def _is_zero(component: Field, points: Array, axes: tuple[Array, Array]) -> NDArray[np.bool_]:
    """True where the component vanishes continuously."""
    cell = np.array([axis[2] - axis[1] for axis in axes])
    beside = np.array([np.abs(component(points + BESIDE * cell * offset)) for offset in OFFSETS])
    around = np.array([np.abs(component(points + cell * offset)) for offset in OFFSETS])
    return np.asarray(np.nanmax(beside, axis=0) <= JUMP * np.nanmax(around, axis=0))


def _pieces(points: Array, true: NDArray[np.bool_]) -> list[Array]:
    cuts = np.flatnonzero(~true)
    parts, keep = np.split(points, cuts), np.split(true, cuts)
    return [part[flags] for part, flags in zip(parts, keep, strict=True)]
