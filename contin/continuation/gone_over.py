"""Whether a branch has gone over to another one without a label: past the top of a needle, or at a corner.

Where a branch that is narrow in the metric ends in a pitchfork, the corrector may find no other solution beyond its top
than the branch that it meets there; steps cannot be made so short that the branch is seen to turn, and no test changes
its sign. But then that other branch goes back, beside the first one, to the parameter of the last row before. So asked
are steps whose change the slopes at their rows do not explain, whatever the coordinates, and those that leave next to
nothing of a state, however small it was.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.one_curve import Step, on_cubic
from contin.continuation.problem import Problem
from contin.continuation.singular_between import singular_between
from contin.continuation.unexplained_steps import Lengths, suspicious
from contin.continuation.way_back import APART, ASIDE, CLEAR, LED, LEFT, MET, RETURNED, Answer, followed, way_back
from contin.kernels.rows_in_doubt import EPSILON, NEXT, REMNANT, may_none_be_of_two

SOLVED: Final = 1e-8  # scaled: what the corrector leaves in rows
MOST: Final = 20  # suspicious steps of an arm that are looked at: each costs a few times `PARTS` solutions
BLOCK: Final = 1_000_000  # numbers that are looked at at once
SOME: Final = 4096  # unknowns that are looked at at once, in the memory next to the processor


def gone_over(
    problem: Problem, z: Array, tangents: Array, start: int, labelled: set[int], scale: Array, noise: float
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), raw tangents beside, that on both ways from `start` are of another branch.

    labelled : rows of special points, where branches meet.  noise : rounding of rows, in scaled unknowns.
    """

    asked: dict[tuple[int, int], bool] = {}  # steps that are seen more than once

    def on_one_curve(step: tuple[int, int]) -> bool:
        if step not in asked:
            asked[step] = _on_one_curve(problem, z[list(step)], tangents[list(step)], scale)
        return asked[step]

    def compared(rows: NDArray[np.intp]) -> Answer:
        if all(on_one_curve(step) for step in pairwise(rows.tolist())):
            return Answer.ONE
        return _compared(problem, z[rows], scale, noise)

    angles = problem.angle_periods

    def strange(rows: NDArray[np.intp], sense: int) -> Array:
        if may_none_be_of_two(*map(np.ascontiguousarray, (z, tangents)), scale, angles, noise, start, sense):
            return np.zeros(len(rows) - 1)
        return _suspicious(z, sense * tangents, rows, scale, angles, noise)

    return first_beyond(len(z), start, labelled, strange, compared, MOST)


def first_beyond(
    count: int, start: int, labelled: set[int], strange: Callable[[NDArray[np.intp], int], Array],
    compared: Callable[[NDArray[np.intp]], Answer], most: int,
) -> list[int]:  # fmt: skip
    """The first of `count` rows on both ways from `start` that are beyond a step between two branches.

    strange : of rows in turn, whose tangents have this sense, how suspicious the step from each one is, 0 where it is
    not.  compared : of some rows, whether they are of one branch; asked of the `most` strangest steps on each way, and,
    where rows may change to and fro between two branches, of a step's own rows.
    """
    found = []
    for sense in (1, -1):
        rows = np.arange(start, count) if sense == 1 else np.arange(start, -1, -1)
        if len(rows) < 2:
            continue
        how = strange(rows, sense)
        steps = [
            int(k) for k in np.flatnonzero(how) if labelled.isdisjoint(int(row) for row in rows[k : k + NEXT + 2])
        ]  # fmt: skip
        for k in sorted(sorted(steps, key=lambda step: -how[step])[:most]):
            last = min(k + NEXT, len(rows) - 1)
            beyond = (last - 1, last) if k + NEXT < len(rows) else (last,)
            answers = {compared(rows[k : beyond[0] + 1])}
            if answers == {Answer.TWO} and len(beyond) > 1:
                answers.add(compared(rows[k : beyond[1] + 1]))
            alone = answers != {Answer.TWO} and Answer.ONE not in answers and last > k + 1
            if answers == {Answer.TWO} or (alone and compared(rows[k : k + 2]) is Answer.TWO):
                found.append(int(rows[k + 1]))
                break
    return sorted(found)


