"""pow: exp(y log x) with the logarithm as a pair, so that 2^9 times its relative error is still small."""

from __future__ import annotations

import math

from contin.machine.elementary.constants import LN2_128_HIGH, LN2_128_LOW, PER_LN2_128
from contin.machine.elementary.double_double import fast_two_sum, two_product
from contin.machine.elementary.exponential import SHIFT, SHIFT_BITS, mantissa, scaled
from contin.machine.elementary.language import bits, copysign, fabs, quotient, rare
from contin.machine.elementary.logarithm import log_pair, parts, tail

INFINITY, NAN = math.inf, math.nan
SMALLEST_NORMAL, LARGEST = 2.2250738585072014e-308, 1.7976931348623157e308
MOST, LEAST = 18446744073709551616.0, 1.3552527156068805e-20  # 2^64: every power but 1's overflows; 2^-66: it is 1
ALL_BITS, MANTISSA_BITS, HIDDEN_BIT = 0x7FFFFFFFFFFFFFFF, 0x000FFFFFFFFFFFFF, 0x0010000000000000


def pow(x: float, y: float) -> float:
    """x^y with the special cases of IEEE 754-2008, 9.2.1 (C99, F.9.4.4)."""
    if not (x >= SMALLEST_NORMAL and x <= LARGEST and fabs(y) < MOST and fabs(y) > LEAST):
        return pow_special(x, y)
    w, low, r, s = parts(x, 0)
    h, d = tail(w, low, r, s)
    return exp_of_product(y, h, d)


def exp_of_product(y: float, h: float, low: float) -> float:
    """exp(y (h + low))."""
    ph, pl = two_product(y, h)
    ph, pl = fast_two_sum(ph, pl + y * low)
    if ph > 710.0:
        return INFINITY
    if ph < -746.0:
        return 0.0
    shifted = ph * PER_LN2_128 + SHIFT
    n = shifted - SHIFT
    k = bits(shifted) - SHIFT_BITS
    r = (ph - n * LN2_128_HIGH) + (pl - n * LN2_128_LOW)
    return scaled(mantissa(k & 127, r), k >> 7)


@rare
def pow_special(x: float, y: float) -> float:
    """x^y for x <= 0, subnormal or infinite, and for y 0, tiny, huge or infinite, and for NaN."""
    if y == 0.0 or x == 1.0:
        return 1.0
    if x != x or y != y:
        return x + y
    kind = parity(y)
    size = fabs(x)
    if x == 0.0 or size == INFINITY:
        power = size if y > 0.0 else quotient(1.0, size)
        return copysign(power, x) if kind == 1 else power
    if x < 0.0 and kind == 0:
        return NAN
    if fabs(y) >= MOST:
        if size == 1.0:
            return 1.0
        grows = y > 0.0 if size > 1.0 else y < 0.0
        return INFINITY if grows else 0.0
    if fabs(y) <= LEAST:
        return 1.0
    h, low = log_pair(size)
    power = exp_of_product(y, h, low)
    return -power if x < 0.0 and kind == 1 else power


def parity(y: float) -> int:
    """0 where y is no integer, 1 where it is odd, 2 where it is even (and for infinity)."""
    e = ((bits(y) & ALL_BITS) >> 52) - 1023
    if e < 0:
        return 0
    if e > 52:
        return 2
    unit = HIDDEN_BIT >> e
    significand = (bits(y) & MANTISSA_BITS) | HIDDEN_BIT
    if (significand & (unit - 1)) != 0:
        return 0
    return 1 if (significand & unit) != 0 else 2
