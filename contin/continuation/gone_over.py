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

UNEXPLAINED: Final = 0.2  # part of a state's change that is not what its slopes lead to (of resolved steps: 1e-3)
STRAY: Final = 0.6  # part of a state's slope by which it differs from the line through the two before
VANISHED: Final = 0.05  # part of a state that a few steps leave of it where it is zero on another branch
LED: Final = 0.2  # of what changes in the step: how far the way back is from what is foretold where it jumps itself
LEFT: Final = 0.1  # of how far the way back has led: what the corrector has left in the row where it begins
SOLVED: Final = 1e-8  # scaled: what the corrector leaves in rows
ASIDE: Final = 0.01  # of the way to another solution: a guess from which one is found again to what is known of it
CLEAR: Final = 10.0  # times what is not known of a solution: a difference that is none of it
ROUNDED: Final = float(np.finfo(float).eps)  # scaled: a state below it is the rounding of one that is zero
APART: Final = 0.5  # of a state's change: two solutions that differ by more are two
RETURNED: Final = 1e-3  # of how far the way back has led: where it begins, found again from its end
MOST: Final = 20  # suspicious steps of an arm that are looked at: each costs a few times `PARTS` solutions
PARTS: Final = 8  # of a step, on the way back at fixed parameters
BLOCK: Final = 1_000_000  # numbers that are looked at at once
NEXT: Final = 3  # rows: one or two that the corrector leaves between two branches are none of either


def gone_over(
    problem: Problem, z: Array, tangents: Array, start: int, labelled: set[int], scale: Array, noise: float
) -> list[int]:  # fmt: skip
    """The first rows of z (K, N), raw tangents beside, that on both ways from `start` are of another branch.

    labelled : rows of special points, where branches meet.  noise : rounding of rows, in scaled unknowns.
    """

    def two(rows: NDArray[np.intp]) -> bool:
        steps = ([a, b] for a, b in pairwise(rows))
        if all(_on_one_curve(problem, z[step], tangents[step], scale) for step in steps):
            return False
        return _are_two(problem, z[rows], scale, noise)

    return first_beyond(
        len(z), start, labelled,
        lambda rows, sense: _suspicious(z, sense * tangents, rows, scale, problem.angle_periods, noise), two, MOST,
    )  # fmt: skip


