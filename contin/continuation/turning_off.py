"""Where a curve in two parameters turns off beside another one that a step has landed on.

The determinant of [F_z; tangent] has one sign along a curve, and changes it where another curve crosses: or on the way
to another one, past which this one turns. The step is bisected: where its two ends, on either side of the determinant,
come to one point, curves cross if it is smaller there (equations with borders have poles, too, where it changes its
sign through infinity); else this one turns off, and is followed in shorter steps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.kernels.steering import BEFORE, BISECTED, LEAST, ONE_POINT, SHIFT
from contin.linalg.vectors import norm

CROSSED: Final = "another curve crosses this one, or passes it too closely to be told from it"
SHORT: Final = 1e-5  # scaled: in no longer step smooth curves turn by ...
TURNED: Final = 1e-2  # ... this angle, where the curvature before and after ...
STRAIGHT: Final = 1e-2  # ... is this part of what that makes, or less


def turned_at_once(tangents: Array, lengths: Array) -> list[int]:
    """Rows to which a curve has come by a turn, in a step so short that it is on to another curve, or all but that.

    tangents (rows, size) : unit ones.  lengths (rows,) : of the step to each row.
    """
    apart = np.diff(tangents, axis=0)
    angles, steps = np.sqrt(np.einsum("ij,ij->i", apart, apart)), lengths[1:]
    if len(angles) < 3 or not np.all(steps > 0.0):
        return []
    rates = angles / steps
    beside = np.maximum(rates[:-2], rates[2:])
    sharp = (angles[1:-1] > TURNED) & (steps[1:-1] < SHORT) & (beside < STRAIGHT * rates[1:-1])
    return [int(row) + 2 for row in np.flatnonzero(sharp)]


@dataclass(frozen=True, eq=False)
class Solved:
    """A point at some length: scaled way from the origin, sign of the determinant, logarithm of its modulus."""

    y: Array
    sign: float
    log: float


@dataclass(frozen=True, eq=False)
class Verdict:
    """length : of the step that ends before the curve turns off, None where it does not.  most : of the next one.

    crossed : whether another curve crosses this one.
    """

    length: float | None
    most: float = np.inf
    crossed: bool = False

    def tells(self, apart: float) -> bool:
        """Whether another curve crosses, or passes no farther away than `apart`."""
        return self.crossed or self.most <= apart


def verdict_on(
    at: Callable[[float], Solved | None], origin: Solved, end: Solved, h: float, shortest: float
) -> Verdict:
    """What the determinant's change of sign between the origin and the end of a step of length h means.

    at : the point some length from the origin, None where there is none.
    """
    low, high, below, above, fraction = 0.0, h, origin, end, 0.5
    while high - low > BISECTED * h and fraction > LEAST:
        length = low + fraction * (high - low)
        found = at(length)
        if found is None:
            fraction *= SHIFT
            continue
        fraction = 0.5
        if found.sign * origin.sign > 0.0:
            low, below = length, found
        else:
            high, above = length, found
    apart = norm(np.asarray(above.y - below.y))
    near, far = max(below.log, above.log), max(origin.log, end.log)
    grows = near > far and below.log >= origin.log and above.log >= end.log
    if apart <= ONE_POINT or low <= shortest or grows:  # to a pole, also where no correction comes near it
        return Verdict(None, crossed=near < far)
    return Verdict(max(low - BEFORE * apart, 0.5 * low, shortest), apart)
