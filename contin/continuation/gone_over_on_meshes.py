"""Whether a branch of functions has gone over to another one without a label, as `contin.continuation.gone_over` asks.

Rows are functions on meshes of their own. Each is asked by its mean square over the interval, in what it is at places
that all rows share. On one mesh, solutions are those of one set of equations, whose branches differ from those of the
functions, but which are known to rounding; so two solutions are compared on one mesh, at the parameter of the last row
before. Only from one mesh to another the error of meshes counts.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.gone_over import first_beyond
from contin.continuation.one_curve import Step, on_cubic
from contin.continuation.problem import Problem
from contin.continuation.singular_between import singular_between
from contin.continuation.unexplained_steps import suspicious
from contin.continuation.way_back import APART, ASIDE, CLEAR, LED, LEFT, MET, RETURNED, Answer, followed, way_back
from contin.kernels.rows_in_doubt import REMNANT
from contin.machine import elementary

NOISE: Final = 1e-6  # of a function's size: meshes leave as much of it unknown
SOLVED: Final = 1e-9  # of a function's size: what the corrector leaves in rows, on one mesh
ROUNDED: Final = 1e-12  # of a function's size: rounding of solutions
MOST: Final = 20  # suspicious steps of an arm that are looked at: each takes four solutions, or some thirty; ...
LARGE: Final = 4000  # ... of more unknowns than so many as fewer as these are more, the strangest
FEWEST: Final = 2


def gone_over_on_meshes(
    problem: Problem, z: Array, tangents: Array, start: int, labelled: set[int], bounds: tuple[float, float]
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), NaN in front of shorter ones, raw tangents beside, that are of another branch.

    labelled : rows of special points, where branches meet.  bounds : of the parameter, for the metric.
    """
    functions, slopes = (problem.rows_at_shared_places(z, values) for values in (z, tangents))
    sizes, row = np.abs(functions).max(axis=(0, 1)), z[start][np.isfinite(z[start])]
    natural = np.ones(len(sizes))
    known = problem.sizes(row, problem.initial_scale(row, bounds))
    natural[: len(known)] = known
    sizes = np.where(sizes > ROUNDED * natural, sizes, natural)  # not those of a zero with rounding errors
    width = bounds[1] - bounds[0]

    def flat(values: Array, p: Array) -> Array:
        scaled = values / sizes / np.sqrt(values.shape[1])
        return np.column_stack([scaled.reshape(len(values), -1), p / width])

    def alone(values: Array) -> Array:
        parts = values[:, :-1].reshape(len(values), -1, len(sizes))
        return np.column_stack([np.sqrt(np.einsum("kpf,kpf->kf", parts, parts)), np.abs(values[:, -1])])

    y, t = flat(functions, z[:, -1]), flat(slopes, tangents[:, -1])

    def beyond(rows: NDArray[np.intp], sense: int, noise: float) -> Array:
        steps = suspicious(y[rows], sense * t[rows], noise, alone) * (alone(y[rows[:-1]]) > noise)
        return np.asarray(steps[:, :-1].max(axis=1, initial=0.0))

    def strange(rows: NDArray[np.intp], sense: int) -> Array:
        steps = beyond(rows, sense, SOLVED)
        moved = [k for k in np.flatnonzero(steps) if not problem.of_one_mesh(z[rows[k]], z[rows[k + 1]])]
        if moved:
            steps[moved] = beyond(rows, sense, NOISE)[moved]
        return steps

    def compared(rows: NDArray[np.intp]) -> Answer:
        steps = ([a, b] for a, b in pairwise(rows))
        if all(on_one_curve(problem, z[step], tangents[step], sizes, bounds) for step in steps):
            return Answer.ONE
        return _compared(problem, z[rows], sizes, bounds)

    most = int(np.clip(MOST * LARGE / z.shape[1], FEWEST, MOST))
    return first_beyond(len(z), start, labelled, strange, compared, most)


