"""Complex formulas as pairs (real part, imaginary part) of real ones."""

from __future__ import annotations

from contin.model.expression import ONE, ZERO, Expression, add, mask_of, mul, neg, sub, symbols_in
from contin.symbolic.averaging.terms import additive_terms

Complex = tuple[Expression, Expression]


def plus(a: Complex, b: Complex) -> Complex:
    """a + b"""
    return add(a[0], b[0]), add(a[1], b[1])


def times(a: Complex, b: Complex) -> Complex:
    """a * b"""
    return sub(mul(a[0], b[0]), mul(a[1], b[1])), add(mul(a[0], b[1]), mul(a[1], b[0]))


def conjugate(a: Complex) -> Complex:
    """The complex conjugate."""
    return a[0], neg(a[1])


def to_power(a: Complex, n: int) -> Complex:
    """a^n for n >= 0, binomially, so that equal powers of the parts are collected."""
    if n == 0:
        return ONE, ZERO
    result = a
    for _ in range(n - 1):
        result = expand(times(result, a))
    return result


def expand(a: Complex) -> Complex:
    """Sums multiplied out and like terms collected."""
    mask = mask_of(symbols_in(a))
    re, im = (add(*(mul(c, t) for c, t in additive_terms(part, mask))) for part in a)
    return re, im
