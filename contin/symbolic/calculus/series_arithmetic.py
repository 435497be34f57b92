"""Arithmetic of truncated Laurent series in one symbol, with formulas (in the other symbols) as coefficients.

Coefficients are Python numbers while they are numbers (exact where the formula is), formulas otherwise. Each operation
keeps as many terms as it can know; division by a series that starts with w^v loses v of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Union

from contin.model.expression import Expression, Number, add, as_expression, mul, number, numeric_value, power
from contin.symbolic.calculus.vanishing import vanishes

Coefficient = Union[Number, Expression]


class NotAnalyticError(ArithmeticError):
    """The formula has no Laurent series here that this module knows (a kink, a branch point, a condition)."""


@dataclass(frozen=True)
class Series:
    """sum of terms[k] w^(start + k), known up to (not including) w^(start + len(terms))."""

    start: int
    terms: tuple[Coefficient, ...]

    @property
    def end(self) -> int:
        """First unknown power."""
        return self.start + len(self.terms)

    def at(self, exponent: int) -> Coefficient:
        """Coefficient of w^exponent, which must be known."""
        if exponent >= self.end:
            raise IndexError(exponent)
        return self.terms[exponent - self.start] if exponent >= self.start else Fraction(0)

    def stripped(self) -> Series:
        """The same series from its first term that is not identically zero."""
        for k, term in enumerate(self.terms):
            if not is_zero(term):
                return Series(self.start + k, self.terms[k:])
        return Series(self.end, ())


# coefficients


def is_zero(c: Coefficient) -> bool:
    """True where a coefficient is identically zero."""
    if isinstance(c, Expression):
        return vanishes(c)
    return c == 0 if isinstance(c, Fraction) else abs(c) < 1e-14


def plus(a: Coefficient, b: Coefficient) -> Coefficient:
    """a + b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return plain(add(as_expression(a), as_expression(b)))
    return a + b


def times(a: Coefficient, b: Coefficient) -> Coefficient:
    """a b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return plain(mul(as_expression(a), as_expression(b)))
    return a * b


def over(a: Coefficient, b: Coefficient) -> Coefficient:
    """a / b"""
    if isinstance(a, Expression) or isinstance(b, Expression):
        return plain(mul(as_expression(a), reciprocal(as_expression(b))))
    return a / b


def reciprocal(node: Expression) -> Expression:
    """1/node, factor by factor, so that it cancels against a product's factors."""
    if node.op == "mul":
        return mul(*(reciprocal(factor) for factor in node.args))
    if node.op == "pow" and node.args[1].is_number:
        value = numeric_value(node.args[1])
        if isinstance(value, Fraction) and value.denominator == 1:
            return power(node.args[0], number(-value))
    return power(node, number(-1))


def plain(node: Expression) -> Coefficient:
    """A number node as a number."""
    return numeric_value(node) if node.is_number else node


def dot(a: Sequence[Coefficient], b: Sequence[Coefficient]) -> Coefficient:
    """sum a_i b_i, as one flat sum."""
    exact: Number = Fraction(0)
    formulas = []
    for x, y in zip(a, b, strict=True):
        if not x or not y:
            continue
        product = times(x, y)
        if isinstance(product, Expression):
            formulas.append(product)
        else:
            exact = exact + product
    return plain(add(*formulas, number(exact))) if formulas else exact


# series


def series_sum(parts: Sequence[Series]) -> Series:
    """a + b + ..."""
    start, end = min(p.start for p in parts), min(p.end for p in parts)
    ones = [Fraction(1)] * len(parts)
    sums = [dot([p.at(k) for p in parts], ones) for k in range(start, end)]
    # (a + b) - (b + a): what cancels is found here once, so that it does not grow into every later term
    return Series(start, tuple(Fraction(0) if isinstance(c, Expression) and vanishes(c) else c for c in sums))


def series_product(a: Series, b: Series) -> Series:
    """a b"""
    x, y = a.terms, b.terms
    count = min(len(x), len(y))
    return Series(a.start + b.start, tuple(dot(x[: k + 1], y[k::-1]) for k in range(count)))


def scaled(c: Coefficient, a: Series) -> Series:
    """c a"""
    return Series(a.start, tuple(times(c, term) for term in a.terms))


def series_power(a: Series, exponent: Expression) -> Series:
    """a^e for an exponent that does not contain the variable."""
    e = numeric_value(exponent) if exponent.is_number else None
    whole = int(e) if isinstance(e, Fraction) and e.denominator == 1 else None
    if whole is not None and whole > 0:
        result = a
        for _ in range(whole - 1):
            result = series_product(result, a)
        return result
    base = a.stripped()
    if not base.terms or (base.start != 0 and whole is None):
        raise NotAnalyticError("power of zero")
    first = base.terms[0]
    unit = [over(term, first) for term in base.terms]
    factor: Coefficient = plain(power(as_expression(first), exponent))
    raised = _unit_power(unit, numeric_value(exponent) if exponent.is_number else exponent)
    return scaled(factor, Series(base.start * whole if whole is not None else 0, raised))


def _unit_power(u: Sequence[Coefficient], e: Coefficient) -> tuple[Coefficient, ...]:
    """u^e where u[0] = 1, from u y' = e u' y."""
    y: list[Coefficient] = [Fraction(1)]
    present = [j for j, c in enumerate(u) if j > 0 and c]
    for k in range(1, len(u)):
        used = [j for j in present if j <= k and y[k - j]]
        weights = [plus(times(plus(e, Fraction(1)), Fraction(j, k)), Fraction(-1)) for j in used]
        y.append(dot([times(w, u[j]) for w, j in zip(weights, used, strict=True)], [y[k - j] for j in used]))
    return tuple(y)


def slope_terms(a: Series) -> list[Coefficient]:
    """Coefficients of da/dw for a Taylor series that starts at w^0."""
    return [times(Fraction(k), term) for k, term in enumerate(a.terms)][1:]


def integrated(constant: Coefficient, slope: Series, count: int) -> Series:
    """constant + integral of `slope`, to at most `count` terms."""
    terms = [times(Fraction(1, k + 1), slope.at(k)) for k in range(min(count - 1, slope.end))]
    return Series(0, (constant, *terms))
