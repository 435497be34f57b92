"""Averaged rates divided by the amplitude, as functions of R = r^2: what the forms that are smooth at r = 0 need."""

from __future__ import annotations

from contin.model.expression import Expression, add, call, compare, if_, mul, number, postorder, power, substitute
from contin.symbolic.cells import RADIUS
from contin.symbolic.radial import SHORT, R, RadialAverage
from contin.symbolic.sympy_bridge import from_sympy, sympy_symbol, to_sympy
from contin.symbolic.terms import additive_terms
from contin.symbolic.tidy import tidy

SQUARE = "@R"


def rates_over_radius(rates: RadialAverage, square: Expression) -> tuple[Expression, Expression]:
    """(growth/r, turn/r) of `SlowSystem.rates` at r^2 = square; conditions r < c become r^2 < c^2."""
    results = []
    for part in ("sin", "cos"):
        value = _over_radius(getattr(rates.pieces[-1], part))
        for piece in reversed(rates.pieces[:-1]):
            assert piece.high is not None
            below = compare("<", _square_symbol(), power(piece.high, number(2)))
            value = if_(below, _over_radius(getattr(piece, part)), value)
        results.append(substitute([value], {_square_symbol(): square})[0])
    return results[0], results[1]


def _square_symbol() -> Expression:
    from contin.model.expression import symbol

    return symbol(SQUARE)


def _over_radius(formula: Expression) -> Expression:
    """formula(r)/r in R: term by term through sympy where the terms are short, otherwise with r = sqrt(R)."""
    import sympy

    square = _square_symbol()
    whole: list[Expression] = []
    long: list[Expression] = []
    for c, t in additive_terms(formula, R.mask):
        if len(postorder([t])) > SHORT or t.op in ("tanh", "sin", "cos", "exp"):
            long.append(mul(c, t))
            continue
        r, big = sympy_symbol(RADIUS, positive=True), sympy_symbol(SQUARE, positive=True)
        value = (to_sympy(t, (RADIUS,)) / r).subs(r, sympy.sqrt(big))
        whole.append(mul(c, from_sympy(tidy(value, big))))
    if long:
        root = call("sqrt", square)
        whole.append(mul(substitute([add(*long)], {R: root})[0], power(root, number(-1))))
    return add(*whole)
