"""Where a curve in two parameters turns off beside another one that a step has landed on.

The determinant of [F_z; tangent] has one sign along a curve, and changes it where another curve crosses: or on the way
to another one, past which this one turns. The step is bisected: where its two ends, on either side of the determinant,
come to one point, curves cross; else this one turns off, and is followed in shorter steps.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.kernels.steering import BEFORE, BISECTED, ONE_POINT
from contin.linalg.vectors import norm

CROSSED: Final = "another curve crosses this one, or passes it at less than 1e-7 of the range"
SHIFT, LEAST = 0.7, 0.1  # parts of what is left at which it is cut, where half of it has no solution


def length_before(
    at: Callable[[float], tuple[Array, float] | None], origin: Array, end: Array, side: float, h: float, shortest: float
) -> tuple[float | None, float]:
    """(length, distance): of the step that ends before the curve turns off, None where another one crosses it.

    at : the point (scaled) and the determinant some length from the origin, None where there is none.  end : the
    point at length h, whose determinant has not the sign `side`.  distance : of the two curves.
    """
    low, high, below, above, fraction = 0.0, h, origin, end, 0.5
    while high - low > BISECTED * h and fraction > LEAST:
        length = low + fraction * (high - low)
        found = at(length)
        if found is None:
            fraction *= SHIFT
            continue
        fraction = 0.5
        if found[1] * side > 0.0:
            low, below = length, found[0]
        else:
            high, above = length, found[0]
    apart = norm(np.asarray(above - below))
    if apart <= ONE_POINT or low <= shortest:
        return None, apart
    return max(low - BEFORE * apart, 0.5 * low, shortest), apart
