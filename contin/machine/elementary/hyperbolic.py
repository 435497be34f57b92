"""sinh, cosh, tanh by e^x - 1 as a pair; asinh, acosh, atanh by log(1 + x) of a pair."""

from __future__ import annotations

import math

from contin.machine.elementary.constants import LN2_HIGH, LN2_LOW
from contin.machine.elementary.double_double import add, divide, fast_two_sum, square, square_root, two_sum
from contin.machine.elementary.exponential import expm1_pair, mantissa, mantissa_pair, power_of_two, reduced
from contin.machine.elementary.language import Pair, copysign, fabs, rare
from contin.machine.elementary.logarithm import log1p_pair, log_pair

INFINITY, NAN = math.inf, math.nan
TINY = 7.450580596923828e-09  # 2^-27: x^2/6 does not count
HUGE = 1073741824.0  # 2^30


def sinh(x: float) -> float:
    """(e^x - e^-x)/2, for |x| < 1 as (E + E/(E + 1))/2, E = e^x - 1."""
    a = fabs(x)
    if not (a >= TINY and a <= 40.0):
        return copysign(half_exp(a), x) if a > 40.0 else x
    if a >= 1.0:
        h, low = exp_pair(a)
        q = 1.0 / h
        s, e = fast_two_sum(h, -q)
        return copysign(0.5 * (s + (e + (low + q * q * low))), x)
    h, low = expm1_pair(a)
    uh, ul = add(h, low, 1.0, 0.0)
    vh, vl = divide(h, low, uh, ul)
    h, low = add(h, low, vh, vl)
    return copysign(0.5 * h, x)


def cosh(x: float) -> float:
    """(e^x + e^-x)/2."""
    a = fabs(x)
    if not a <= 40.0:
        return half_exp(a)
    h, low = exp_pair(a)
    q = 1.0 / h
    s, e = fast_two_sum(h, q)
    return 0.5 * (s + (e + (low - q * q * low)))


def exp_pair(a: float) -> Pair:
    """e^a as a pair, relative error about 2^-61; 0 <= a <= 40."""
    k, r = reduced(a)
    h, low = mantissa_pair(k & 127, r)
    scale = power_of_two(k >> 7)
    return h * scale, low * scale


@rare
def half_exp(a: float) -> float:
    """e^a/2 for a > 40, infinity or NaN."""
    if a != a or a > 710.5:
        return a * INFINITY
    k, r = reduced(a)
    return mantissa(k & 127, r) * power_of_two((k >> 7) - 1)


def tanh(x: float) -> float:
    """E/(E + 2), E = e^(2x) - 1; for |x| >= 2 it is 1 - 2/(e^(2x) + 1)."""
    a = fabs(x)
    if not (a >= TINY and a <= 20.0):
        return copysign(1.0, x) if a > 20.0 else x
    if a >= 2.0:
        h, low = exp_pair(2.0 * a)
        d, e = fast_two_sum(h, 1.0)
        q = 2.0 / d
        return copysign(1.0 - (q - 0.5 * q * q * (e + low)), x)
    h, low = expm1_pair(2.0 * a)
    uh, ul = add(h, low, 2.0, 0.0)
    h, _low = divide(h, low, uh, ul)
    return copysign(h, x)


def asinh(x: float) -> float:
    """log(1 + x + x^2/(1 + sqrt(1 + x^2))), odd."""
    a = fabs(x)
    if not (a >= TINY and a <= HUGE):
        return copysign(log_of_double(a), x) if a > HUGE else x
    zh, zl = square(a)
    sh, sl = add(zh, zl, 1.0, 0.0)
    sh, sl = square_root(sh, sl)
    sh, sl = add(sh, sl, 1.0, 0.0)
    qh, ql = divide(zh, zl, sh, sl)
    qh, ql = add(qh, ql, a, 0.0)
    h, _low = log1p_pair(qh, ql)
    return copysign(h, x)


@rare
def log_of_double(a: float) -> float:
    """log(2 a), a > 2^30 or infinite."""
    if a == INFINITY:
        return a
    h, low = log_pair(a)
    h, _low = add(h, low, LN2_HIGH, LN2_LOW)
    return h


def acosh(x: float) -> float:
    """log(1 + t + sqrt(t (t + 2))), t = x - 1; NaN below 1."""
    if not (x >= 1.0 and x <= HUGE):
        return log_of_double(x) if x > HUGE else x if x != x else NAN
    if x == 1.0:
        return 0.0
    zh, zl = square(x)
    sh, sl = add(zh, zl, -1.0, 0.0)
    sh, sl = square_root(sh, sl)
    th, tl = two_sum(x, -1.0)
    h, low = add(sh, sl, th, tl)
    h, _low = log1p_pair(h, low)
    return h


def atanh(x: float) -> float:
    """(log(1 + x) - log(1 - x))/2; infinite at 1 and -1, NaN beyond."""
    a = fabs(x)
    if not (a >= TINY and a < 1.0):
        return atanh_special(x)
    h, low = log1p_pair(a, 0.0)
    uh, ul = log1p_pair(-a, 0.0)
    h, low = add(h, low, -uh, -ul)
    return copysign(0.5 * h, x)


@rare
def atanh_special(x: float) -> float:
    """atanh x for tiny x, 1, NaN and beyond."""
    if fabs(x) > 1.0:
        return NAN
    return copysign(INFINITY, x) if fabs(x) == 1.0 else x
