"""Where a smooth curve goes on from two of its points and their tangents: the cubic through them (Hermite).

Its parameter is the length s along the last tangent, in which all tangents are slopes dy/ds, whatever their lengths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from contin.abi import Array
from contin.linalg.vectors import dot, norm

REACH: Final = 3.0  # of the way back: farther ahead the cubic is guessing
BENT: Final = 0.1  # of the way back: points and tangents that differ by more from a parabola's are no smooth curve's
STEEP: Final = 0.5  # cosine of two tangents that are not those of neighbours


@dataclass(frozen=True, eq=False)
class Cubic:
    """y(0) = 0 with slope `tangent` (of length 1), and what the point at s = `back` < 0 or > 0 and its slope add."""

    tangent: Array
    back: float
    offset: Array  # of the point at `back`, from the tangent there
    turn: Array  # of the slope at `back`, from the tangent

    def at(self, s: float) -> Array:
        """y(s)"""
        q = s / self.back
        return s * self.tangent + (q * q * (3.0 - 2.0 * q)) * self.offset + (self.back * q * q * (q - 1.0)) * self.turn

    def slope(self, s: float) -> Array:
        """dy/ds"""
        q = s / self.back
        return self.tangent + (6.0 * q * (1.0 - q) / self.back) * self.offset + (q * (3.0 * q - 2.0)) * self.turn

    def slope_at(self, y: Array) -> Array | None:
        """dy/ds at a further point y of the curve: of the polynomial of fourth degree; None where that says nothing."""
        s = dot(self.tangent, y)
        if not 0.0 < abs(s) < REACH * abs(self.back) or s == self.back:
            return None
        return self.slope(s) + (2.0 / s + 2.0 / (s - self.back)) * (y - self.at(s))


def cubic(tangent: Array, point: Array, slope: Array) -> Cubic | None:
    """From a unit tangent at the origin, another point, and its slope; None where they are not one smooth curve's."""
    back, along = dot(tangent, point), dot(tangent, slope)
    if not abs(along) > STEEP * norm(slope) or not abs(back) > STEEP * norm(point):
        return None
    offset, turn = point - back * tangent, slope / along - tangent
    if not norm(offset - 0.5 * back * turn) <= BENT * abs(back):
        return None
    return Cubic(tangent, back, offset, turn)
