"""exp, exp2, expm1 by a table of 2^(j/128) and a Taylor polynomial of degree 5.

x = k ln 2/128 + r with |r| <= ln 2/256 = 0.0027, k = 128 e + j: exp(x) = 2^e 2^(j/128) exp(r). The first term left out
is r^6/720 < 2^-60. ln 2/128 is the sum of a number of 33 bits, whose product with k is exact, and one of 53 bits.
"""

from __future__ import annotations

import math

from contin.machine.elementary.constants import EXP_TABLE, LN2_128_HIGH, LN2_128_LOW, LN2_HIGH, PER_LN2_128
from contin.machine.elementary.double_double import fast_two_sum, two_product, two_sum
from contin.machine.elementary.language import Pair, bits, double, fabs, rare

SHIFT = 6755399441055744.0  # 1.5 * 2^52: adding it leaves the nearest integer in the lowest bits
SHIFT_BITS = 0x4338000000000000
INFINITY = math.inf
OVERFLOW = 709.782712893384  # ln of the largest number, rounded up
UNDERFLOW = -745.1332191019412  # ln of half the smallest number, rounded down
LARGE = 708.0  # to here the result is a normal number
ONE_BITS = 0x3FF0000000000000
C3, C4, C5, C6 = 1 / 6, 1 / 24, 1 / 120, 1 / 720


def exp(x: float) -> float:
    """e^x."""
    if not fabs(x) < LARGE:
        return exp_large(x)
    k, r = reduced(x)
    return double(bits(mantissa(k & 127, r)) + ((k >> 7) << 52))


@rare
def exp_large(x: float) -> float:
    """e^x where it may overflow, underflow or be NaN."""
    if x != x:
        return x
    if x > OVERFLOW:
        return INFINITY
    if x < UNDERFLOW:
        return 0.0
    k, r = reduced(x)
    return scaled(mantissa(k & 127, r), k >> 7)


def reduced(x: float) -> tuple[int, float]:
    """k and r with x = k ln 2/128 + r."""
    shifted = x * PER_LN2_128 + SHIFT
    k = shifted - SHIFT
    return bits(shifted) - SHIFT_BITS, (x - k * LN2_128_HIGH) - k * LN2_128_LOW


def mantissa(j: int, r: float) -> float:
    """2^(j/128) e^r, between 0.99 and 2."""
    z = r * r
    p = r + (0.5 * z + (C3 * r * z + z * z * (C4 + C5 * r)))
    t = EXP_TABLE[2 * j]
    return t + (EXP_TABLE[2 * j + 1] + t * p)


def mantissa_pair(j: int, r: float) -> Pair:
    """The same with what its last rounding leaves."""
    z = r * r
    p = r + (0.5 * z + (C3 * r * z + z * z * (C4 + C5 * r)))
    t = EXP_TABLE[2 * j]
    return fast_two_sum(t, EXP_TABLE[2 * j + 1] + t * p)


def power_of_two(e: int) -> float:
    """2^e for -1022 <= e <= 1023."""
    return double((e + 1023) << 52)


def scaled(x: float, e: int) -> float:
    """x 2^e, rounded once more only where the result is below the smallest normal number; |e| <= 2044."""
    half = e >> 1
    return x * power_of_two(half) * power_of_two(e - half)


def exp2(x: float) -> float:
    """2^x."""
    if not fabs(x) < 1022.0:
        return exp2_large(x)
    shifted = x * 128.0 + SHIFT
    k = bits(shifted) - SHIFT_BITS
    r = (x - (shifted - SHIFT) * 0.0078125) * LN2_HIGH
    return double(bits(mantissa(k & 127, r)) + ((k >> 7) << 52))


@rare
def exp2_large(x: float) -> float:
    """2^x where it may overflow, underflow or be NaN."""
    if x != x:
        return x
    if x >= 1024.0:
        return INFINITY
    if x < -1076.0:
        return 0.0
    shifted = x * 128.0 + SHIFT
    k = bits(shifted) - SHIFT_BITS
    return scaled(mantissa(k & 127, (x - (shifted - SHIFT) * 0.0078125) * LN2_HIGH), k >> 7)


def expm1(x: float) -> float:
    """e^x - 1."""
    if not fabs(x) < 40.0:
        return expm1_large(x)
    if fabs(x) < 1.1102230246251565e-16:
        return x
    high, _low = expm1_pair(x)
    return high


@rare
def expm1_large(x: float) -> float:
    """e^x - 1 where the 1 does not count, or x is NaN."""
    if x < 0.0:
        return -1.0
    return exp_large(x)


def expm1_pair(x: float) -> Pair:
    """e^x - 1, |x| <= 88, relative error about 2^-60."""
    shifted = x * PER_LN2_128 + SHIFT
    k = bits(shifted) - SHIFT_BITS
    n = shifted - SHIFT
    rh, rl = two_sum(x - n * LN2_128_HIGH, -(n * LN2_128_LOW))
    z = rh * rh
    q = 0.5 * z + (C3 * rh * z + z * z * (C4 + rh * (C5 + C6 * rh)))
    ph, pl = fast_two_sum(rh, rl + q)
    if k == 0:
        return ph, pl
    j = k & 127
    t = EXP_TABLE[2 * j]
    th, tl = two_product(t, ph)
    h, e = fast_two_sum(t, th)
    low = e + (tl + (t * pl + EXP_TABLE[2 * j + 1]) + EXP_TABLE[2 * j + 1] * ph)
    scale = power_of_two(k >> 7)
    h, e = two_sum(h * scale, -1.0)
    return fast_two_sum(h, e + low * scale)