def first_beyond(
    count: int, start: int, labelled: set[int], strange: Callable[[NDArray[np.intp], int], Array],
    are_two: Callable[[NDArray[np.intp]], bool], most: int,
) -> list[int]:  # fmt: skip
    """The first of `count` rows on both ways from `start` that are beyond a step between two branches.

    strange : of rows in turn, whose tangents have this sense, how suspicious the step from each one is, 0 where it is
    not.  are_two : whether the first and the last of some rows are of two branches; asked of the `most` strangest steps
    on each way, and, where rows change to and fro between two branches, of a step's own rows.
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
            if all(are_two(rows[k : row + 1]) for row in beyond) or (last > k + 1 and are_two(rows[k : k + 2])):
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
        strange = suspicious(y, t, noise)[:block]
        strange[:, :-1] *= angle_periods == 0.0
        found[first : first + len(strange)] = strange[:, :-1].max(axis=1, initial=0.0)
    return found


def suspicious(y: Array, t: Array, noise: float | Array, alone: Callable[[Array], Array] = np.abs) -> Array:
    """(K - 1, k), of rows y with tangents t: which part of a step is not what slopes lead to, 0 where it may pass.

    noise : what is not known of rows, or (K - 1, 1) of steps.
    alone : lengths (K, k) of what is asked by itself, of values (K, N): each unknown, or each function.
    """
    far = np.minimum(np.arange(len(y) - 1) + NEXT, len(y) - 1)
    return np.maximum(_unexplained(y, t, noise, alone), _vanishing(y[:-1], y[far], t[:-1], t[far], noise, alone))


def _unexplained(y: Array, t: Array, noise: float | Array, alone: Callable[[Array], Array]) -> Array:
    """Where the parameter goes one way, and an unknown not as its slopes say."""
    t = t / np.linalg.norm(t, axis=1)[:, None]
    step, slopes = y[1:] - y[:-1], alone(t)
    h, moved, steep = np.linalg.norm(step, axis=1)[:, None], alone(step), np.maximum(slopes[1:], slopes[:-1])
    apart = _part(alone(step - 0.5 * h * (t[1:] + t[:-1])), np.maximum(steep * h, moved), UNEXPLAINED)
    bend = (t[1:] - t[:-1]) / np.where(h > 0.0, h, 1.0)
    if len(bend) > 1:
        turned = _part(alone(bend[1:] - bend[:-1]) * h[1:], steep[1:], STRAY)
        apart[1:] = np.maximum(apart[1:], UNEXPLAINED / STRAY * turned)
    return np.asarray(apart * ((moved > noise) & (t[1:, -1:] * t[:-1, -1:] > 0.0)))


def _part(left: Array, whole: Array, least: float) -> Array:
    """left / whole, 0 where that is less than `least`."""
    sure = left > least * whole
    return np.asarray(np.where(sure, left / np.where(sure & (whole > 0.0), whole, 1.0), 0.0))


def _vanishing(
    near: Array, far: Array, t_near: Array, t_far: Array, noise: float | Array, alone: Callable[[Array], Array]
) -> Array:  # fmt: skip
    """Of points and others a few rows on: where the slopes do not lead to how little is left, of unknowns or of slopes
    that would have changed them by more than noise."""
    moved, before, steep, level = far - near, alone(near), alone(t_near), alone(t_far)
    length = np.linalg.norm(moved, axis=1)[:, None]
    left = np.maximum(alone(moved - length * t_far), alone(moved - 0.5 * length * (t_near + t_far)))
    little = _part(left, before, UNEXPLAINED) * ((alone(far) < VANISHED * before) & (before > ROUNDED))
    flat = _part(left, length * steep, UNEXPLAINED) * (level < VANISHED * steep)
    flat *= (length * steep > noise) & (t_far[:, -1:] * t_near[:, -1:] > 0.0)
    return np.maximum(little, flat)


def _on_one_curve(problem: Problem, z: Array, tangents: Array, scale: Array) -> bool:
    """True where solutions inside a step are those of a smooth branch through its two rows."""
    width = float(z[1, -1] - z[0, -1])
    if np.any(tangents[:, -1] == 0.0) or width == 0.0:
        return False
    rise, fall = (width * t / t[-1] for t in tangents)
    step = Step(z[0], rise, width, scale)
    return on_cubic(problem, step, (z[0], z[1]), (rise, fall), lambda found: found, np.abs, ROUNDED * scale)


def _are_two(problem: Problem, z: Array, scale: Array, noise: float) -> bool:
    """True where the solution at the last of some rows goes back, by their parameters, to another than the first.

    Beside a branch point the way back may itself lead over to another branch; from its end it does not return, then.
    """
    here, there = z[0], z[-1]
    first = problem.at_parameter(here.copy(), float(here[-1]), scale)
    nearby = None if first is None else problem.at_parameter(first + ASIDE * (there - first), float(here[-1]), scale)
    last = problem.at_parameter(there.copy(), float(there[-1]), scale)
    if first is None or nearby is None or last is None:
        return False
    known = np.maximum(CLEAR * np.abs(nearby - first), noise * scale)
    places = way_back(z[::-1, -1])
    at, hop = followed(problem, last, places, scale)
    if at is None or np.any((hop[:-1] > LED * np.abs(first - last)[:-1]) & (np.abs(first - last) > known)[:-1]):
        return singular_between(problem, first, last, scale, lambda one, other: np.abs(one - other)[:-1], known[:-1])
    far = np.maximum(np.abs(at - last), np.abs(at - first))
    if np.any(np.abs(last - there) > np.maximum(LEFT * far, np.maximum(known, SOLVED * scale))):
        return False
    moved, apart, size = (np.abs(v)[:-1] for v in (first - last, at - first, first))
    away = (apart > APART * moved) & (moved > known[:-1]) & (hop[:-1] < APART * apart)
    falls = (np.abs(last[:-1]) < VANISHED * size) & (np.abs(at[:-1]) < VANISHED * size)
    falls &= (np.abs(first - here)[:-1] < APART * np.abs(here[:-1])) & (size > ROUNDED * scale[:-1])
    if not np.any(away | falls):
        return False
    again, _ = followed(problem, at, [*places[-2::-1], float(there[-1])], scale)
    if again is None:
        return False
    return bool(np.all(np.abs(again - last) <= np.maximum(RETURNED * far, known)))


def followed(
    problem: Problem, start: Array, places: list[float], scale: Array,
    length: Callable[[Array, Array], Array] = lambda _, change: np.abs(change),
) -> tuple[Array | None, Array]:  # fmt: skip
    """The solution at the last of some parameters in turn, and how far one was from what was foretold.

    length : (k,), each compared by itself, of a solution and how far it is from what was foretold.
    """
    at, before, hop = start, None, np.zeros(1)
    for place in places:
        guess = at.copy() if before is None else 2.0 * at - before
        found = problem.at_parameter(guess.copy(), place, scale)
        if found is None:
            return None, hop
        before, at, hop = at, found, np.maximum(hop, length(found, found - guess))
    return at, hop


def way_back(parameters: Array) -> list[float]:
    """From the first of some values to the last, by all of them, each step in `PARTS` parts."""
    steps = [a + (b - a) * np.arange(1, PARTS + 1) / PARTS for a, b in pairwise(parameters)]
    return [float(place) for step in steps for place in step]
