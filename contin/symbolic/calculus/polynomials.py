"""Polynomials in the local variable: recognised, divided, and written in the model's symbols."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Final

from contin.model.expression import (
    ONE,
    Expression,
    add,
    as_expression,
    mul,
    numeric_value,
    postorder,
    power,
    split_coefficient,
)
from contin.model.symbol_masks import symbol_bit
from contin.symbolic.calculus.centres import LOCAL
from contin.symbolic.calculus.series import expand
from contin.symbolic.calculus.series_arithmetic import Coefficient, reciprocal

LARGEST_DEGREE: Final = 64


def polynomial_quotient(local: Expression, w: Expression) -> Expression | None:
    """A product of polynomials in the local variable and their negative powers, with the common zero divided out."""
    tops: list[Expression] = []
    bottoms: list[Expression] = []
    for factor in local.args if local.op == "mul" else (local,):
        is_bottom = factor.op == "pow" and factor.args[1].is_number and numeric_value(factor.args[1]) < 0
        (bottoms if is_bottom else tops).append(power(factor, -1) if is_bottom else factor)
    numerator, denominator = mul(*tops), mul(*bottoms)
    degrees = [degree_of(numerator), degree_of(denominator)]
    if not bottoms or None in degrees:
        return None
    terms = 1 + max(d for d in degrees if d is not None)
    over, under = (expand(e, LOCAL, max(terms, 2)).stripped() for e in (numerator, denominator))
    if over.start < under.start or not under.terms or not over.terms:
        return None
    return mul(polynomial(over.terms, w, over.start - under.start), reciprocal(polynomial(under.terms, w, 0)))


def degree_of(expression: Expression) -> int | None:
    """Degree in the local variable, None where this is no polynomial or one of degree above `LARGEST_DEGREE`."""
    bit = symbol_bit(LOCAL)
    degrees: dict[Expression, int] = {}
    for node in postorder([expression]):
        if not node.mask & bit:
            degrees[node] = 0
        elif node.op == "symbol":
            degrees[node] = 1
        elif node.op == "add":
            degrees[node] = max(degrees[a] for a in node.args)
        elif node.op == "mul":
            degrees[node] = sum(degrees[a] for a in node.args)
        elif node.op == "pow" and node.args[1].is_number:
            exponent = numeric_value(node.args[1])
            if exponent != int(exponent) or exponent < 0:
                return None
            degrees[node] = degrees[node.args[0]] * int(exponent)
        else:
            return None
        if degrees[node] > LARGEST_DEGREE:
            return None
    return degrees[expression]


def polynomial(coefficients: Sequence[Coefficient], w: Expression, shift: int) -> Expression:
    """sum c_k w^(k + shift), with a symbolic factor that all coefficients share in front."""
    nodes = [as_expression(c) for c in coefficients]
    rests = {split_coefficient(c)[1] for c in nodes if not c.is_number}
    has_numbers = any(c.is_number and c.value != 0 for c in nodes)
    if len(rests) == 1 and not has_numbers:
        common = rests.pop()
        inner = [Fraction(0) if c.is_number else split_coefficient(c)[0] for c in nodes]
        return mul(common, add(*(mul(as_expression(c), _power(w, k + shift)) for k, c in enumerate(inner))))
    return add(*(mul(c, _power(w, k + shift)) for k, c in enumerate(nodes)))


def _power(w: Expression, exponent: int) -> Expression:
    """w^k; even powers of a square root without the root, which has no derivative at 0."""
    if w.op == "sqrt" or (w.op == "pow" and w.args[1].value == Fraction(1, 2)):
        return mul(power(w.args[0], exponent // 2), w if exponent % 2 else ONE)
    return power(w, exponent)