def on_one_curve(problem: Problem, z: Array, tangents: Array, sizes: Array, bounds: tuple[float, float]) -> bool:
    """True where solutions inside a step are those of a smooth branch through its two rows z, raw tangents beside."""
    here, there = (row[np.isfinite(row)] for row in z)
    way = float(z[1, -1] - z[0, -1])
    if np.any(tangents[:, -1] == 0.0) or way == 0.0:
        return False
    values = [problem.at_shared_places(row, row) for row in z]
    slopes = [problem.at_shared_places(row, t) for row, t in zip(z, tangents, strict=True)]
    width = bounds[1] - bounds[0]

    def whole(change: Array, p: float) -> float:
        return float(np.sqrt(np.sum(elementary.square(_size(change) / sizes)) + elementary.square(p / width)))

    length = whole(values[1] - values[0], way)
    per = [np.sign(way * t[-1]) * length / whole(v, t[-1]) for v, t in zip(slopes, tangents, strict=True)]
    rise, fall = (factor * v for factor, v in zip(per, slopes, strict=True))
    ahead, behind = (factor * t for factor, t in zip(per, tangents, strict=True))
    moved = problem.on_mesh_of(there, here)
    scale = np.maximum(problem.initial_scale(here, bounds), problem.initial_scale(moved, bounds))
    noise = SOLVED
    if not problem.of_one_mesh(here, there):
        noise = max(noise, *(CLEAR * problem.mesh_error(row, sizes) for row in (here, there)))
    step = Step((here, moved), ahead[-here.size :], (ahead[-1:], behind[-1:]), scale)
    return on_cubic(
        problem, step, (values[0], values[1]), (rise, fall),
        lambda found: problem.at_shared_places(found, found), _size, noise * sizes,
    )  # fmt: skip


def _compared(problem: Problem, z: Array, sizes: Array, bounds: tuple[float, float]) -> Answer:
    """Whether the solution at the last of some rows goes back, by their parameters, to them, or to another branch."""
    rows = [row[np.isfinite(row)] for row in z]
    here, there = rows[0], rows[-1]
    start = problem.on_mesh_of(here, there)
    scale = np.maximum(problem.initial_scale(there, bounds), problem.initial_scale(start, bounds))

    def length(found: Array, change: Array) -> Array:
        return _size(problem.at_shared_places(found, change))

    def apart(one: Array, other: Array) -> Array:
        return _size(problem.apart_at_shared_places(one, other))

    first = problem.at_parameter(start.copy(), float(here[-1]), scale)
    last = problem.at_parameter(there.copy(), float(there[-1]), scale)
    if first is None or last is None or first.size != last.size:
        return Answer.UNKNOWN
    nearby = problem.at_parameter(first + ASIDE * (there - first), float(here[-1]), scale)
    if nearby is None:
        return Answer.UNKNOWN
    places = way_back(z[::-1, -1])
    back, hop = followed(problem, last, places, scale, length)
    known = np.maximum(CLEAR * apart(nearby, first), ROUNDED * sizes)
    moved = apart(first, last)
    if not back or np.any((hop > LED * moved) & (moved > known)):
        return Answer.TWO if singular_between(problem, first, last, scale, apart, known) else Answer.UNKNOWN
    allowed = np.maximum(known, SOLVED * sizes)
    near = np.maximum(MET * moved, known)
    before = (problem.on_mesh_of(row, there) for row in rows[-2::-1])
    if all(np.all(apart(found, row) <= near) for found, row in zip(back, before, strict=True)):
        return Answer.ONE
    at = back[-1]
    gap = apart(at, first)
    own, one, other = (length(v, v) for v in (first, last, at))
    away = (gap > APART * moved) & (moved > known) & (hop < APART * gap)
    falls = (one < REMNANT * own) & (other < REMNANT * own) & (own > known)
    far = np.maximum(gap, apart(at, last))
    kept = apart(first, start) < APART * moved  # the row before is the solution that is asked
    if not np.any((away | falls) & kept) or np.any(apart(last, there) > np.maximum(LEFT * far, allowed)):
        return Answer.UNKNOWN
    again, _ = followed(problem, at, [*places[-2::-1], float(there[-1])], scale, length)
    returns = again and np.all(apart(again[-1], last) <= np.maximum(RETURNED * far, allowed))
    return Answer.TWO if returns else Answer.UNKNOWN


def _size(functions: Array) -> NDArray[np.float64]:
    """Root of the mean square of each function, values (places, functions)."""
    return np.asarray(np.sqrt(np.mean(functions * functions, axis=0)))
