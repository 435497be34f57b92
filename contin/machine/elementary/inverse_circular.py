"""atan, atan2, asin, acos: atan(y/x) = atan(c) + atan((y - c x)/(x + c y)), c the nearest multiple of 1/32.

The last argument is at most 1/64 and is computed as a pair, where c x and c y are exact in two parts. asin and acos
are atan2 of x and the square root of 1 - x^2 as a pair.
"""

from __future__ import annotations

import math

from contin.machine.elementary.constants import ATAN_TABLE, HALF_PI_HIGH, HALF_PI_LOW, PI_HIGH, PI_LOW
from contin.machine.elementary.double_double import add, divide, fast_two_sum, split, square, square_root, two_sum
from contin.machine.elementary.exponential import SHIFT, SHIFT_BITS
from contin.machine.elementary.language import Pair, bits, copysign, fabs, quotient, rare

INFINITY, NAN = math.inf, math.nan
TINY = 7.450580596923828e-09  # 2^-27
FAR = 1.152921504606847e18  # 2^60


def atan_ratio(yh: float, yl: float, xh: float, xl: float) -> Pair:
    """atan(y/x) as a pair, for pairs 0 <= y <= x."""
    return atan_near(yh / xh, yh, yl, xh, xl)


def atan_near(ratio: float, yh: float, yl: float, xh: float, xl: float) -> Pair:
    """The same where y/x is about `ratio`."""
    shifted = ratio * 32.0 + SHIFT
    c = (shifted - SHIFT) * 0.03125
    j = 2 * (bits(shifted) - SHIFT_BITS)
    xa, xb = split(xh)
    ya, yb = split(yh)
    nh, nl = two_sum(yh, -(c * xa))
    nh, nl = two_sum(nh, nl + (yl - c * xb - c * xl))
    dh, dl = fast_two_sum(xh, c * ya)
    dh, dl = fast_two_sum(dh, dl + (xl + c * yb + c * yl))
    th, tl = divide(nh, nl, dh, dl)
    z = th * th
    p = th * z * (-1 / 3 + z * (1 / 5 + z * (-1 / 7 + z * (1 / 9 + z * (-1 / 11)))))
    h, e = fast_two_sum(ATAN_TABLE[j], th)
    return fast_two_sum(h, e + (ATAN_TABLE[j + 1] + (tl + p)))


def atan(x: float) -> float:
    """Arc tangent, in [-pi/2, pi/2]."""
    a = fabs(x)
    if not (a >= TINY and a <= FAR):
        return copysign(HALF_PI_HIGH, x) if a > FAR else x
    if a <= 1.0:
        h, low = atan_near(a, a, 0.0, 1.0, 0.0)
    else:
        h, low = atan_ratio(1.0, 0.0, a, 0.0)
        h, low = add(HALF_PI_HIGH, HALF_PI_LOW, -h, -low)
    return copysign(h, x)


def quadrant(yh: float, yl: float, xh: float, xl: float, left: bool) -> float:
    """The angle of (x, y), x, y >= 0 not both 0, or of (-x, y) where `left`."""
    if yh <= xh:
        h, low = atan_ratio(yh, yl, xh, xl)
    else:
        h, low = atan_ratio(xh, xl, yh, yl)
        h, low = add(HALF_PI_HIGH, HALF_PI_LOW, -h, -low)
    if left:
        h, low = add(PI_HIGH, PI_LOW, -h, -low)
    return h


def atan2(y: float, x: float) -> float:
    """The angle of the point (x, y), in [-pi, pi], with the special cases of C99, F.9.1.4."""
    a = fabs(y)
    b = fabs(x)
    large = a if a > b else b
    small = b if a > b else a
    if not (small > 1e-15 * large and large < 1e150 and small > 1e-150):
        return atan2_special(y, x)
    return copysign(quadrant(a, 0.0, b, 0.0, x < 0.0), y)


@rare
def atan2_special(y: float, x: float) -> float:
    """The same where a coordinate is 0, infinite or NaN, or far from the other one or from 1 in size."""
    a = fabs(y)
    b = fabs(x)
    if x != x or y != y:
        return x + y
    if a == INFINITY and b == INFINITY:
        return copysign(quadrant(1.0, 0.0, 1.0, 0.0, x < 0.0), y)
    left = copysign(1.0, x) < 0.0
    if a == 0.0 or b == INFINITY:
        return copysign(PI_HIGH if left else 0.0, y)
    if b == 0.0 or a == INFINITY:
        return copysign(HALF_PI_HIGH, y)
    if quotient(a, b) < 1e-9 and not left:
        return y / x  # an angle this small is its tangent
    if quotient(b, a) < 1e-25:
        return copysign(HALF_PI_HIGH, y)
    if quotient(a, b) < 1e-25:
        return copysign(PI_HIGH, y)
    scale = 1.0
    if a > 1e100 or b > 1e100:
        scale = 9.332636185032189e-302  # 2^-1000
    if a < 1e-100 or b < 1e-100:
        scale = 1.0715086071862673e301  # 2^1000
    return copysign(quadrant(a * scale, 0.0, b * scale, 0.0, left), y)


def cofactor(x: float) -> Pair:
    """The square root of 1 - x^2 as a pair, |x| < 1."""
    p, e = square(x)
    h, d = two_sum(1.0, -p)
    h, d = fast_two_sum(h, d - e)
    return square_root(h, d)


def asin(x: float) -> float:
    """Arc sine, in [-pi/2, pi/2]; NaN outside [-1, 1]."""
    a = fabs(x)
    if not (a >= TINY and a < 1.0):
        return asin_special(x)
    h, low = cofactor(a)
    return copysign(quadrant(a, 0.0, h, low, False), x)


@rare
def asin_special(x: float) -> float:
    """asin x for tiny x, 1, NaN and beyond."""
    if fabs(x) > 1.0:
        return NAN
    return copysign(HALF_PI_HIGH, x) if fabs(x) == 1.0 else x


def acos(x: float) -> float:
    """Arc cosine, in [0, pi]; NaN outside [-1, 1]."""
    a = fabs(x)
    if not a < 1.0:
        return acos_special(x)
    h, low = cofactor(a)
    return quadrant(h, low, a, 0.0, x < 0.0)


@rare
def acos_special(x: float) -> float:
    """acos x at 1 and -1, for NaN and beyond."""
    if x == 1.0:
        return 0.0
    if x == -1.0:
        return PI_HIGH
    return x if x != x else NAN
