"""From "something changed between these two points" to verified special points: isolate, locate, verify.

Between two samples the problem is asked which simple events explain *all* that changed: the signs of the test functions
and the number of unstable eigenvalues, which are two independent counts. While they do not agree, the interval is
halved; what is left when it cannot be halved further coincides, and is handed to the problem as one compound event.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.defects import contained
from contin.continuation.digits import unresolved
from contin.continuation.looking_again import (
    crossings_together,
    is_clear,
    is_linear,
    points_between,
    rounding,
    solved,
    told_apart,
)
from contin.continuation.march import is_dip
from contin.continuation.problem import (
    NOTHING,
    Jump,
    Nothing,
    Outcome,
    Rejected,
    Sample,
    Verified,
    is_planar,
    unverified,
)
from contin.continuation.sameness import same_point
from contin.errors import InputError, NotFiniteError
from contin.linalg.vectors import dot

COINCIDENT = 1e-10  # events closer than this (arclength) are one compound event
NARROW = 1e-4  # a located bracket, relative to the step, from which Newton on the defining system starts
CLOSE = 1e-6  # arclength: how near to a located event the step is looked at again
CLOSE_ADAPTIVE = 1e-4  # ... of discretised problems, whose test functions are less exact
UNPLACED = 0.05  # error of a point, as a part of the range, from which a fold may be taken for a branch point
SLIGHT = 1e-9  # a test this small so near to its zero may be rounding
FARTHER = 4.0  # ... and the ratio of distances at which it is looked for where it is not
DIP_BUDGET = 45
LOST = 1e-2  # of its value at the row: a minimum this low beyond which the curve cannot be followed may be zero
ALIKE = 0.05  # arclength over which two branches that touch may be alike, and rows lie on either
TOUCH = 1e-11  # of its value at the step's end: a minimum this low is a zero that does not cross
ACCURATE = 1e-9  # a point where a test only touches zero is labelled if its defining system is regular: if it is exact
ALIGNED = 0.99  # cosine from which the tangent at a point is that of the branch that was followed
CHORD = 1e-7  # shorter chords have no direction
DEPTH = 60  # halvings of one step
LOST_IN_ROUNDING = "test functions are lost in their rounding errors: events may not be told apart"
TOUCHES = "a test function touches zero without crossing it: a degenerate point, not labelled"


@dataclass(frozen=True, eq=False)
class Found:
    """A verified point and where it lies on the stretch."""

    length: float
    point: Verified
    sample: Sample  # the located sample next to it, with the branch's tangent at the point itself


@dataclass(frozen=True)
class Note:
    """Something seen that did not become a label; `suspect` where a jump to another branch would explain it."""

    text: str
    suspect: bool = False
    hides: bool = False  # events may lie there that were not told from each other
    jump: float | None = None  # arclength at which unstable values change for want of smoothness: no riddle


def isolate(stretch: Stretch, a: Sample, b: Sample, depth: int = 0) -> Iterator[Found | Note]:
    """All events between a and b, in order."""
    types = stretch.problem.explain(a, b)
    if types == () or any(unresolved(stretch.problem, row.eigenvalues[None]).any() for row in (a, b)):
        return
    width = stretch.distance(a, b)
    if types is not None and len(types) == 1 and width > COINCIDENT:
        low, high, verified = _locate(stretch, types[0], a, b)
        if isinstance(verified, Found):
            companions = list(_with_companions(stretch, a, b, verified))
            if len(companions) == 1 and _is_plain(stretch, companions[0], types[0]):
                yield from _with_rest(stretch, a, b, companions[0], depth)
            else:
                yield from companions
        elif isinstance(verified, Nothing):  # a change that is no event, such as a neutral saddle
            yield from _around(stretch, (a, low, high, b), depth)
        elif depth < DEPTH:
            yield from isolate(stretch, a, low, DEPTH)
            together = list(_compound(stretch, low, high, verified.reason))
            only = together[0] if len(together) == 1 else None
            if isinstance(only, Found) and (stretch.problem.adaptive or _is_plain(stretch, only, types[0])):
                yield from _with_rest(stretch, a, b, only, depth if stretch.problem.adaptive else DEPTH)
            else:
                yield from together
            yield from isolate(stretch, high, b, DEPTH)
        else:
            yield Note(_where(stretch, low, verified.reason))
        return
    if width <= COINCIDENT or depth >= DEPTH:
        yield from _compound(stretch, a, b, "changes that could not be told apart")
        return
    middle: Sample | None = None
    for fraction in (0.5, 0.382, 0.618, 0.25, 0.75):
        middle = stretch.between(a, b, fraction) or middle
        if middle is not None and not np.any((middle.tests == 0.0) & (a.tests != 0.0)):  # on an event signs say nothing
            break
    if middle is None:
        yield from _compound(stretch, a, b, "the curve could not be followed between two accepted points")
        return
    yield from isolate(stretch, a, middle, depth + 1)
    yield from isolate(stretch, middle, b, depth + 1)


def _is_plain(stretch: Stretch, found: Found, type_: str) -> bool:
    """True for a point beside which the curve goes on; one of another type than was looked for may end it, as DP.

    Not so where several eigenvalues vanish: tests do not vanish with the distance there, and some only jump.
    """
    several = int(found.point.vectors.get("kernel", 1)) != 1
    return not (several or found.point.touches) and (found.point.type == type_ or not is_planar(stretch.problem))


def _around(stretch: Stretch, samples: tuple[Sample, Sample, Sample, Sample], depth: int) -> Iterator[Found]:
    """Events on both sides of a change of one test that is none, from a, low, high, b: it lies between low and high."""
    a, low, high, b = samples
    crossing = a.tests * b.tests < 0.0
    at = [stretch.length_of(low), stretch.length_of(high)]
    centre = 0.5 * (at[0] + at[1])
    if np.count_nonzero(crossing) == 1 and at[0] != at[1]:  # where the test vanishes, to second order in the bracket
        before, after = float(low.tests[crossing][0]), float(high.tests[crossing][0])
        if before * after < 0.0:
            centre = at[0] + (at[1] - at[0]) * before / (before - after)
    for near, far in ((low, a), (high, b)):
        if near is far:
            continue
        if abs(stretch.length_of(near) - centre) < 0.1 * NARROW * stretch.distance(near, far):  # there it is rounding
            near = stretch.between(near, far, NARROW) or near
        rest = _rest(stretch, near, far, centre, crossing, depth)
        yield from (item for item in rest if isinstance(item, Found))


def _with_rest(stretch: Stretch, a: Sample, b: Sample, found: Found, depth: int) -> Iterator[Found | Note]:
    """A located point and the rest of the step on both sides of it: what it hid, or a note where it is no simple zero.

    The point knows how far from it (along the curve) its zero may be: zeros in between are itself.
    """
    point = replace(found.sample, z=found.point.z)
    crossing = a.tests * b.tests < 0.0
    sides = _sides(stretch, point, (a, b), crossing)
    reach = max((look.distance for look in sides if look.lost), default=0.0)
    if reach > 0.0:
        found = replace(found, point=replace(found.point, vectors={**found.point.vectors, "reach": reach}))
    yield found
    simple, together = True, []
    for look in sides:
        if look.nearer is not None and not is_linear(stretch, point, look.near, look.nearer, crossing):
            simple = False
            together.append(crossings_together(point, look.near, look.nearer, crossing))
        yield from _rest(stretch, look.near, look.far, stretch.length_of(point), crossing, depth)
    if not simple:
        close = max(look.distance for look in sides)
        text = f"{found.point.type} is degenerate, or others lie closer than {close:g} to it{_seen(together)}"
        yield Note(_where(stretch, point, text), hides=stretch.problem.adaptive)


@dataclass(frozen=True, eq=False)
class _Side:
    """One side of a located point: where its tests are told from zero first, and the end of the step."""

    near: Sample  # at `distance` from the point
    nearer: Sample | None  # at a quarter of it
    far: Sample
    width: float  # from the point to `far`
    distance: float
    lost: bool  # nearer to the point, signs of the tests that vanish there are not those of a zero


def _sides(stretch: Stretch, point: Sample, ends: tuple[Sample, Sample], crossing: NDArray[np.bool_]) -> list[_Side]:
    """Both sides of a located point, or one where the step ends next to it.

    Where several zeros are one to rounding, Newton's method stops beside them, and tests may be rounding too: the first
    distance is taken at which they are larger than that, and have opposite signs on the two sides.
    """
    distance, lost = CLOSE_ADAPTIVE if stretch.problem.adaptive else CLOSE, False
    wide = [(far, width) for far in ends if (width := stretch.distance(point, far)) >= 4.0 * distance]
    solved_ends = [(solved(stretch, far, point), width) for far, width in wide]
    while True:
        sides = []
        for far, width in solved_ends:
            near, nearer = stretch.several(point, far, (distance / width, 0.25 * distance / width))
            if near is not None:
                sides.append(_Side(near, nearer, far, width, distance, lost))
        farthest = FARTHER * FARTHER * distance >= min((side.width for side in sides), default=0.0)
        if stretch.problem.adaptive or farthest or _are_told(stretch, sides, crossing):
            return sides
        distance, lost = FARTHER * distance, True


def _are_told(stretch: Stretch, sides: list[_Side], crossing: NDArray[np.bool_]) -> bool:
    """True where the tests of points beside a zero are larger than rounding and have its signs.

    Small values are larger than rounding where they change steadily up to twice the distance.
    """
    if len(sides) == 2 and np.any((sides[0].near.tests * sides[1].near.tests)[crossing] >= 0.0):
        return False
    for side in sides:
        if not np.any(np.abs(side.near.tests[crossing]) < SLIGHT):
            continue
        half = 0.5 * side.distance / (side.width - side.distance)
        middle, beyond = stretch.several(side.near, side.far, (half, 2.0 * half))
        if middle is None or beyond is None:
            return False
        first, second = ((y.tests - x.tests)[crossing] for x, y in ((side.near, middle), (middle, beyond)))
        steady = np.abs(second - first) <= 0.6 * np.maximum(np.abs(first), np.abs(second))
        if not np.all(steady & (first * second > 0.0)):
            return False
    return True


def _seen(together: list[int | None]) -> str:
    """How many crossings were seen at one place, as far as rounding lets them be."""
    most = max((count for count in together if count is not None), default=0)
    return f" (its test vanishes as at {most} crossings together)" if most > 1 else ""


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
    test = problem.watch(event.type)
    if test is None and is_planar(problem):
        return
    crossing = np.arange(len(near.tests)) == (-1 if test is None else test)
    yield from _rest(stretch, near, far, centre, crossing, 0)


def _rest(
    stretch: Stretch, near: Sample, far: Sample, centre: float, crossing: NDArray[np.bool_], depth: int
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
            yield from isolate(stretch, first, second, depth + 1)
        else:
            unclear = a
    if unclear is not None:
        yield Note(_where(stretch, unclear, LOST_IN_ROUNDING), hides=True)


def _verified(stretch: Stretch, type_: str, near: Sample) -> Outcome:
    """The problem's verification; one that fails with an error loses the label, not the branch."""
    errors: list[str] = []
    outcome: Outcome = NOTHING
    with contained(errors.append):
        outcome = stretch.problem.verify(type_, near, stretch.frame)
    if isinstance(outcome, Verified) and not outcome.error < UNPLACED * float(stretch.frame.scale[-1]):
        return unverified(type_, f"its place is known to {outcome.error:.1e} only, in a range of this width")
    return unverified(type_, errors[0]) if errors else outcome


