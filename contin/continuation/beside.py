"""Both sides of a located event: how near to it its test functions can be told from zero."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.continuation.curve import Stretch
from contin.continuation.looking_again import solved
from contin.continuation.problem import Sample

CLOSE = 1e-6  # arclength: how near to a located event the step is looked at again
CLOSE_ADAPTIVE = 1e-4  # ... of discretised problems, whose test functions are less exact
SLIGHT = 1e-9  # a test this small so near to its zero may be rounding
FARTHER = 4.0  # ... and the ratio of distances at which it is looked for where it is not


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a located point: where its tests are told from zero first, and the end of the step."""

    near: Sample  # at `distance` from the point
    nearer: Sample | None  # at a quarter of it
    far: Sample
    width: float  # from the point to `far`
    distance: float
    lost: bool  # nearer to the point, signs of the tests that vanish there are not those of a zero


def sides_of(stretch: Stretch, point: Sample, ends: tuple[Sample, Sample], crossing: NDArray[np.bool_]) -> list[Side]:
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
                sides.append(Side(near, nearer, far, width, distance, lost))
        farthest = FARTHER * FARTHER * distance >= min((side.width for side in sides), default=0.0)
        if stretch.problem.adaptive or farthest or _are_told(stretch, sides, crossing):
            return sides
        distance, lost = FARTHER * distance, True


def _are_told(stretch: Stretch, sides: list[Side], crossing: NDArray[np.bool_]) -> bool:
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


def seen(together: list[int | None]) -> str:
    """How many crossings were seen at one place, as far as rounding lets them be."""
    most = max((count for count in together if count is not None), default=0)
    return f" (its test vanishes as at {most} crossings together)" if most > 1 else ""
