"""From "something changed between these two points" to verified special points: isolate, locate, verify.

Between two samples the problem is asked which simple events explain *all* that changed: the signs of the test functions
and the number of unstable eigenvalues, which are two independent counts. While they do not agree, the interval is
halved; what is left when it cannot be halved further coincides, and is handed to the problem as one compound event.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contin.continuation.curve import Stretch
from contin.continuation.defects import contained
from contin.continuation.location.both_sides import (
    Side,
    are_all,
    cluster_at,
    sides_beyond,
    sides_of,
    untold,
    vanishes_linearly,
)
from contin.continuation.location.coinciding import located
from contin.continuation.location.found import (
    Found,
    Note,
    anchored_on_branch,
    at_point,
    exactly,
    noted,
    rejected,
    where,
)
from contin.continuation.location.lost_digits import turning_alone, unresolved
from contin.continuation.location.rest_of_step import (
    is_clear,
    points_between,
    rounding,
    solved,
    told_apart,
)
from contin.continuation.location.sameness import same_point
from contin.continuation.outcome import NOTHING, Jump, Nothing, Outcome, Rejected, Verified, unverified
from contin.continuation.problem import in_two_parameters
from contin.continuation.sample import Sample, opposite
from contin.linalg.vectors import norm

COINCIDENT = 1e-10  # events closer than this (arclength) are one compound event
NARROW = 1e-4  # a located bracket, relative to the step, from which Newton on the defining system starts
UNPLACED = 0.05  # error of a point, as a part of the range, from which a fold may be taken for a branch point
DEPTH = 60  # halvings of one step
HALVINGS = 600  # ... in all: where tests are rounding, every half has changes of its own
ROUNDING = 1e-14  # a test this small on both sides of an event may be zero all along
LEFT = "Newton on its defining system left the neighbourhood"
DECREASED = 0.8  # a test at a quarter of the distance from its zero, beside that there: no jump
SAME_THERE = ", where {parameter} is the same to within its error"
LOST_IN_ROUNDING = "test functions are lost in their rounding errors: events may not be told apart"


def _lost(stretch: Stretch, sample: Sample, alike: bool = False) -> Note:
    """alike : all that could lie there has the same parameter."""
    text = LOST_IN_ROUNDING + (SAME_THERE.format(parameter=stretch.problem.parameters[0]) if alike else "")
    return noted(stretch, sample, text, hides=not alike, at=sample.z)


def isolate(
    stretch: Stretch, a: Sample, b: Sample, depth: int = 0, beside: tuple[Verified, ...] = ()
) -> Iterator[Found | Note]:
    """All events between a and b, in order.

    beside : events of the same step that are known already: a change that leads to one of them again is rounding.
    """
    types = stretch.problem.explain(a, b)
    if types == ():
        return
    if any(unresolved(stretch.problem, row.eigenvalues[None]).any() for row in (a, b)):
        if not stretch.problem.multiplied_out:  # the branch ends there, in words
            return
        a, b = turning_alone(a), turning_alone(b)
        types = stretch.problem.explain(a, b)
        if types == ():
            yield _lost(stretch, a)
            return
    width = stretch.distance(a, b)
    equal = _equal(stretch, a, b) if width > COINCIDENT and depth < DEPTH else None
    if equal is not None:
        low, high, item = equal
        yield from isolate(stretch, a, low, depth + 1, beside)
        yield item
        yield from isolate(stretch, high, b, depth + 1, beside)
        return
    if types is not None and len(types) == 1 and width > COINCIDENT:
        low, high, verified = _locate(stretch, types[0], a, b)
        if isinstance(verified, Found) and any(_is_one(stretch, verified.point, known) for known in beside):
            yield _lost(stretch, verified.sample, _turns_only(stretch, types[0], verified.point))
        elif isinstance(verified, Found):
            companions = list(_with_companions(stretch, a, b, verified))
            if len(companions) == 1 and _is_plain(stretch, companions[0], types[0]):
                yield from _with_rest(stretch, a, b, companions[0], depth, beside)
            else:
                yield from companions
        elif isinstance(verified, Nothing):  # a change that is no event, such as a neutral saddle
            yield from _around(stretch, (a, low, high, b), depth)
        elif depth < DEPTH:
            yield from isolate(stretch, a, low, DEPTH, beside)
            together = list(_compound(stretch, low, high, verified.reason))
            only = together[0] if len(together) == 1 else None
            if isinstance(only, Found) and (stretch.problem.adaptive or _is_plain(stretch, only, types[0])):
                yield from _with_rest(stretch, a, b, only, depth if stretch.problem.adaptive else DEPTH, beside)
            else:
                yield from together
            yield from isolate(stretch, high, b, DEPTH, beside)
        else:
            yield rejected(stretch, low, verified)
        return
    if width <= COINCIDENT or depth >= DEPTH or len(stretch.halved) >= HALVINGS:
        yield from _compound(stretch, a, b, "changes that could not be told apart")
        return
    stretch.halved.append(width)
    yield from _halves(stretch, a, b, depth, beside)


def _equal(stretch: Stretch, a: Sample, b: Sample) -> tuple[Sample, Sample, Found | Note] | None:
    """Multipliers that pass together, and a bracket of where; None where none do."""
    every = (located(stretch, a, b, together) for together in stretch.problem.together(a, b))
    return next((found for found in every if found is not None), None)


def _halves(stretch: Stretch, a: Sample, b: Sample, depth: int, beside: tuple[Verified, ...]) -> Iterator[Found | Note]:
    """All events of two parts of an interval; what coincides where there is no point in between that tells."""
    middle: Sample | None = None
    for fraction in (0.5, 0.382, 0.618, 0.25, 0.75):
        middle = stretch.between(a, b, fraction) or middle
        if middle is not None and not np.any((middle.tests == 0.0) & (a.tests != 0.0)):  # on an event signs say nothing
            break
    if middle is None:
        yield from _compound(stretch, a, b, "the curve could not be followed between two accepted points")
        return
    if stretch.problem.explain(a, middle) == () == stretch.problem.explain(middle, b):  # zero there: signs say nothing
        yield from _compound(stretch, a, b, "changes that could not be told apart")
        return
    yield from isolate(stretch, a, middle, depth + 1, beside)
    yield from isolate(stretch, middle, b, depth + 1, beside)


def _is_plain(stretch: Stretch, found: Found, type_: str) -> bool:
    """True for a point beside which the curve goes on; one of another type than was looked for may end it, as DP.

    Not so where several eigenvalues vanish: tests do not vanish with the distance there, and some only jump.
    """
    several = int(found.point.vectors.get("kernel", 1)) != 1
    alone = not (several or found.point.touches)
    return alone and (found.point.type == type_ or not in_two_parameters(stretch.problem))


def _around(stretch: Stretch, samples: tuple[Sample, Sample, Sample, Sample], depth: int) -> Iterator[Found]:
    """Events on both sides of a change of one test that is none, from a, low, high, b: it lies between low and high."""
    a, low, high, b = samples
    crossing = opposite(a.tests, b.tests)
    at = [stretch.length_of(low), stretch.length_of(high)]
    centre = 0.5 * (at[0] + at[1])
    if np.count_nonzero(crossing) == 1 and at[0] != at[1]:  # where the test vanishes, to second order in the bracket
        before, after = float(low.tests[crossing][0]), float(high.tests[crossing][0])
        if opposite(before, after):
            centre = at[0] + (at[1] - at[0]) * before / (before - after)
    for near, far in ((low, a), (high, b)):
        if near is far:
            continue
        if abs(stretch.length_of(near) - centre) < 0.1 * NARROW * stretch.distance(near, far):  # there it is rounding
            near = stretch.between(near, far, NARROW) or near
        rest = _rest(stretch, near, far, centre, crossing, depth)
        yield from (item for item in rest if isinstance(item, Found))


def _with_rest(
    stretch: Stretch, a: Sample, b: Sample, found: Found, depth: int, beside: tuple[Verified, ...]
) -> Iterator[Found | Note]:
    """A located point and the rest of the step on both sides of it: what it hid, or a note where it is no simple zero.

    The point knows how far from it (along the curve) its zero may be: zeros in between are itself.
    """
    point = replace(found.sample, z=found.point.z)
    crossing = opposite(a.tests, b.tests)
    sides = sides_of(stretch, point, (a, b), crossing)
    if any(look.rounding for look in sides) or (not sides and _is_rounding(stretch, a, b)):
        yield _lost(stretch, point)
        return
    crossing = _of_event(crossing, sides)
    reach = max((look.distance for look in sides if look.lost), default=0.0)
    if reach > 0.0:
        found = replace(found, point=replace(found.point, vectors={**found.point.vectors, "reach": reach}))
    yield found
    unseen = untold(stretch, point, (a, b), sides)
    if unseen > 0.0:
        text = f"{found.point.type}: the branch is not found beside it, and others may lie closer than {unseen:g} to it"
        yield noted(stretch, point, text, hides=True)
    simple, lost, centre, labelled = True, False, stretch.length_of(point), [found.length]
    for look in sides:
        simple &= vanishes_linearly(stretch, point, look, crossing)
        type_, frame = found.point.type, stretch.frame
        near, far = (stretch.problem.measured_beside(type_, sample, frame) for sample in (look.near, look.far))
        for item in _rest(stretch, near, far, centre, crossing, depth, (*beside, found.point)):
            if isinstance(item, Found) and item.point.type == found.point.type:
                labelled.append(item.length)
            lost |= isinstance(item, Note) and item.hides
            yield item
    if not sides and not stretch.problem.adaptive:  # the step is short: what it cannot tell, the curve beyond it may
        beyond = sides_beyond(stretch, point, (a, b))
        crossing = _of_event(crossing, beyond)
        simple = all(vanishes_linearly(stretch, point, look, crossing) for look in beyond)
        sides = [] if simple else beyond
    told = simple or (len(labelled) > 1 and are_all(stretch, sides, crossing, labelled))
    cluster = cluster_at(stretch, point, sides, crossing) if lost or not told else None
    words = "" if cluster is None else cluster.words
    if not told:
        close = max(look.distance for look in sides)
        text = f"{found.point.type} is degenerate, or others lie closer than {close:g} to it{words}"
        alike = _turns_only(stretch, found.point.type, found.point, *(look.near for look in sides))
        if alike:
            text += SAME_THERE.format(parameter=stretch.problem.parameters[0])
        yield noted(stretch, point, text, hides=stretch.problem.adaptive and not alike)
    elif cluster is not None and cluster.count > len(labelled):
        text = f"{found.point.type}: others lie about {cluster.distance:g} or less from it{words}"
        yield noted(stretch, point, text, hides=True)


def _of_event(crossing: NDArray[np.bool_], sides: Sequence[Side]) -> NDArray[np.bool_]:
    """Of the tests that change their sign, those that do so at the event.

    Not what is zero all along the curve; and of several ones, not what changes elsewhere in the step, or only jumps.
    """
    if not sides:
        return crossing
    zero = np.all([np.abs(side.near.tests) <= ROUNDING for side in sides], axis=0)
    told: NDArray[np.bool_] = crossing & ~zero
    if np.count_nonzero(told) > 1:
        vanishing = told & np.all([_decreases(side) for side in sides], axis=0)
        if len(sides) == 2:
            vanishing &= sides[0].near.tests * sides[1].near.tests < 0.0
        told = vanishing if vanishing.any() else told
    return told if told.any() else crossing


def _decreases(side: Side) -> NDArray[np.bool_]:
    """The tests that are smaller the nearer to the point."""
    if side.nearer is None:
        return np.ones(len(side.near.tests), dtype=np.bool_)
    smaller: NDArray[np.bool_] = np.abs(side.nearer.tests) < DECREASED * np.abs(side.near.tests)
    return smaller


def _turns_only(stretch: Stretch, type_: str, point: Verified, *others: Sample) -> bool:
    """True of a fold near which the parameter changes by less than the fold's error: others there are the same point.

    As beside a canard, where branches of orbits are vertical to rounding.
    """
    if in_two_parameters(stretch.problem) or stretch.problem.test_of(type_) != 0:
        return False
    return all(abs(float(other.z[-1] - point.z[-1])) <= point.error for other in others)


def _is_rounding(stretch: Stretch, a: Sample, b: Sample) -> bool:
    """True for a step too short to look at beside its event, in which a change of sign is one of rounding errors."""
    return not stretch.problem.adaptive and not told_apart(a, b, rounding(stretch, a, b))


def next_to_event(
    stretch: Stretch, near: Sample, far: Sample, event: Verified, centre: float
) -> Iterator[Found | Note]:
    """Events in the step beside the one with `event`, where nothing was seen: `near` lies between the event and `far`.

    Of three crossings, two may lie in that step; signs and minima at its ends do not show them.  centre : arclength of
    the event along the stretch, which may have another mesh.
    """
    problem = stretch.problem
    if event.touches or problem.explain(near, far) != ():
        return
    if event.normal_form.get("kind") == "nonsmooth":  # what is divided out is a zero of a smooth function
        return
    near, far = solved(stretch, near, far), solved(stretch, far, near)
    test = problem.test_of(event.type)
    if test is None and in_two_parameters(problem):
        return
    crossing = np.arange(len(near.tests)) == (-1 if test is None else test)
    yield from _rest(stretch, near, far, centre, crossing, 0)


def _rest(
    stretch: Stretch,
    near: Sample,
    far: Sample,
    centre: float,
    crossing: NDArray[np.bool_],
    depth: int,
    beside: tuple[Verified, ...] = (),
) -> Iterator[Found | Note]:
    """Events between `near`, next to a located zero at `centre`, and `far`."""
    if depth >= DEPTH or is_clear(stretch, near, far, centre, crossing, stretch.problem.adaptive):
        return
    noise = rounding(stretch, near, far)
    points = points_between(stretch, near, far, centre, crossing, noise)
    unclear = None
    for sample in points if stretch.problem.adaptive else ():
        if np.any((np.abs(sample.tests) <= noise)[crossing]):
            unclear = sample
    for a, b in pairwise(points):
        if stretch.problem.explain(a, b) == ():
            continue
        if told_apart(a, b, noise):
            first, second = (a, b) if stretch.length_of(a) <= stretch.length_of(b) else (b, a)
            yield from isolate(stretch, first, second, depth + 1, beside)
        else:
            unclear = a
    if unclear is not None:
        alike = bool(beside) and _turns_only(stretch, beside[-1].type, beside[-1], unclear)
        yield _lost(stretch, unclear, alike)


def _is_one(stretch: Stretch, a: Verified, b: Verified) -> bool:
    return same_point(stretch.problem, a, b, stretch.frame.scale)


def _verified(stretch: Stretch, type_: str, near: Sample) -> Outcome:
    """The problem's verification; one that fails with an error loses the label, not the branch."""
    errors: list[str] = []
    outcome: Outcome = NOTHING
    with contained(errors.append):
        outcome = stretch.problem.verify(type_, near, stretch.frame)
    return unverified(type_, errors[0], defect=True) if errors else _placed(stretch, outcome)


