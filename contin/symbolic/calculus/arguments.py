"""Removable singularities at the zero of a function's argument that is itself a product.

With w the argument as it stands, V F/(R T) in P z V F/(exp(V F/(R T)) - 1), the product is a monomial times a quotient
in w alone, w/(exp(w) - 1). So the coefficients are numbers, and no other factor of w ends up in a denominator.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from contin.model.expression import ONE, Expression, if_, mul, numeric_value, postorder, substitute, symbol
from contin.model.symbol_masks import symbol_bit
from contin.model.vocabulary import UNARY_FUNCTIONS
from contin.symbolic.calculus.centres import LARGEST, LOCAL
from contin.symbolic.calculus.series import expand
from contin.symbolic.calculus.series_arithmetic import NotAnalyticError, reciprocal
from contin.symbolic.calculus.taylor import taylor_near_zero

Powers = dict[Expression, Fraction]
ORDER_TERMS = 8  # zeros of higher order are left to other methods


def regular_in_argument(product: Expression) -> Expression | None:
    """The product with one quotient made regular at the zero of a function's argument, or None if there is none."""
    powers = factor_powers(product)
    for w in _arguments(product):
        if not any(base.mask and base in powers for base in factor_powers(w)):
            continue
        try:
            result = _regular(powers, w)
        except (NotAnalyticError, OverflowError):
            continue
        if result is not None:
            return result
    return None


def factor_powers(product: Expression) -> Powers:
    """Base -> exponent for the factors of a product; a power that is no integer is a base of its own."""
    powers: Powers = {}
    for factor in product.args if product.op == "mul" else (product,):
        base, exponent = factor, Fraction(1)
        if factor.op == "pow" and factor.args[1].is_number:
            value = numeric_value(factor.args[1])
            if isinstance(value, Fraction) and value.denominator == 1:
                base, exponent = factor.args[0], value
        if base.op == "mul":
            for inner, power in factor_powers(base).items():
                powers[inner] = powers.get(inner, Fraction(0)) + power * exponent
        else:
            powers[base] = powers.get(base, Fraction(0)) + exponent
    return powers


def _arguments(product: Expression) -> Iterator[Expression]:
    seen: set[Expression] = set()
    nodes = postorder([product])
    for node in nodes if len(nodes) <= LARGEST else ():
        if node.op in UNARY_FUNCTIONS:
            w = node.args[0]
        elif node.op == "pow":
            w = node.args[1]
        else:
            continue
        if w.mask and w not in seen:
            seen.add(w)
            yield w


def _regular(powers: Powers, w: Expression) -> Expression | None:
    local = dict(zip(powers, substitute(powers, {w: symbol(LOCAL)}), strict=True))
    bit = symbol_bit(LOCAL)
    order = 0
    vanishing: list[Expression] = []
    for base, exponent in powers.items():
        if local[base].mask & bit:
            zero = expand(local[base], LOCAL, ORDER_TERMS).stripped()
            if zero.start < 0 or not zero.terms:
                return None
            if zero.start > 0:
                vanishing.append(base)
                order += int(exponent) * zero.start
    rest = {base: e for base, e in powers.items() if base not in vanishing}
    if order == 0:
        removable = any(powers[base] < 0 for base in vanishing)
    else:
        shared = [(rest[b], e) for b, e in factor_powers(w).items() if b.mask and b in rest and e > 0]
        removable = any(own >= -order * e if order < 0 else own < 0 for own, e in shared)
    if not removable:
        return None
    balance = [w] * -order if order < 0 else [reciprocal(w)] * order
    found = taylor_near_zero(_product({local[b]: powers[b] for b in vanishing}, [symbol(LOCAL)], -order), w)
    if found is None:
        return None
    quotient = _product({b: powers[b] for b in vanishing}, balance, 1)
    inverse = [reciprocal(w)] * -order if order < 0 else [w] * order
    return _product(rest, [*inverse, if_(found[0], found[1], quotient)], 1)


def _product(powers: Powers, others: list[Expression], exponent: int) -> Expression:
    factors = [base ** int(e) if e != 1 else base for base, e in powers.items()]
    return mul(*factors, *(ONE if exponent == 0 else other**exponent for other in others))
