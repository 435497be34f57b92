"""Both sides of a located event: how near to it its test functions can be told from zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.rest_of_step import is_linear, rounding, solved
from contin.continuation.sample import Sample
from contin.machine.elementary import log

CLOSE = 1e-6  # arclength: how near to a located event the step is looked at again
CLOSE_ADAPTIVE = 1e-4  # ... of discretised problems, whose test functions are less exact
SLIGHT = 1e-9  # a test this small so near to its zero may be rounding
STEPS = 8  # in which a test grows that is no rounding: by chance once in 40,000 times
FARTHER = 4.0  # ... and the ratio of distances at which it is looked for where it is not
DOUBLE = np.float64(2.0)  # ratio of distances between which the power of a test is taken
WHOLE, SPREAD = 0.15, 1.5  # how far from a whole number a power may be, a side; and how far from each other two may be


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a located point: where its tests are told from zero first, and the end of the step."""

    near: Sample  # at `distance` from the point
    nearer: Sample | None  # at a quarter of it
    far: Sample
    width: float  # from the point to `far`
    distance: float
    lost: bool  # nearer to the point, signs of the tests that vanish there are not those of a zero
    rounding: bool = False  # no test is more than that in all of the step that can be told


def sides_of(stretch: Stretch, point: Sample, ends: tuple[Sample, Sample], crossing: NDArray[np.bool_]) -> list[Side]:
    """Both sides of a located point, or one where the step ends next to it.

    Where several zeros are one to rounding, Newton's method stops beside them, and tests may be rounding too: the first
    distance is taken at which they are larger than that, and have opposite signs on the two sides.
    """
    distance, lost = CLOSE_ADAPTIVE if stretch.problem.adaptive else CLOSE, False
    wide = [(far, width) for far in ends if (width := stretch.distance(point, far)) >= 4.0 * distance]
    solved_ends = [(solved(stretch, far, point), width) for far, width in wide]
    if stretch.problem.adaptive:
        found = [_nearest_found(stretch, point, far, width, distance) for far, width in solved_ends]
        return [side for side in found if side is not None]
    while True:
        sides = []
        for far, width in solved_ends:
            near, nearer = stretch.several(point, far, (distance / width, 0.25 * distance / width))
            if near is not None:
                sides.append(Side(near, nearer, far, width, distance, lost))
        farthest = FARTHER * FARTHER * distance >= min((side.width for side in sides), default=0.0)
        if _are_told(stretch, sides, crossing):
            return sides
        if farthest:
            nothing = all(_is_rounding(stretch, sides, test) for test in np.flatnonzero(crossing))
            return [replace(side, rounding=nothing) for side in sides]
        distance, lost = FARTHER * distance, True


def _nearest_found(stretch: Stretch, point: Sample, far: Sample, width: float, distance: float) -> Side | None:
    """One side of a located point of a discretised problem, from the first distance at which the branch is found.

    Next to a branch point the corrector may fail, the sooner the smaller the angle between the branches.
    """
    lost = False
    while 4.0 * distance <= width:
        near, nearer = stretch.several(point, far, (distance / width, 0.25 * distance / width))
        if near is not None:
            return Side(near, nearer, far, width, distance, lost)
        distance, lost = FARTHER * distance, True
    return None


def untold(stretch: Stretch, point: Sample, ends: tuple[Sample, Sample], sides: Sequence[Side]) -> float:
    """How near to a located point of a discretised problem a step is not looked at, as its branch is not found there.

    0 where both sides are looked at, and where they are too short for it.
    """
    if not stretch.problem.adaptive:
        return 0.0
    widths = [(end, stretch.distance(point, end)) for end in ends]
    seen = [side.far for side in sides]  # solved further than the ends are: not at them to the last digit
    missing = [width for end, width in widths if not any(stretch.distance(end, far) <= 0.5 * width for far in seen)]
    return max((width for width in missing if width >= 4.0 * CLOSE_ADAPTIVE), default=0.0)


def sides_beyond(stretch: Stretch, point: Sample, ends: tuple[Sample, Sample]) -> list[Side]:
    """Both sides of a point in a step too short for `sides_of`, with points of the curve beyond its ends."""
    distance, base = CLOSE_ADAPTIVE if stretch.problem.adaptive else CLOSE, stretch.base
    centre, sides = stretch.length_of(point), []
    for end in ends:
        sense = 1.0 if stretch.length_of(end) > centre else -1.0
        samples = [
            stretch.problem.probe(
                base, centre + s, point.z + s * stretch.frame.scale * point.tangent, stretch.frame, stretch.settings
            )
            for s in sense * distance * np.array([1.0, 0.25, FARTHER])
        ]
        near, nearer, far = samples
        if near is not None and far is not None:
            sides.append(Side(near, nearer, far, stretch.distance(point, far), distance, lost=False))
    return sides


def _are_told(stretch: Stretch, sides: list[Side], crossing: NDArray[np.bool_]) -> bool:
    """True where the tests of points beside a zero are larger than rounding and have its signs.

    Small values are larger than rounding where they grow steadily up to twice the distance.
    """
    if len(sides) == 2 and np.any((sides[0].near.tests * sides[1].near.tests)[crossing] >= 0.0):
        return False
    slight = (side for side in sides if np.any(np.abs(side.near.tests[crossing]) < SLIGHT))
    return all(_grows(stretch, side, crossing) for side in slight)


