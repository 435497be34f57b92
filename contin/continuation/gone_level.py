"""Whether a family of orbits has gone over to another one on which a state's extent is constant, without a label.

As `contin.continuation.gone_over`, where rows are values on meshes: rates of columns stand for slopes. One that has all
but vanished from one step to the next one is suspicious; then the other family is followed back to the parameter of the
last row before, and the two solutions there are compared by their columns.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Problem
from contin.continuation.way_back import APART, way_back
from contin.records import Record

LEVEL: Final = 1e-3  # part of a column's rate that is left two steps later
STRAY: Final = 0.3  # part of a change in an arm's last step that the step before does not foretell
NOISE: Final = 1e-5  # of a column's size: smaller changes say nothing, for meshes leave as much of it unknown
MOST: Final = 3  # suspicious steps of an arm that are looked at
NEXT: Final = 3  # rows beyond
CLEAR: Final = 10.0  # times what solving again moves a column by: a change that is no rounding


def gone_level(
    problem: Problem, z: Array, columns: Record, start: int, labelled: set[int], bounds: tuple[float, float]
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), NaN in front of shorter ones, that are of another family, on both ways from `start`.

    columns : of the rows.  labelled : rows of special points.  bounds : of the parameter, for the metric.
    """
    names = [name for name, column in columns.items() if name != problem.parameters[0] and np.isfinite(column).all()]
    values = np.array([columns[name] for name in names]).T
    own = z[start][np.isfinite(z[start])]
    free = dict(zip(problem.free_names, problem.free_sizes(own, bounds).tolist(), strict=True))
    sizes = np.maximum(np.abs(values).max(axis=0), [free.get(name, 0.0) for name in names])
    found = []
    for sense in (1, -1):
        rows = np.arange(start, len(z)) if sense == 1 else np.arange(start, -1, -1)
        steps = [
            k for k in _levelling(values[rows], z[rows, -1], sizes)
            if labelled.isdisjoint(int(row) for row in rows[k : k + NEXT + 2])
        ]  # fmt: skip
        for k in steps[:MOST]:
            if _are_two(problem, z[rows[k : k + NEXT + 1]], names, sizes, bounds):
                found.append(int(rows[k + 1]))
                break
    return sorted(found)


def _levelling(values: Array, p: Array, size: Array) -> list[int]:
    """Rows k after which a column hardly changes: that before k did so, with the parameter going the same way."""
    if len(p) < NEXT + 2:
        return []
    change, way = np.diff(values, axis=0), np.diff(p)
    if way[-2] == 0.0 or not np.any(way):
        return []
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.abs(change / way[:, None])
    falls: NDArray[np.bool_] = rates[NEXT:] < LEVEL * rates[: -NEXT]
    falls &= (np.abs(change[:-NEXT]) > NOISE * size) & (way[:-NEXT] * way[NEXT:] > 0.0)[:, None]
    last = np.abs(change[-1] - change[-2] / way[-2] * way[-1]) > STRAY * np.abs(change[-1])  # nothing is known beyond
    last &= (np.abs(change[-1]) > NOISE * size) & (way[-1] * way[-2] > 0.0)
    return [*(int(k) + 1 for k in np.flatnonzero(falls.any(axis=1))), *([len(p) - 2] if last.any() else [])]


def _are_two(problem: Problem, z: Array, names: list[str], size: Array, bounds: tuple[float, float]) -> bool:
    """True where the last of some rows goes back, by their parameters, to another solution than the first.

    A column that is zero but for rounding (a damping under which orbits of a conservative system exist) says nothing.
    """
    here, there = (row[np.isfinite(row)] for row in (z[0], z[-1]))
    first = problem.at_parameter(here.copy(), float(here[-1]), problem.initial_scale(here, bounds))
    at, scale = there, problem.initial_scale(there, bounds)
    for place in way_back(z[::-1, -1]):
        found = problem.at_parameter(at.copy(), place, scale)
        if found is None:
            return False
        at = found
    again = problem.at_parameter(there.copy(), float(there[-1]), scale)
    if first is None or again is None:
        return False
    rows = [problem.columns(row[None]) for row in (there, at, first, here, again)]
    beyond, other, own, row, once_more = (np.array([float(row[name][0]) for name in names]) for row in rows)
    rounding = CLEAR * np.maximum(np.abs(own - row), np.abs(once_more - beyond))
    moved = np.abs(own - beyond)
    counts = moved > np.maximum(NOISE * size, rounding)
    return bool(np.any((np.abs(other - own) > APART * moved) & counts))
