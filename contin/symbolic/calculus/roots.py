"""Roots of differences of roots, sqrt(sqrt(1 + w) - 1), without cancellation where w is small.

sqrt(A) - c = (A - c^2)/(sqrt(A) + c) exactly, and the even powers in A - c^2 leave the root: sqrt(sqrt(1 + r^4) - 1) =
r^2/sqrt(sqrt(1 + r^4) + 1). As written it has no digit below r = 1e-4, and infinite derivatives. Such roots stand in
the averages of quotients of polynomials, whose poles are complex.
"""

from __future__ import annotations

from fractions import Fraction

from contin.model.expression import Expression, add, call, div, mul, numeric_value, power


def regular_root(root: Expression) -> Expression:
    """sqrt(k sqrt(A) - c), k and c > 0 numbers and A - (c/k)^2 without a constant, rewritten; any other as it is."""
    found = _conjugate(root.args[0])
    if found is None:
        return root
    top, bottom = found
    outside: list[Expression] = []
    inside: list[Expression] = []
    for factor in top.args if top.op == "mul" else (top,):
        half = _half(factor)
        (inside if half is None else outside).append(factor if half is None else half)
    return mul(*outside, call("sqrt", div(mul(*inside) if inside else 1, bottom)))


def _conjugate(difference: Expression) -> tuple[Expression, Expression] | None:
    """(k^2 A - c^2, k sqrt(A) + c) of k sqrt(A) - c."""
    if difference.op != "add" or len(difference.args) != 2:
        return None
    numbers = [term for term in difference.args if term.is_number]
    if len(numbers) != 1 or not numeric_value(numbers[0]) < 0:
        return None
    (c,) = numbers
    (first,) = [term for term in difference.args if not term.is_number]
    factors = first.args if first.op == "mul" else (first,)
    roots = [factor for factor in factors if factor.op == "sqrt"]
    others = [factor for factor in factors if factor.op != "sqrt"]
    if len(roots) != 1 or not all(factor.is_number and numeric_value(factor) > 0 for factor in others):
        return None
    under = roots[0].args[0]
    terms = under.args if under.op == "add" else (under,)
    top = add(*(mul(*others, *others, term) for term in terms), mul(-1, c, c))
    if top.op not in ("mul", "pow", "symbol"):
        return None
    return top, add(first, mul(-1, c))


def _half(factor: Expression) -> Expression | None:
    """|b|^m of b^(2 m)."""
    if factor.op != "pow" or not factor.args[1].is_number:
        return None
    exponent = numeric_value(factor.args[1])
    if not isinstance(exponent, Fraction) or exponent.denominator != 1 or exponent % 2:
        return None
    half = exponent / 2
    base = factor.args[0] if half % 2 == 0 else call("abs", factor.args[0])
    return power(base, half)
