"""Averaged rates divided by the amplitude: rate(r)/r as a formula in r, or in R = r^2 for the forms smooth at r = 0.

Closed forms are divided term by term; what is left of the form log(1 + R^2)/R is made regular when the model is lowered
(`remove_singularities`). A quadrature is divided as a whole, with its limit at r = 0.
"""

from __future__ import annotations

from contin.model.expression import (
    Expression,
    add,
    call,
    compare,
    if_,
    mul,
    number,
    power,
    substitute,
    symbol,
)
from contin.symbolic.averaging.cells import RADIUS
from contin.symbolic.averaging.radial import Piece, R, RadialAverage
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.averaging.tidy import tidy
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.guards import near_zero
from contin.symbolic.calculus.sympy_bridge import from_sympy, sympy_symbol, to_sympy

SQUARE = symbol("@R")
MINUS_ONE = number(-1)


def turn_over_radius(rates: RadialAverage, radius: Expression) -> Expression:
    """turn(r)/r."""

    def part(piece: Piece) -> Expression:
        if piece.nodes:
            return substitute([_whole(piece.cos)], {SQUARE: power(R, number(2))})[0]
        return add(*(mul(c, _divided(t)) for c, t in additive_terms(piece.cos, R.mask)))

    return rates.chain(part, radius)


def rates_over_radius(rates: RadialAverage, square: Expression) -> tuple[Expression, Expression]:
    """(growth/r, turn/r) at r^2 = square; conditions r < c become r^2 < c^2."""
    results = []
    for name in ("sin", "cos"):
        value = _in_square(rates.pieces[-1], name)
        for piece in reversed(rates.pieces[:-1]):
            assert piece.high is not None
            value = if_(compare("<", SQUARE, power(piece.high, number(2))), _in_square(piece, name), value)
        results.append(substitute([value], {SQUARE: square})[0])
    return results[0], results[1]


def _in_square(piece: Piece, name: str) -> Expression:
    import sympy

    formula: Expression = getattr(piece, name)
    if piece.nodes:
        return _whole(formula)
    r, big = sympy_symbol(RADIUS, positive=True), sympy_symbol(str(SQUARE.value), positive=True)
    terms = []
    for c, t in additive_terms(formula, R.mask):
        value = (to_sympy(t, (RADIUS,)) / r).subs(r, sympy.sqrt(big))
        terms.append(mul(c, from_sympy(tidy(value, big))))
    return add(*terms)


def _whole(formula: Expression) -> Expression:
    """Q(r)/r as Q(sqrt R) sqrt(R)/R, and the slope of Q at r = 0."""
    root = call("sqrt", SQUARE)
    limit = substitute([derivative(formula, RADIUS)], {R: number(0)})[0]
    value = mul(substitute([formula], {R: root})[0], root, power(SQUARE, MINUS_ONE))
    return if_(near_zero(SQUARE), limit, value)


def _divided(term: Expression) -> Expression:
    """term/r, with a denominator that holds r merged with it."""
    if term.op == "mul":
        for k, factor in enumerate(term.args):
            bottom = factor.args[0] if factor.op == "pow" and factor.args[1] is MINUS_ONE else None
            if bottom is not None and bottom.op == "mul" and R in bottom.args:
                return mul(*term.args[:k], power(mul(*bottom.args, R), MINUS_ONE), *term.args[k + 1 :])
    return mul(term, power(R, MINUS_ONE))
