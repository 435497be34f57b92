"""The rest of a step in which one event has been located: points of it between which nothing more can hide.

Three zeros of a test function within one step look like one. With the zero that was found divided out, what is left of
the test function must be of one sign and nearly linear from point to point; where it is not, the points are too far
apart. Close to the zero the distances shrink geometrically, so that spacings of any order of magnitude are seen.
"""

from __future__ import annotations

from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.sample import Sample, opposite
from contin.kernels import rest_of_step as kernel

CLOSE_BY: Final = 1e-6  # part of the way at which neighbours are taken whose tests should hardly differ
WIDE: Final = 4.0  # ratio of distances
BUDGET: Final = 64  # points looked at


def is_clear(
    stretch: Stretch, near: Sample, far: Sample, centre: float, crossing: NDArray[np.bool_], adaptive: bool
) -> bool:
    """True where a first look from `near`, next to the located zero at arclength `centre`, to `far` finds no event.

    The same points as those that `rounding` and `points_between` begin with, all at once; false says nothing.
    adaptive : the crossing tests must also be larger than their rounding errors.
    """
    lengths = stretch.length_of(near), stretch.length_of(far)
    a, b = abs(lengths[0] - centre), abs(lengths[1] - centre)
    if not 0.0 < a < b or b < 1.01 * a or stretch.problem.explain(near, far) != ():
        return False
    middle = (sqrt(a * b) - a) / (b - a)
    places = (CLOSE_BY, 2.0 * CLOSE_BY, middle, 0.5) if b > WIDE * a else (CLOSE_BY, 2.0 * CLOSE_BY, middle)
    found = stretch.tests_between(near, far, places, lengths)
    if found is None or found[1].count(near.unstable) < len(places):
        return False
    gaps = np.array([a, *[a + part * (b - a) for part in places[2:]], b])
    return bool(
        kernel.is_clear(near.tests, found[0], far.tests, np.array(places), gaps, crossing.astype(np.int64), adaptive)
    )


def points_between(
    stretch: Stretch, near: Sample, far: Sample, centre: float, crossing: NDArray[np.bool_], noise: Array
) -> list[Sample]:
    """Points from `near`, next to the located zero at arclength `centre`, to `far`, both included.

    crossing (k,) : the tests that change sign at the centre.  noise (k,) : what their rounding errors are like there.
    """

    def rest(sample: Sample) -> Array:
        distance = abs(stretch.length_of(sample) - centre)
        known = np.where(np.abs(sample.tests) > noise, sample.tests, 0.0)
        return np.where(crossing, known / max(distance, 1e-300), known)

    kept, waiting, budget = [near], [far], BUDGET
    while waiting:
        left, right = kept[-1], waiting[-1]
        middle = None
        if budget > 0 and stretch.problem.explain(left, right) == ():
            middle = _middle(stretch, left, right, centre)
            budget -= 1
        if middle is None:
            kept.append(waiting.pop())
        elif not _is_straight(rest(left), rest(middle), rest(right), _fraction(stretch, left, middle, right)):
            waiting.append(middle)
        elif budget > 0 and _is_wide(stretch, left, right, centre) and (half := stretch.between(left, right, 0.5)):
            budget -= 1  # `middle` lies next to `left`: it says nothing about the farther part
            if _is_straight(rest(left), rest(half), rest(right), _fraction(stretch, left, half, right)):
                kept += [middle, waiting.pop()]
            else:
                kept.append(middle)
                waiting.append(half)
        else:
            kept += [middle, waiting.pop()]
    return kept


def rounding(stretch: Stretch, near: Sample, far: Sample) -> Array:
    """Rounding errors of the tests (k,) at `near`, from second differences of points next to it towards `far`."""
    values = [near.tests]
    for fraction in (CLOSE_BY, 2.0 * CLOSE_BY):
        beside = stretch.between(near, far, fraction)
        if beside is None:
            return np.zeros(len(near.tests))
        values.append(beside.tests)
    return np.asarray(kernel.CLEAR * np.abs(values[0] - 2.0 * values[1] + values[2]))


def solved(stretch: Stretch, row: Sample, other: Sample) -> Sample:
    """A row of a march as a probe gives it: solved further, with the tests of the solution itself.

    The march stops at its tolerance and takes the tangent from the last Jacobian, so that its tests are off by the last
    correction: 3e-8 in a canard explosion, where dp/ds is 1e-7. Tests of probes are compared with tests of probes only.
    """
    if not stretch.problem.adaptive:
        return row
    return stretch.between(row, other, 0.0) or row


def told_apart(a: Sample, b: Sample, noise: Array) -> bool:
    """False where what changes between a and b is no more than rounding errors of the tests."""
    changed = opposite(a.tests, b.tests)
    lost = (np.abs(a.tests) <= noise) | (np.abs(b.tests) <= noise)
    return not bool(np.any(changed & lost)) and not (a.unstable != b.unstable and bool(np.any(lost & (noise > 0.0))))


def is_linear(stretch: Stretch, point: Sample, near: Sample, nearer: Sample, crossing: NDArray[np.bool_]) -> bool:
    """True where every crossing test vanishes with its distance from the point, as at a simple zero alone.

    That is, without a change of sign, with a power of the distance between 1/2 and 3/2.
    """
    centre = stretch.length_of(point)
    d_near, d_nearer = (abs(stretch.length_of(s) - centre) for s in (near, nearer))
    if not 0.0 < d_nearer < d_near:
        return True
    ratio = d_near / d_nearer
    sizes, nearer_sizes = np.abs(near.tests[crossing]), np.abs(nearer.tests[crossing])
    low, high = sqrt(ratio) * nearer_sizes, ratio * sqrt(ratio) * nearer_sizes
    if np.any(opposite(near.tests[crossing], nearer.tests[crossing])):  # another zero lies between them
        return False
    return bool(np.all((sizes > low) & (sizes < high)))  # false for 0 and NaN: the test is lost in its rounding


def _middle(stretch: Stretch, left: Sample, right: Sample, centre: float) -> Sample | None:
    """The point at the geometric mean of the distances from the centre."""
    a, b = (abs(stretch.length_of(s) - centre) for s in (left, right))
    if not 0.0 < a < b or b < 1.01 * a:
        return None
    return stretch.between(left, right, float((np.sqrt(a * b) - a) / (b - a)))


def _is_wide(stretch: Stretch, left: Sample, right: Sample, centre: float) -> bool:
    """True where the distances from the centre differ so much that their geometric mean is close to the smaller one."""
    a, b = (abs(stretch.length_of(s) - centre) for s in (left, right))
    return bool(b > WIDE * a)


def _fraction(stretch: Stretch, left: Sample, middle: Sample, right: Sample) -> float:
    a, m, b = (stretch.length_of(s) for s in (left, middle, right))
    return (m - a) / (b - a)


def _is_straight(left: Array, middle: Array, right: Array, fraction: float) -> bool:
    """True where no test has room for two zeros between these values."""
    return bool(kernel.are_straight(left, middle, right, fraction))