def _placed(stretch: Stretch, outcome: Outcome) -> Outcome:
    """The outcome, but for a point whose error is a part of the range: that is no place."""
    if isinstance(outcome, Verified) and not outcome.error < UNPLACED * float(stretch.frame.scale[-1]):
        return unverified(outcome.type, f"its place is known to {outcome.error:.1e} only, in a range of this width")
    return outcome


def together_between(stretch: Stretch, a: Sample, b: Sample) -> list[Outcome]:
    """Events that coincide between a and b; one that fails with an error loses the labels, not the branch."""
    errors: list[str] = []
    items: list[Outcome] = []
    with contained(errors.append):
        items = list(stretch.problem.verify_compound(a, b, stretch.frame))
    if errors:
        return [Rejected(f"not verified: {errors[0]}", suspect=True, defect=True)]
    return [_placed(stretch, item) for item in items]


def _locate(stretch: Stretch, type_: str, a: Sample, b: Sample) -> tuple[Sample, Sample, Found | Rejected | Nothing]:
    """One simple event: bracket its test, then verify. Returns the bracket and the point, or why it is none."""
    problem = stretch.problem
    index = problem.test_of(type_)
    if index is None and a.unstable == b.unstable:  # a branch that turns where it crosses another
        changed = np.flatnonzero(opposite(a.tests, b.tests))
        index = int(changed[0]) if changed.size else None

    def value(sample: Sample) -> float:
        if index is None:
            return float(sample.unstable - a.unstable) - 0.5 * (b.unstable - a.unstable)
        return float(sample.tests[index])

    width = stretch.distance(a, b)
    s_a, s_b = stretch.length_of(a), stretch.length_of(b)
    low, high = a, b
    outcome: Rejected | Nothing = NOTHING
    for accuracy in (NARROW * width, COINCIDENT):
        low, high = stretch.zero(value, low, high, accuracy)
        if accuracy == COINCIDENT:  # Newton starts as close as it can: what it finds is the event
            first, last, slack = s_a, s_b, 0.02 * abs(s_b - s_a) + 1e-7
        else:  # another event may be as near as this one: it must lie in the bracket
            first, last = stretch.length_of(low), stretch.length_of(high)
            slack = 0.01 * abs(last - first) + 1e-9
        near = low if abs(value(low)) < abs(value(high)) else high
        verified = _verified(stretch, type_, near)
        if isinstance(verified, Verified):
            moved = float(np.linalg.norm((verified.z - near.z) / stretch.frame.scale))
            length = float(stretch.base.tangent @ ((verified.z - stretch.base.z) / stretch.frame.scale))
            other = width if verified.type != type_ else 0.0  # what was looked for belongs to another event beside it
            slack += other
            if moved <= 0.2 * width + other + 1e-6 and min(first, last) - slack <= length <= max(first, last) + slack:
                return low, high, Found(length, anchored_on_branch(verified, a), at_point(stretch, near, verified))
            outcome = unverified(type_, LEFT)
        else:
            outcome = verified
            if isinstance(verified, Nothing):
                break
    return low, high, outcome