def _together(stretch: Stretch, a: Sample, b: Sample) -> list[Outcome]:
    """Events that coincide between a and b; one that fails with an error loses the labels, not the branch."""
    errors: list[str] = []
    items: list[Outcome] = []
    with contained(errors.append):
        items = list(stretch.problem.verify_compound(a, b, stretch.frame))
    return [Rejected(f"not verified: {errors[0]}", suspect=True)] if errors else items


def _where(stretch: Stretch, a: Sample, text: str) -> str:
    return f"{text} near {stretch.problem.parameters[0]} = {a.z[-1]:.10g}"


def _locate(stretch: Stretch, type_: str, a: Sample, b: Sample) -> tuple[Sample, Sample, Found | Rejected | Nothing]:
    """One simple event: bracket its test, then verify. Returns the bracket and the point, or why it is none."""
    problem = stretch.problem
    index = problem.watch(type_)

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
                return low, high, Found(length, _anchored(verified, a), _at_point(stretch, near, verified))
            outcome = unverified(type_, "Newton on its defining system left the neighbourhood")
        else:
            outcome = verified
            if isinstance(verified, Nothing):
                break
    return low, high, outcome


def _anchored(point: Verified, beside: Sample) -> Verified:
    """The point with a place on its own branch, which tells that from others with the same tangent."""
    return anchored(point, beside.z) if point.type == "BP" else point


