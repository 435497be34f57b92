"""Sums and products with their rounding errors, and arithmetic on pairs high + low.

Exact transformations of Dekker (1971) and Knuth, without fused multiply-add, so that they are the same everywhere;
see Muller et al., Handbook of Floating-Point Arithmetic, 2nd ed., ch. 4. Valid while nothing overflows and no error
term is below the smallest normal number: arguments are scaled by the callers.
"""

from __future__ import annotations

from contin.machine.elementary.language import Pair, sqrt

SPLITTER = 134217729.0  # 2^27 + 1


def two_sum(a: float, b: float) -> Pair:
    """a + b exactly."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


def fast_two_sum(a: float, b: float) -> Pair:
    """a + b exactly, where |a| >= |b|, or a is a multiple of ulp(b), or a = 0."""
    s = a + b
    return s, b - (s - a)


def split(a: float) -> Pair:
    """a in two parts of 26 bits, so that products of parts are exact."""
    c = SPLITTER * a
    high = c - (c - a)
    return high, a - high


def two_product(a: float, b: float) -> Pair:
    """a b exactly."""
    ah, al = split(a)
    bh, bl = split(b)
    p = a * b
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


def square(a: float) -> Pair:
    """a^2 exactly."""
    h, low = split(a)
    p = a * a
    return p, ((h * h - p) + 2.0 * (h * low)) + low * low


def add(ah: float, al: float, bh: float, bl: float) -> Pair:
    """Sum of two pairs, relative error about 2^-104 where their signs agree, absolute in |a| + |b| where not."""
    s, e = two_sum(ah, bh)
    t, f = two_sum(al, bl)
    s, e = fast_two_sum(s, e + t)
    return fast_two_sum(s, e + f)


def multiply(ah: float, al: float, bh: float, bl: float) -> Pair:
    """Product of two pairs, relative error about 2^-102."""
    p, e = two_product(ah, bh)
    return fast_two_sum(p, e + (ah * bl + al * bh))


def divide(ah: float, al: float, bh: float, bl: float) -> Pair:
    """Quotient of two pairs, relative error about 2^-101; one division."""
    r = 1.0 / bh
    q = ah * r
    p, e = two_product(q, bh)
    return fast_two_sum(q, ((ah - p) - e + al - q * bl) * r)


def square_root(ah: float, al: float) -> Pair:
    """Square root of a pair > 0, relative error about 2^-102; the division does not wait for the remainder."""
    s = sqrt(ah)
    r = 0.5 / s
    p, e = square(s)
    return fast_two_sum(s, ((ah - p) - e + al) * r)