def _with_companions(stretch: Stretch, a: Sample, b: Sample, found: Found) -> Iterator[Found]:
    """`found`, or all that coincides with it: crossings in opposite senses leave signs and counts as they were."""
    if found.point.crowded:
        z = found.point.z
        items = together_between(stretch, replace(a, z=z), replace(b, z=z))
        together = [item for item in items if isinstance(item, Verified)]
        if any(item.type == found.point.type for item in together):
            base, scale = stretch.base, stretch.frame.scale
            lengths = [float(base.tangent @ ((item.z - base.z) / scale)) for item in together]
            for k in np.argsort(lengths, kind="stable"):
                yield Found(lengths[k], anchored_on_branch(together[k], base), found.sample)
            return
    yield found


def _compound(stretch: Stretch, a: Sample, b: Sample, why: str) -> Iterator[Found | Note]:
    """What coincides at one place: a corner of a piecewise equation, or several smooth events.

    A point farther away than the longest step is on another part of the curve, or on another curve (Newton for a fold
    of orbits may find one that these orbits run through twice).
    """
    corner = stretch.problem.verify_corner(a, b, stretch.frame)
    items = [corner] if corner is not None else together_between(stretch, a, b)
    if not items:
        yield noted(stretch, a, why, True)
    for item in items:
        if isinstance(item, Verified) and norm((item.z - a.z) / stretch.frame.scale) > stretch.settings.max_step:
            yield rejected(stretch, a, unverified(item.type, LEFT), True)
        elif isinstance(item, Verified):
            length = float(stretch.base.tangent @ ((item.z - stretch.base.z) / stretch.frame.scale))
            yield Found(length, anchored_on_branch(item, stretch.base), at_point(stretch, a, item))
            if corner is None and _is_elsewhere(stretch, a, b, item, length):  # at a corner tests need not be small
                yield _lost(stretch, a)
        elif isinstance(item, Jump):
            said = where(stretch, a, item.text) if item.at is None else exactly(stretch, item.at, item.text)
            yield Note(said, jump=stretch.length_of(b))
        elif isinstance(item, Rejected):
            timeless = not stretch.problem.has_stability and not in_two_parameters(stretch.problem)
            yield rejected(stretch, a, item, item.suspect, hides=item.suspect and timeless)


def _is_elsewhere(stretch: Stretch, a: Sample, b: Sample, found: Verified, length: float) -> bool:
    """True where the count changes between a and b, no test does, and the point found lies beyond its error from there.

    The count then changed where the critical eigenvalue came within its rounding errors of the stability boundary.
    From there to the point its sign is not known, and further points may lie between.
    """
    if np.any(opposite(a.tests, b.tests)):
        return False
    low, high = sorted((stretch.length_of(a), stretch.length_of(b)))
    return max(low - length, length - high) > max(COINCIDENT, found.error / float(stretch.frame.scale[-1]))