def anchored(point: Verified, place: Array) -> Verified:
    """The point with this place on its own branch."""
    return replace(point, vectors={**point.vectors, "beside": place})


def _with_companions(stretch: Stretch, a: Sample, b: Sample, found: Found) -> Iterator[Found]:
    """`found`, or all that coincides with it: crossings in opposite senses leave signs and counts as they were."""
    if found.point.crowded:
        z = found.point.z
        items = _together(stretch, replace(a, z=z), replace(b, z=z))
        together = [item for item in items if isinstance(item, Verified)]
        if any(item.type == found.point.type for item in together):
            for item in together:
                yield Found(found.length, _anchored(item, stretch.base), found.sample)
            return
    yield found


def _at_point(stretch: Stretch, near: Sample, point: Verified) -> Sample:
    """`near` with the tangent at the point: of the branches through it, the one that the stretch follows.

    Close to a branch point the Jacobian is too small to give a direction, so the tangents of samples next to it are
    useless; the stretch's base and the chord from there to the point (a circle through both) tell which branch it is.
    """
    base, scale = stretch.base, stretch.frame.scale
    chord = (point.z - base.z) / scale
    length = float(base.tangent @ chord)
    expected = base.tangent if abs(length) < CHORD else 2.0 * chord / length - base.tangent
    expected = expected / np.linalg.norm(expected)
    if point.type != "BP" and not point.touches and not stretch.problem.adaptive:  # one branch, and a regular point
        sample = stretch.problem.probe(base, length, point.z.copy(), stretch.frame, stretch.settings)
        if sample is not None and dot(sample.tangent, expected) > ALIGNED:
            return replace(near, tangent=sample.tangent)
    try:
        tangents = stretch.problem.tangents(point.z, scale)
    except (InputError, NotFiniteError):  # the equations are singular at the point itself, where curves meet
        return replace(near, tangent=expected)
    best = max(tangents, key=lambda t: abs(float(t @ expected)))
    alignment = float(best @ expected)
    return replace(near, tangent=best * np.sign(alignment) if abs(alignment) > 0.9 else expected)