def _suspicious(
    z: Array, tangents: Array, rows: NDArray[np.intp], scale: Array, angle_periods: Array, noise: float
) -> Array:  # fmt: skip
    """(len(rows) - 1,) how far a step is not what its slopes lead to, or leaves next to nothing of a state."""
    found = np.zeros(len(rows) - 1)
    block = max(NEXT + 1, BLOCK // len(scale))  # not a copy of all rows of large systems
    for first in range(0, len(rows) - 1, block):
        part = rows[first : first + block + NEXT]
        y, t = z[part] / scale, tangents[part] / scale
        whole, count = Lengths.of(y, t), min(block, len(part) - 1)
        here = found[first : first + count]
        for left in range(0, len(angle_periods), SOME):
            some = slice(left, min(left + SOME, len(angle_periods)))
            strange = suspicious(y[:, some], t[:, some], noise, whole=whole)[:count]
            strange *= angle_periods[some] == 0.0
            np.maximum(here, strange.max(axis=1, initial=0.0), out=here)
    return found


def _on_one_curve(problem: Problem, z: Array, tangents: Array, scale: Array) -> bool:
    """True where solutions inside a step are those of a smooth branch through its two rows."""
    if np.any(tangents[:, -1] == 0.0) or z[0, -1] == z[1, -1]:
        return False
    length = float(np.linalg.norm((z[1] - z[0]) / scale))
    rise, fall = length * tangents / np.linalg.norm(tangents / scale, axis=1)[:, None]
    rise, fall = (v * np.sign((z[1] - z[0])[-1] * v[-1]) for v in (rise, fall))
    step = Step((z[0], z[1]), rise, (rise[-1:], fall[-1:]), scale)
    return on_cubic(problem, step, (z[0], z[1]), (rise, fall), lambda found: found, np.abs, EPSILON * scale)


def _compared(problem: Problem, z: Array, scale: Array, noise: float) -> Answer:
    """Whether the solution at the last of some rows goes back, by their parameters, to them, or to another branch.

    Beside a branch point the way back may itself lead over to another branch; from its end it does not return, then.
    """
    here, there = z[0], z[-1]
    first = problem.at_parameter(here.copy(), float(here[-1]), scale)
    nearby = None if first is None else problem.at_parameter(first + ASIDE * (there - first), float(here[-1]), scale)
    last = problem.at_parameter(there.copy(), float(there[-1]), scale)
    if first is None or nearby is None or last is None:
        return Answer.UNKNOWN
    known = np.maximum(CLEAR * np.abs(nearby - first), noise * scale)
    places, moved = way_back(z[::-1, -1]), np.abs(first - last)
    back, hop = followed(problem, last, places, scale)
    if not back or np.any(((hop > LED * moved) & (moved > known))[:-1]):
        two = singular_between(problem, first, last, scale, lambda one, other: np.abs(one - other)[:-1], known[:-1])
        return Answer.TWO if two else Answer.UNKNOWN
    solved = np.maximum(known, SOLVED * scale)
    near = np.maximum(MET * moved, known)
    if all(np.all(np.abs(found - row) <= near) for found, row in zip(back, z[-2::-1], strict=True)):
        return Answer.ONE
    at = back[-1]
    far = np.maximum(np.abs(at - last), np.abs(at - first))
    if np.any(np.abs(last - there) > np.maximum(LEFT * far, solved)):
        return Answer.UNKNOWN
    if not np.any(_leads_away(here, first, last, at, known, hop, scale)[:-1]):
        return Answer.UNKNOWN
    again, _ = followed(problem, at, [*places[-2::-1], float(there[-1])], scale)
    returns = again and np.all(np.abs(again[-1] - last) <= np.maximum(RETURNED * far, known))
    return Answer.TWO if returns else Answer.UNKNOWN


def _leads_away(
    here: Array, first: Array, last: Array, at: Array, known: Array, hop: Array, scale: Array
) -> NDArray[np.bool_]:  # fmt: skip
    """Which unknowns are elsewhere at the end of the way back, or all but zero on it and not at the row before."""
    moved, apart, size = (np.abs(v) for v in (first - last, at - first, first))
    away = (apart > APART * moved) & (moved > known) & (hop < APART * apart)
    falls = (np.abs(last) < REMNANT * size) & (np.abs(at) < REMNANT * size)
    falls &= (np.abs(first - here) < APART * np.abs(here)) & (size > EPSILON * scale)
    return np.asarray(away | falls)
