"""log, log1p, log10, log2 by a table of 128 reciprocals of ten bits.

x = 2^k m, 0.705 <= m < 1.41; c is near 1/m, so r = m c - 1 is at most 2^-7.6 and is computed exactly as a pair, and
log x = k ln 2 - log c + log(1 + r). The constants are split so that k ln 2 - log c has an exact high part. Around
m = 1 the table holds c = 1: log x keeps its relative precision there.
"""

from __future__ import annotations

import math

from contin.machine.elementary.constants import (
    LN2_HIGH_SHORT,
    LN2_LOW_SHORT,
    LOG_TABLE,
    PER_LN2_HIGH,
    PER_LN2_LOW,
    PER_LN10_HIGH,
    PER_LN10_LOW,
)
from contin.machine.elementary.double_double import fast_two_sum, multiply, square, two_sum
from contin.machine.elementary.language import Pair, bits, double, fabs, rare, to_float

INFINITY, NAN = math.inf, math.nan
SMALLEST_NORMAL_BITS = 0x0010000000000000
INFINITY_BITS = 0x7FF0000000000000
LOWEST_BITS = 0x3FF0000000000000 - (1 << 44) - 75 * (1 << 45)  # 0.705: where m begins, half a cell off a cell's centre
UPPER_HALF = -(1 << 27)
TWO_54 = 18014398509481984.0


def log(x: float) -> float:
    """Natural logarithm."""
    if bits(x) < SMALLEST_NORMAL_BITS or bits(x) >= INFINITY_BITS:
        return log_special(x)
    return log_normal(x, 0)


@rare
def log_special(x: float) -> float:
    """log x for subnormal, negative, infinite x, 0 and NaN."""
    if x != x:
        return x
    if x == 0.0:
        return -INFINITY
    if x < 0.0:
        return NAN
    if x == INFINITY:
        return x
    return log_normal(x * TWO_54, -54)


def log_normal(x: float, e: int) -> float:
    """log(2^e x) for normal x."""
    w, low, r, s = parts(x, e)
    h, d = fast_two_sum(w, r)
    z = r * r
    return h + ((d + (low + s)) + z * (-0.5 + series(r)))


def series(r: float) -> float:
    """(log(1 + r) - r + r^2/2)/r^2 by Taylor's polynomial: the first term left out is r^9/11."""
    z = r * r
    return r * (1 / 3 - 0.25 * r + z * ((0.2 - 1 / 6 * r) + z * ((1 / 7 - 0.125 * r) + z * (1 / 9 - 0.1 * r))))


def parts(x: float, e: int) -> tuple[float, float, float, float]:
    """w, low, r, s with log(2^e x) = w + low + log(1 + r + s), x normal; w and r + s are exact."""
    offset = bits(x) - LOWEST_BITS
    k = offset >> 52
    j = 3 * ((offset >> 45) & 127)
    m = bits(x) - (k << 52)
    upper = double(m & UPPER_HALF)
    c = LOG_TABLE[j]
    r, s = fast_two_sum(upper * c - 1.0, (double(m) - upper) * c)
    n = to_float(k + e)
    return n * LN2_HIGH_SHORT + LOG_TABLE[j + 1], n * LN2_LOW_SHORT + LOG_TABLE[j + 2], r, s


def tail(w: float, low: float, r: float, s: float) -> Pair:
    """w + low + log(1 + r + s) as a pair, relative error about 2^-68."""
    h, d1 = fast_two_sum(w, r)
    z, f = square(r)
    h, d2 = fast_two_sum(h, -0.5 * z)
    return fast_two_sum(h, ((d1 + d2) + ((low + s) - (0.5 * f + r * s))) + z * series(r))


def log_pair(x: float) -> Pair:
    """log x as a pair, 0 < x < infinity."""
    if x < 2.2250738585072014e-308:
        w, low, r, s = parts(x * TWO_54, -54)
    else:
        w, low, r, s = parts(x, 0)
    return tail(w, low, r, s)


def log1p_pair(h: float, low: float) -> Pair:
    """log(1 + h + low) as a pair, relative error about 2^-62; -1 < h."""
    if h > -0.00195 and h < 0.0039:
        return tail(0.0, 0.0, h, low)
    u, d = two_sum(1.0, h)
    w, v, r, s = parts(u, 0)
    return tail(w, v + (d + low) / u, r, s)


def log1p(x: float) -> float:
    """log(1 + x)."""
    if not (x > -1.0 and x < INFINITY):
        return log1p_special(x)
    if fabs(x) < 1.1102230246251565e-16:
        return x
    high, _low = log1p_pair(x, 0.0)
    return high


@rare
def log1p_special(x: float) -> float:
    """log(1 + x) for x <= -1, infinity and NaN."""
    return log_special(x) if x != x or x > 0.0 else -INFINITY if x == -1.0 else NAN


def log10(x: float) -> float:
    """Logarithm to base 10."""
    if not (x > 0.0 and x < INFINITY):
        return log_special(x)
    h, low = log_pair(x)
    h, _low = multiply(h, low, PER_LN10_HIGH, PER_LN10_LOW)
    return h


def log2(x: float) -> float:
    """Logarithm to base 2."""
    if not (x > 0.0 and x < INFINITY):
        return log_special(x)
    h, low = log_pair(x)
    h, _low = multiply(h, low, PER_LN2_HIGH, PER_LN2_LOW)
    return h