def _compound(stretch: Stretch, a: Sample, b: Sample, why: str) -> Iterator[Found | Note]:
    """What coincides at one place: a corner of a piecewise equation, or several smooth events."""
    corner = stretch.problem.verify_corner(a, b, stretch.frame)
    items = [corner] if corner is not None else _together(stretch, a, b)
    if not items:
        yield Note(_where(stretch, a, why), True)
    for item in items:
        if isinstance(item, Verified):
            length = float(stretch.base.tangent @ ((item.z - stretch.base.z) / stretch.frame.scale))
            yield Found(length, _anchored(item, stretch.base), _at_point(stretch, a, item))
        elif isinstance(item, Jump):
            yield Note(_where(stretch, a, item.text), jump=stretch.length_of(b))
        elif isinstance(item, Rejected):
            yield Note(_where(stretch, a, item.reason), item.suspect)


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
    if items or stretch.problem.adaptive or is_planar(stretch.problem) or test != stretch.problem.watch("BP"):
        return
    low, high = sorted((stretch.length_of(a), stretch.length_of(b)))
    for item in _together(stretch, a, b):
        if isinstance(item, Verified) and item.touches:
            length = dot(stretch.base.tangent, (item.z - stretch.base.z) / stretch.frame.scale)
            if low - ALIKE <= length <= high + ALIKE:
                yield Found(length, _anchored(item, a), _at_point(stretch, a, item))


