"""sin, cos, tan: reduction modulo pi/32, a table of 64 angles, Taylor polynomials of sin r and cos r - 1.

x = k pi/32 + r, |r| <= pi/64, sin x = S + C r + C (sin r - r) + S (cos r - 1), where S, C are the sine and cosine of
k pi/32 as pairs and C r is computed exactly to its 26 leading bits. Up to 1e5, pi/32 in three parts gives r as a pair
to 2^-103; beyond, and where r comes out tiny, the product with 1/(2 pi) is formed in integers of 256 bits (Payne and
Hanek 1983), so the reduction is right for every x.
"""

from __future__ import annotations

import math

from contin.machine.elementary.constants import (
    PER_PI_32,
    PER_TWO_PI_WORDS,
    PI_32_FIRST,
    PI_32_HIGH,
    PI_32_LOW,
    PI_32_SECOND,
    PI_32_THIRD,
    SINE_TABLE,
)
from contin.machine.elementary.double_double import divide, fast_two_sum, multiply, split, two_sum
from contin.machine.elementary.exponential import SHIFT, SHIFT_BITS
from contin.machine.elementary.language import (
    Pair,
    bits,
    carry,
    fabs,
    high_product,
    low_product,
    low_sum,
    rare,
    shift_left,
    shift_right,
    to_float,
)

INFINITY, NAN = math.inf, math.nan
TINY = 7.450580596923828e-09  # 2^-27: x^2/6 does not count
NEAR = 2.9103830456733704e-11  # 2^-35
FAR = 1e5
MANTISSA_BITS, HIDDEN_BIT = 0x000FFFFFFFFFFFFF, 0x0010000000000000
LOWER = 0xFFFFFFFF
S3, S5, S7, S9 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880
C4, C6, C8 = 1 / 24, -1 / 720, 1 / 40320


def sin(x: float) -> float:
    """Sine; NaN at infinity."""
    if fabs(x) < TINY:
        return x
    k, r, s = reduced_angle(x)
    high, _low = sine(k, r, s)
    return high


def cos(x: float) -> float:
    """Cosine; NaN at infinity."""
    k, r, s = reduced_angle(x)
    high, _low = sine(k + 16, r, s)
    return high


def sincos(x: float) -> Pair:
    """Sine and cosine of one angle."""
    k, r, s = reduced_angle(x)
    a, _b = sine(k, r, s)
    c, _d = sine(k + 16, r, s)
    return x if fabs(x) < TINY else a, c


def tan(x: float) -> float:
    """Tangent; NaN at infinity."""
    if fabs(x) < TINY:
        return x
    k, r, s = reduced_angle(x)
    a, b = sine(k, r, s)
    c, d = sine(k + 16, r, s)
    high, _low = divide(a, b, c, d)
    return high


def sine(k: int, r: float, s: float) -> Pair:
    """sin(k pi/32 + r + s) as a pair."""
    j = (k & 63) << 2
    sh, ch, cl = SINE_TABLE[j], SINE_TABLE[j + 2], SINE_TABLE[j + 3]
    rh, rl = split(r)
    z = r * r
    c = ch + cl
    p = r * z * (S3 + z * (S5 + z * (S7 + z * S9)))
    q = z * (-0.5 + z * (C4 + z * (C6 + z * C8)))
    h, e = fast_two_sum(sh, ch * rh)
    return fast_two_sum(h, (e + ((ch * rl + cl * r) + (SINE_TABLE[j + 1] + c * s))) + (c * p + sh * q))


def reduced_angle(x: float) -> tuple[int, float, float]:
    """k, r, s with x = k pi/32 + r + s modulo 2 pi; NaN at infinity."""
    if not fabs(x) <= FAR:
        return reduced_far(x)
    shifted = x * PER_PI_32 + SHIFT
    k = shifted - SHIFT
    r, e = two_sum(x - k * PI_32_FIRST, -(k * PI_32_SECOND))
    r, s = fast_two_sum(r, e - k * PI_32_THIRD)
    if fabs(r) < NEAR and k != 0.0:
        return reduced_far(x)
    return bits(shifted) - SHIFT_BITS, r, s


@rare
def reduced_far(x: float) -> tuple[int, float, float]:
    """The same for |x| >= 2^-12 of any size, the relative error of r + s being about 2^-100."""
    size = fabs(x)
    if not size < INFINITY:
        return 0, NAN, NAN
    offset = (bits(size) >> 52) - 1075 + 64
    m = (bits(size) & MANTISSA_BITS) | HIDDEN_BIT
    w = offset >> 6
    by = offset & 63
    # 256 bits of 1/(2 pi), from the first that does not make whole turns
    w0 = window(PER_TWO_PI_WORDS[w], PER_TWO_PI_WORDS[w + 1], by)
    w1 = window(PER_TWO_PI_WORDS[w + 1], PER_TWO_PI_WORDS[w + 2], by)
    w2 = window(PER_TWO_PI_WORDS[w + 2], PER_TWO_PI_WORDS[w + 3], by)
    w3 = window(PER_TWO_PI_WORDS[w + 3], PER_TWO_PI_WORDS[w + 4], by)
    # their product with m, whole turns left out: p0 2^-64 + p1 2^-128 + p2 2^-192 + ... of a turn
    p2, over2 = with_carry(low_product(m, w2), high_product(m, w3), 0)
    p1, over1 = with_carry(low_product(m, w1), high_product(m, w2), over2)
    p0 = low_sum(low_sum(low_product(m, w0), high_product(m, w1)), over1)
    k = low_sum(p0, 1 << 57) >> 58
    p0 = low_sum(p0, -(k << 58))
    negative = p0 < 0
    if negative:  # 1 in the last of 192 places does not count
        p0 = ~p0
        p1 = ~p1
        p2 = ~p2
    h = to_float(shift_right(p0, 32)) * 4294967296.0
    low = 0.0
    h, low = grown(h, low, to_float(p0 & LOWER))
    h, low = grown(h, low, to_float(shift_right(p1, 32)) * 2.3283064365386963e-10)
    h, low = grown(h, low, to_float(p1 & LOWER) * 5.421010862427522e-20)
    h, low = grown(h, low, to_float(shift_right(p2, 32)) * 1.262177448353619e-29)
    h, low = grown(h, low, to_float(p2 & LOWER) * 2.938735877055719e-39)
    h, low = multiply(h * 3.469446951953614e-18, low * 3.469446951953614e-18, PI_32_HIGH, PI_32_LOW)
    if negative != (x < 0.0):
        h = -h
        low = -low
    return -k if x < 0.0 else k, h, low


def window(a: int, b: int, by: int) -> int:
    """64 bits of the 128 bits a b, from bit `by` on."""
    return shift_left(a, by) | shift_right(shift_right(b, 1), 63 - by)


def with_carry(a: int, b: int, c: int) -> tuple[int, int]:
    """a + b + c modulo 2^64, and what goes over; c <= 1."""
    s = low_sum(a, b)
    return low_sum(s, c), carry(a, b) + carry(s, c)


def grown(h: float, low: float, term: float) -> Pair:
    """h + low + term, |term| at most about |h| or h = 0."""
    s, e = two_sum(h, term)
    return fast_two_sum(s, e + low)
