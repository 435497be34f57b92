"""Whether a branch has gone over to another one on which a state is zero, without a label: past the top of a needle.

Where a branch that is narrow in the metric ends in a pitchfork, the corrector may find no other solution beyond its top
than the one on which the state vanishes; steps cannot be made so short that the branch is seen to turn, and no test
changes its sign. But then both solutions exist at the parameter of the last row before, and that is asked.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Problem

VANISHED: Final = 0.05  # part of a state that a few steps leave of it, and the steps after that too
UNEXPLAINED: Final = 0.2  # part of a state's change that is not what its slopes lead to (of resolved steps: 1e-3)
APART: Final = 0.5  # of a state: two solutions that differ by more are two
MOST: Final = 20  # suspicious steps of an arm that are looked at: each costs two solutions
BLOCK: Final = 1_000_000  # numbers that are looked at at once
NEXT: Final = 3  # rows: one or two that the corrector leaves between two branches are none of either


def gone_over(
    problem: Problem, z: Array, tangents: Array, start: int, labelled: set[int], scale: Array
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), raw tangents beside, that on both ways from `start` are of another branch.

    labelled : rows of special points, where branches meet.
    """
    found = []
    for sense in (1, -1):
        rows = np.arange(start, len(z)) if sense == 1 else np.arange(start, -1, -1)
        near = [k for k in _falling(z[:, :-1], rows, problem.angle_periods) if _is_plain(rows, k, labelled)]
        for here, there in [(rows[k], rows[min(k + NEXT, len(rows) - 1)]) for k in near[:MOST]]:
            y, slopes = z[[here, there]] / scale, sense * tangents[[here, there]] / scale
            if _is_unexplained(y, slopes) and _are_two(problem, z[here], z[there], scale):
                found.append(int(there))
                break
    return sorted(found)


def _falling(states: Array, rows: NDArray[np.intp], angle_periods: Array) -> list[int]:
    """Places in `rows` beyond which a state other than an angle is next to nothing of what it is there."""
    falling, block = [], max(1, BLOCK // states.shape[1])  # not a copy of all rows of large systems
    for first in range(0, len(rows) - 1, block):
        near = np.arange(first, min(first + block, len(rows) - 1))
        far = np.minimum(near + NEXT, len(rows) - 1)
        size, left = np.abs(states[rows[near]]), np.abs(states[rows[far]])
        fallen = (left < VANISHED * size) & (angle_periods == 0.0)
        falling += [int(k) for k in near[fallen.any(axis=1)]]
    return falling


def _is_plain(rows: NDArray[np.intp], k: int, labelled: set[int]) -> bool:
    """True where no special point is among the rows about place k."""
    return labelled.isdisjoint(int(row) for row in rows[k : k + NEXT + 2])


def _is_unexplained(y: Array, slopes: Array) -> bool:
    """True where a state is next to nothing at the second of two points, and their slopes do not lead there."""
    moved = y[1] - y[0]
    length = float(np.linalg.norm(moved))
    left = [np.abs(moved - length * slope)[:-1] for slope in (slopes[1], 0.5 * (slopes[0] + slopes[1]))]
    size, falls = np.abs(y[0, :-1]), np.abs(y[1, :-1]) < VANISHED * np.abs(y[0, :-1])
    return bool(np.any(falls & (np.maximum(*left) > UNEXPLAINED * size)))


def _are_two(problem: Problem, here: Array, there: Array, scale: Array) -> bool:
    """True where the solution `there` goes on to the parameter of the one before it, beside that."""
    value = float(here[-1])
    first, other = (problem.at_parameter(guess.copy(), value, scale) for guess in (here, there))
    if first is None or other is None:
        return False
    falls = np.abs(there[:-1]) < VANISHED * np.abs(here[:-1])
    stays = np.abs(first[:-1] - here[:-1]) < APART * np.abs(here[:-1])
    return bool(np.any(falls & stays & (np.abs(other[:-1]) < VANISHED * np.abs(first[:-1]))))