def _minimum(stretch: Stretch, a: Sample, here: Sample, b: Sample, test: int) -> Iterator[Found | Note]:
    """A test function came close to zero at `here` without changing sign: find its minimum; two zeros hide where it
    crosses.

    Golden-section search with a parabola's step where that helps; ends when the sign changes or the minimum is
    resolved.
    """

    def size(sample: Sample) -> float:
        return float(sample.tests[test] * np.sign(here.tests[test]))

    low, middle, high = a, here, b
    for _ in range(DIP_BUDGET):
        s = [stretch.length_of(x) for x in (low, middle, high)]
        f = [size(x) for x in (low, middle, high)]
        if s[2] - s[0] <= 1e-9:
            if f[1] <= 1e-6 * size(here):
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
                yield Note(_where(stretch, middle, TOUCHES))
            return
        f_trial = size(trial)
        if f_trial < 0.0 or trial.unstable != here.unstable:
            hidden = [*isolate(stretch, pair[0], trial), *isolate(stretch, trial, pair[1])]
            items = list(_pair(stretch, low, high, a, hidden))
            if not items and is_planar(stretch.problem) and trial.tests[test] == 0.0:  # signs say nothing there
                items = [Note(_where(stretch, trial, TOUCHES))]
            yield from items
            return
        if f_trial <= TOUCH * size(here) and min(f[0], f[2]) <= 1e-6 * size(here):
            yield from _touching(stretch, low, high, test, a)
            return
        if abs(f_trial - f[1]) <= 1e-3 * f[1] and f[1] > 1e-2 * min(f[0], f[2]):
            if f[1] <= 1e-6 * size(here):  # all that is left is rounding
                yield from _touching(stretch, low, high, test, a)
            return  # an ordinary minimum, resolved
        if target < s[1]:
            low, middle, high = (low, trial, middle) if f_trial < f[1] else (trial, middle, high)
        else:
            low, middle, high = (middle, trial, high) if f_trial < f[1] else (low, middle, trial)
    if size(middle) <= 1e-5 * size(here):
        yield from _touching(stretch, low, high, test, a)


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
        if one and is_planar(stretch.problem):  # one of another type is passed on both sides, as a DP by a test of CP
            alike |= any(_is_seen_by(stretch, points[0].type, test) for test in range(len(stretch.base.tests)))
    elif len(points) == 1 and not points[0].touches:  # the second zero was not told from the first
        alike = len(items) > 1
    if not alike:
        yield from items
        return
    together: list[Outcome] = []
    if not stretch.problem.adaptive and not is_planar(stretch.problem):
        together = _together(stretch, replace(low, z=points[0].z), replace(high, z=points[-1].z))
    touching = [item for item in together if isinstance(item, Verified) and item.touches]
    if touching:
        yield from (_found(stretch, low, point, anchor) for point in touching)
        return
    yield Note(f"{TOUCHES} near {stretch.problem.parameters[0]} = {points[0].z[-1]:.3g}")
    if len(points) == 2:
        yield from (item for item in items if isinstance(item, Note))


def _found(stretch: Stretch, near: Sample, point: Verified, anchor: Sample) -> Found:
    """A point where a test touches zero."""
    length = float(stretch.base.tangent @ ((point.z - stretch.base.z) / stretch.frame.scale))
    return Found(length, _anchored(point, anchor), _at_point(stretch, near, point))


def _touching(stretch: Stretch, low: Sample, high: Sample, test: int, anchor: Sample) -> Iterator[Found | Note]:
    """A test touches zero between two samples: two eigenvalues that cross in opposite senses, or a degenerate point."""
    if is_planar(stretch.problem):
        turned = high.tests.copy()
        turned[test] = -np.copysign(1.0, low.tests[test])
        low = replace(low, tests=np.where(np.arange(len(turned)) == test, -turned, low.tests))
        items = [i for i in _together(stretch, low, replace(high, tests=turned)) if not isinstance(i, Nothing)]
        if any(isinstance(item, Rejected) or _is_seen_by(stretch, item.type, test) for item in items):
            yield Note(_where(stretch, low, TOUCHES))
        else:  # it is part of a point of another type
            for item in items:
                assert isinstance(item, Verified)
                yield _found(stretch, low, item, anchor)
        return
    together = _together(stretch, low, high)
    scale = stretch.frame.scale[-1]
    points = [
        item for item in together if isinstance(item, Verified) and (item.touches or item.error < ACCURATE * scale)
    ]
    yield from (_found(stretch, low, point, anchor) for point in points)
    if not points and (together or test == 0):
        yield Note(_where(stretch, low, TOUCHES))


def _is_seen_by(stretch: Stretch, type_: str, test: int) -> bool:
    """True where points of this type are zeros of this test."""
    try:
        return stretch.problem.watch(type_) == test
    except (KeyError, ValueError):  # no point of a curve like this one
        return False


def _parabola_minimum(s: list[float], f: list[float]) -> float | None:
    left = (f[1] - f[0]) / (s[1] - s[0])
    right = (f[2] - f[1]) / (s[2] - s[1])
    second = (right - left) / (s[2] - s[0])
    if second <= 0.0:
        return None
    return 0.5 * (s[0] + s[1]) - 0.5 * left / second
