"""Whether a branch of functions has gone over to another one without a label, as `contin.continuation.gone_over` asks.

Rows are functions on meshes of their own. Each is asked by its mean square over the interval, in what it is at places
that all rows share; so are the solutions that are compared at the parameter of the last row before.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.gone_over import APART, RETURNED, VANISHED, first_beyond, followed, suspicious, way_back
from contin.continuation.one_curve import Step, on_cubic
from contin.continuation.problem import Problem

NOISE: Final = 1e-6  # of a function's size: meshes leave as much of it unknown
CLEAR: Final = 10.0  # times the estimated error of a mesh: a difference that is none of it
LEFT: Final = 1e-8  # of a function's size: what the corrector leaves in rows
MOST: Final = 20  # suspicious steps of an arm that are looked at: each takes four solutions, or some thirty


def gone_over_on_meshes(
    problem: Problem, z: Array, tangents: Array, start: int, labelled: set[int], bounds: tuple[float, float]
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), NaN in front of shorter ones, raw tangents beside, that are of another branch.

    labelled : rows of special points, where branches meet.  bounds : of the parameter, for the metric.
    """
    functions = np.array([problem.at_shared_places(row, row) for row in z])
    slopes = np.array([problem.at_shared_places(row, t) for row, t in zip(z, tangents, strict=True)])
    sizes = np.abs(functions).max(axis=(0, 1))
    sizes[sizes == 0.0] = 1.0
    width = bounds[1] - bounds[0]

    def flat(values: Array, p: Array) -> Array:
        scaled = values / sizes / np.sqrt(values.shape[1])
        return np.column_stack([scaled.reshape(len(values), -1), p / width])

    def alone(values: Array) -> Array:
        parts = values[:, :-1].reshape(len(values), -1, len(sizes))
        return np.column_stack([np.linalg.norm(parts, axis=1), np.abs(values[:, -1])])

    y, t = flat(functions, z[:, -1]), flat(slopes, tangents[:, -1])

    def strange(rows: NDArray[np.intp], sense: int) -> list[int]:
        steps = suspicious(y[rows], sense * t[rows], NOISE, alone) & (alone(y[rows[:-1]]) > NOISE)
        return [int(k) for k in np.flatnonzero(steps[:, :-1].any(axis=1))]

    def two(rows: NDArray[np.intp]) -> bool:
        steps = ([a, b] for a, b in pairwise(rows))
        if all(on_one_curve(problem, z[step], tangents[step], sizes, bounds) for step in steps):
            return False
        return _are_two(problem, z[rows], sizes, bounds)

    return first_beyond(len(z), start, labelled, strange, two, MOST)


def on_one_curve(problem: Problem, z: Array, tangents: Array, sizes: Array, bounds: tuple[float, float]) -> bool:
    """True where solutions inside a step are those of a smooth branch through its two rows z, raw tangents beside."""
    here = z[0][np.isfinite(z[0])]
    width = float(z[1, -1] - z[0, -1])
    if np.any(tangents[:, -1] == 0.0) or width == 0.0:
        return False
    values = [problem.at_shared_places(row, row) for row in z]
    rise, fall = (width * problem.at_shared_places(row, t) / t[-1] for row, t in zip(z, tangents, strict=True))
    noise = max(LEFT, *(CLEAR * problem.mesh_error(row[np.isfinite(row)], sizes) for row in z))
    first = width * tangents[0, -here.size :] / tangents[0, -1]
    return on_cubic(
        problem, Step(here, first, width, problem.initial_scale(here, bounds)), (values[0], values[1]), (rise, fall),
        lambda found: problem.at_shared_places(found, found), _size, noise * sizes,
    )  # fmt: skip


def _are_two(problem: Problem, z: Array, sizes: Array, bounds: tuple[float, float]) -> bool:
    """True where the solution at the last of some rows goes back, by their parameters, to another than the first."""
    here, there = (row[np.isfinite(row)] for row in (z[0], z[-1]))
    first = problem.at_parameter(here.copy(), float(here[-1]), problem.initial_scale(here, bounds))
    if first is None:
        return False
    scale = problem.initial_scale(there, bounds)
    places = way_back(z[::-1, -1])

    def length(found: Array, change: Array) -> Array:
        return _size(problem.at_shared_places(found, change))

    at, hop = followed(problem, there, places, scale, length)
    if at is None:
        return False
    one, other, own, row = (problem.at_shared_places(v, v) for v in (there, at, first, here))
    moved, apart, size = _size(own - one), _size(other - own), _size(own)
    noise = max(NOISE, *(CLEAR * problem.mesh_error(v, sizes) for v in (there, first)))
    away = (apart > APART * moved) & (moved > noise * sizes) & (hop < APART * apart)
    falls = (_size(one) < VANISHED * size) & (_size(other) < VANISHED * size)
    falls &= (_size(own - row) < APART * _size(row)) & (size > noise * sizes)
    if not np.any(away | falls):
        return False
    again, _ = followed(problem, at, [*places[-2::-1], float(there[-1])], scale, length)
    if again is None:
        return False
    off = _size(problem.at_shared_places(again, again) - one)
    return bool(np.all(off <= np.maximum(RETURNED * _size(other - one), noise * sizes)))


def _size(functions: Array) -> NDArray[np.float64]:
    """Root of the mean square of each function, values (places, functions)."""
    return np.asarray(np.sqrt(np.mean(functions * functions, axis=0)))
