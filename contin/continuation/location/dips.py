"""Test functions that come close to zero without changing sign: minima, pairs of zeros, and points where they touch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found, Note, anchored_on_branch, at_point, found_at, noted
from contin.continuation.location.isolate import isolate, together_between
from contin.continuation.location.rest_of_step import rounding
from contin.continuation.location.sameness import same_point
from contin.continuation.outcome import Nothing, Outcome, Rejected, Verified
from contin.continuation.problem import in_two_parameters
from contin.continuation.sample import Sample
from contin.continuation.sentence import Sentence
from contin.kernels.steering import is_dip
from contin.linalg.vectors import dot

DIP_BUDGET = 45
LOST = 1e-2  # of its value at the row: a minimum this low beyond which the curve cannot be followed may be zero
ALIKE = 0.05  # arclength over which two branches that touch may be alike, and rows lie on either
TOUCH = 1e-11  # of its value at the step's end: a minimum this low is a zero that does not cross
NOTHING_LEFT = 1e-6  # of the larger value at the neighbouring rows: a resolved minimum this low may be zero
ACCURATE = 1e-9  # a point where a test only touches zero is labelled if its defining system is regular: if it is exact
STANDING = 1e-9  # the parameter's part of a unit tangent that is no more than its errors on a mesh
EXACT = ("equilibrium", "fixed-point", "algebraic")  # kinds whose tests have rounding errors only
TOUCHES = "a test function touches zero without crossing it: a degenerate point, not labelled"


def dips(stretch: Stretch, a: Sample, here: Sample, b: Sample) -> list[int]:
    """Indices of the tests that come close to zero at `here`, between a and b, without changing sign."""
    before, after = stretch.distance(a, here), stretch.distance(here, b)
    if before == 0.0 or after == 0.0:
        return []
    return [i for i in range(len(here.tests)) if is_dip(a.tests[i], here.tests[i], b.tests[i], before, after)]


def resolve_dip(stretch: Stretch, a: Sample, here: Sample, b: Sample, test: int) -> Iterator[Found | Note]:
    """A test function came close to zero at `here` without changing sign: what is there.

    Where two branches touch, Newton's method does not tell them apart, and the minimum cannot be followed to zero.
    """
    items = list(_minimum(stretch, a, here, b, test))
    yield from items
    if items or stretch.problem.adaptive or in_two_parameters(stretch.problem) or test != stretch.problem.test_of("BP"):
        return
    low, high = sorted((stretch.length_of(a), stretch.length_of(b)))
    for item in together_between(stretch, a, b):
        if isinstance(item, Verified) and item.touches:
            length = dot(stretch.base.tangent, (item.z - stretch.base.z) / stretch.frame.scale)
            if low - ALIKE <= length <= high + ALIKE:
                yield Found(length, anchored_on_branch(item, a), at_point(stretch, a, item))


def _minimum(stretch: Stretch, a: Sample, here: Sample, b: Sample, test: int) -> Iterator[Found | Note]:
    """A test function came close to zero at `here` without changing sign: find its minimum; two zeros hide where it
    crosses.

    Golden-section search with a parabola's step where that helps; ends when the sign changes or the minimum is
    resolved.
    """

    def size(sample: Sample) -> float:
        return float(sample.tests[test] * np.sign(here.tests[test]))

    low, middle, high = a, here, b
    fall = max(size(a), size(b))  # not the value at `here`, which may be as near to the minimum as chance will have it
    for _ in range(DIP_BUDGET):
        s = [stretch.length_of(x) for x in (low, middle, high)]
        f = [size(x) for x in (low, middle, high)]
        if s[2] - s[0] <= 1e-9:
            if f[1] <= _nothing(stretch, middle, high, test, fall):
                yield from _touching(stretch, low, high, test, a)
            return
        target = _parabola_minimum(s, f)
        left_wider = s[1] - s[0] > s[2] - s[1]
        margin = 0.02 * (s[2] - s[0])
        if target is None or abs(target - s[1]) < 1e-3 * (s[2] - s[0]) or not s[0] + margin < target < s[2] - margin:
            target = s[1] - 0.382 * (s[1] - s[0]) if left_wider else s[1] + 0.382 * (s[2] - s[1])
        pair, span = ((low, middle), (s[0], s[1])) if target < s[1] else ((middle, high), (s[1], s[2]))
        fraction = (target - span[0]) / (span[1] - span[0])
        trial = stretch.between(*pair, fraction)
        if trial is None:  # on a multiple branch point Newton does not work: beside it
            fraction += 0.05 if fraction < 0.5 else -0.05
            target = span[0] + fraction * (span[1] - span[0])
            trial = stretch.between(*pair, fraction)
        if trial is None:
            if f[1] <= LOST * size(here):
                yield noted(stretch, middle, TOUCHES)
            return
        f_trial = size(trial)
        if f_trial < 0.0 or trial.unstable != here.unstable:
            hidden = [*isolate(stretch, pair[0], trial), *isolate(stretch, trial, pair[1])]
            if stretch.length_of(trial) < 0.0:  # in the step before: a shorter last step would only not look there
                hidden = [replace(item, suspect=False) if isinstance(item, Note) else item for item in hidden]
            items = list(_pair(stretch, low, high, a, hidden))
            if not items and in_two_parameters(stretch.problem) and trial.tests[test] == 0.0:  # signs say nothing there
                items = [noted(stretch, trial, TOUCHES)]
            yield from items
            return
        if f_trial <= TOUCH * size(here) and min(f[0], f[2]) <= 1e-6 * size(here):
            yield from _touching(stretch, low, high, test, a)
            return
        narrower = _narrower((low, middle, high), trial, target < s[1], f_trial < f[1])
        if abs(f_trial - f[1]) <= 1e-3 * f[1] and f[1] > 1e-2 * min(f[0], f[2]):
            places, sizes = [stretch.length_of(x) for x in narrower], [size(x) for x in narrower]
            if _parabola_lowest(places, sizes) > 0.5 * sizes[1]:  # else the trial is as far from the minimum beyond it
                if f[1] <= _nothing(stretch, middle, b, test, fall):  # all that is left is rounding
                    yield from _touching(stretch, low, high, test, a)
                return  # an ordinary minimum, resolved
        low, middle, high = narrower
    if size(middle) <= max(10.0 * NOTHING_LEFT * fall, _nothing(stretch, middle, b, test, fall)):
        yield from _touching(stretch, low, high, test, a)


def _nothing(stretch: Stretch, lowest: Sample, other: Sample, test: int, fall: float) -> float:
    """Size from which a test's minimum at `lowest` is no zero: of what it is elsewhere, or its rounding errors.

    In skewed coordinates these are larger than the test between two crossings near each other.
    """
    if stretch.problem.is_lost(test, lowest.z, stretch.frame.scale):
        return abs(float(lowest.tests[test]))
    if stretch.problem.kind not in EXACT:  # trajectories and meshes have errors of their own, which are not rounding
        return NOTHING_LEFT * fall
    return max(NOTHING_LEFT * fall, float(rounding(stretch, lowest, other)[test]))


def _pair(
    stretch: Stretch, low: Sample, high: Sample, anchor: Sample, items: list[Found | Note]
) -> Iterator[Found | Note]:
    """What a dip between two samples turned out to hide; two events that errors do not tell apart are one touch."""
    points = [item.point for item in items if isinstance(item, Found)]
    alike = False
    if len(points) == 2 and points[0].type == points[1].type:
        errors = points[0].error + points[1].error
        alike = errors > ACCURATE * stretch.frame.scale[-1] and abs(points[0].z[-1] - points[1].z[-1]) <= errors
        one = same_point(stretch.problem, points[0], points[1], stretch.frame.scale)
        if one and in_two_parameters(stretch.problem):  # another type is passed on both sides, as a DP by a test of CP
            alike |= any(_is_seen_by(stretch, points[0].type, test) for test in range(len(stretch.base.tests)))
    elif len(points) == 1 and not points[0].touches:  # the second zero was not told from the first
        alike = len(items) > 1
    if not alike:
        yield from items
        return
    together: list[Outcome] = []
    if not stretch.problem.adaptive and not in_two_parameters(stretch.problem):
        together = together_between(stretch, replace(low, z=points[0].z), replace(high, z=points[-1].z))
    touching = [item for item in together if isinstance(item, Verified) and item.touches]
    if touching:
        yield from (found_at(stretch, low, point, anchor) for point in touching)
        return
    yield Note(Sentence.near(stretch.problem, points[0].z, TOUCHES), place=points[0].z)
    if len(points) == 2:
        yield from (item for item in items if isinstance(item, Note))


def _touching(stretch: Stretch, low: Sample, high: Sample, test: int, anchor: Sample) -> Iterator[Found | Note]:
    """A test touches zero between two samples: two eigenvalues that cross in opposite senses, or a degenerate point."""
    if in_two_parameters(stretch.problem):
        turned = high.tests.copy()
        turned[test] = -np.copysign(1.0, low.tests[test])
        low = replace(low, tests=np.where(np.arange(len(turned)) == test, -turned, low.tests))
        items = [i for i in together_between(stretch, low, replace(high, tests=turned)) if not isinstance(i, Nothing)]
        if any(_is_unknown(stretch, item, test) for item in items):
            yield noted(stretch, low, TOUCHES)
        else:  # it is part of a point of another type, or curves cross there (at `crossed`), whose tests may touch zero
            for item in items:
                assert isinstance(item, Verified)
                yield found_at(stretch, low, item, anchor)
        return
    together = together_between(stretch, low, high)
    scale = stretch.frame.scale[-1]
    points = [
        item for item in together if isinstance(item, Verified) and (item.touches or item.error < ACCURATE * scale)
    ]
    yield from (found_at(stretch, low, point, anchor) for point in points)
    if not points and (together or (test == 0 and not _is_unresolved(stretch, anchor, high))):
        yield noted(stretch, low, TOUCHES)


def _is_unresolved(stretch: Stretch, a: Sample, b: Sample) -> bool:
    """True where the parameter stands still as far as solving for the tangent tells: orbits that shrink to a degenerate
    equilibrium. A fold of codimension two is passed in steps between whose ends the parameter moves."""
    return stretch.problem.kind not in EXACT and max(abs(float(a.tests[0])), abs(float(b.tests[0]))) < STANDING


def _is_unknown(stretch: Stretch, item: Outcome, test: int) -> bool:
    """True where a test of a curve touches zero, and no defining system is known that is regular there."""
    if isinstance(item, Verified):
        return _is_seen_by(stretch, item.type, test) and not item.vectors.get("crossed")
    return isinstance(item, Rejected)


def _is_seen_by(stretch: Stretch, type_: str, test: int) -> bool:
    """True where points of this type are zeros of this test."""
    try:
        return stretch.problem.test_of(type_) == test
    except (KeyError, ValueError):  # no point of a curve like this one
        return False


def _parabola_minimum(s: list[float], f: list[float]) -> float | None:
    left = (f[1] - f[0]) / (s[1] - s[0])
    right = (f[2] - f[1]) / (s[2] - s[1])
    second = (right - left) / (s[2] - s[0])
    if second <= 0.0:
        return None
    return 0.5 * (s[0] + s[1]) - 0.5 * left / second


def _narrower(
    samples: tuple[Sample, Sample, Sample], trial: Sample, is_before: bool, is_lower: bool
) -> tuple[Sample, Sample, Sample]:
    """Three samples about the minimum, with a trial before or after the middle one of those that were about it."""
    low, middle, high = samples
    if is_before:
        return (low, trial, middle) if is_lower else (trial, middle, high)
    return (middle, trial, high) if is_lower else (low, middle, trial)


def _parabola_lowest(s: list[float], f: list[float]) -> float:
    """The least value of the parabola through three points; the middle one's where it has none."""
    place = _parabola_minimum(s, f)
    if place is None:
        return f[1]
    left, right = (f[1] - f[0]) / (s[1] - s[0]), (f[2] - f[1]) / (s[2] - s[1])
    second = (right - left) / (s[2] - s[0])
    return f[1] - second * (place - s[1]) * (place - s[1])