def _is_rounding(stretch: Stretch, sides: list[Side], test: np.intp) -> bool:
    """True where a test is small and does not grow away from its zero as zeros do."""
    alone = np.arange(len(sides[0].near.tests)) == test if sides else np.zeros(0, bool)
    slight = any(abs(float(side.near.tests[test])) < SLIGHT for side in sides)
    return slight and not _are_told(stretch, sides, alone)


def _grows(stretch: Stretch, side: Side, crossing: NDArray[np.bool_]) -> bool:
    """True where the tests grow steadily from a side's near point to twice its distance, which rounding errors do not.

    These may be whole multiples of a smallest one, or the same in neighbouring points.
    """
    whole = side.distance / (side.width - side.distance)
    samples = stretch.several(side.near, side.far, [whole * part / STEPS for part in range(1, STEPS + 1)])
    known = [sample.tests[crossing] for sample in samples if sample is not None]
    if len(known) < STEPS:
        return False
    tests = np.array([side.near.tests[crossing], *known])
    if not np.all(np.diff(tests * np.sign(tests[-1]), axis=0) > 0.0):
        return False
    first, second = tests[STEPS // 2] - tests[0], tests[-1] - tests[STEPS // 2]
    return bool(np.all(np.abs(second - first) <= 0.6 * np.maximum(np.abs(first), np.abs(second))))


def vanishes_linearly(stretch: Stretch, point: Sample, side: Side, crossing: NDArray[np.bool_]) -> bool:
    """True where the tests on this side vanish as at a simple zero alone, from where they are told from rounding.

    Of a test that is a sign alone, as that of a sparse determinant, nothing can be said of the kind, and nothing is.
    """
    if np.all(np.abs(side.near.tests[crossing]) == 1.0) and np.all(np.abs(side.far.tests[crossing]) == 1.0):
        return True
    if not side.lost:
        if side.nearer is None or is_linear(stretch, point, side.near, side.nearer, crossing):
            return True
        noise = rounding(stretch, side.nearer, side.near)[crossing]
        if not np.any(np.abs(side.nearer.tests[crossing]) <= noise):  # what is no rounding error vanishes otherwise
            return False
    farther = (FARTHER - 1.0) * side.distance / (side.width - side.distance)
    beyond = stretch.between(side.near, side.far, farther) if farther < 1.0 else None
    return beyond is not None and is_linear(stretch, point, beyond, side.near, crossing)


@dataclass(frozen=True)
class Cluster:
    """How many crossings a test vanishes like, seen from a distance (arclength) at which they look like one."""

    count: int
    distance: float

    @property
    def words(self) -> str:
        return f" (its test vanishes as at {self.count} crossings together)" if self.count > 1 else ""


def cluster_at(stretch: Stretch, point: Sample, sides: Sequence[Side], crossing: NDArray[np.bool_]) -> Cluster | None:
    """The first distance from which a crossing test is a whole power of it; None where there is none in the step.

    Beside k zeros that spread over r the power at distance d is k (1 +- r/d) on the two sides: their mean is k to first
    order. An odd power changes the test's sign, an even one does not. Where the step ends next to the point there is
    one side, which must be twice as near to a whole number: twice its power at a distance less that at
    half of it, in which r/d is not.
    """
    if not sides or len({side.distance for side in sides}) > 1:
        return None
    distance, narrow = sides[0].distance, min(side.width for side in sides)
    nearer: Array | None = None
    while DOUBLE * distance < narrow:
        pairs = [stretch.several(point, s.far, (distance / s.width, DOUBLE * distance / s.width)) for s in sides]
        tests = [sample.tests[crossing] for pair in pairs for sample in pair if sample is not None]
        if len(tests) < 2 * len(sides):
            return None
        with np.errstate(divide="ignore", invalid="ignore"):  # of a zero between the two the logarithm is NaN
            powers = np.array([log(tests[k + 1] / tests[k]) for k in range(0, len(tests), 2)]) / log(DOUBLE)
        powers = np.where(np.isfinite(powers), powers, np.nan)
        mean = powers.mean(axis=0)
        if len(sides) == 1 and nearer is not None:
            mean = 2.0 * mean - nearer
        nearer = powers.mean(axis=0)
        counts = np.round(mean)
        whole = (np.abs(mean - counts) < WHOLE * len(sides)) & (counts > 0.0) & (np.ptp(powers, axis=0) < SPREAD)
        if len(sides) == 2:
            whole &= (counts % 2.0 == 1.0) == (np.sign(tests[0]) != np.sign(tests[2]))
        if whole.any():
            return Cluster(int(counts[whole].max()), distance)
        distance *= DOUBLE
    return None


def are_all(stretch: Stretch, sides: Sequence[Side], crossing: NDArray[np.bool_], lengths: Sequence[float]) -> bool:
    """True where the tests vanish near the point as zeros at these lengths along the stretch make them vanish.

    To the power of the distance of 1/2, as a simple zero is told from others.
    """
    zeros = np.array(lengths)
    for side in sides:
        if side.nearer is None:
            continue
        near, nearer = (np.abs(stretch.length_of(sample) - zeros) for sample in (side.near, side.nearer))
        with np.errstate(divide="ignore", invalid="ignore"):
            expected = float(np.sum(log(near / nearer)))
            off = np.abs(log(np.abs(side.near.tests / side.nearer.tests)[crossing]) - expected)
        if not np.all(off < 0.5 * float(log(np.float64(FARTHER)))):  # of NaN, too
            return False
    return True
