"""What an equation is at eps = 0, and what is left over: the parts of reading a model as weak oscillators."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Final

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    mul,
    neg,
    number,
    sub,
    substitute,
    symbol,
    symbols_in,
)
from contin.model.parts import Oscillator
from contin.model.printing import to_text
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.sympy_bridge import from_sympy, to_sympy

_SHOWN: Final = 90


def stiffness(
    name: str,
    pair: Oscillator,
    equations: Mapping[str, Expression],
    eps: Expression,
    states: int,
    values: Mapping[str, float],
) -> Expression:
    """(h omega)^2 of one oscillator at eps = 0, of the model `name`."""
    x, y = pair.position, pair.velocity
    start = f"averaging model {name}: at {eps.value} = 0 the"
    rest = excess(equations[x], eps, {y: ONE}, states)
    if rest:
        raise InputError(f"{start} equation of {x} must be {x}' = {y}; the term {rest} is left over")
    at_zero = substitute([equations[y]], {eps: ZERO})[0]
    square = add(*(neg(c) for c, t in additive_terms(at_zero, states) if t is symbol(x)))
    rest = excess(equations[y], eps, {x: neg(square)}, states)
    if rest:
        raise InputError(
            f"{start} equation of {y} must be harmonic, {y}' = -omega^2 {x}; the term {rest} is left over. "
            f"If it is small, multiply it by {eps.value}"
        )
    size = evaluate(square, {**values, str(eps.value): 0.0})
    if not (math.isfinite(size) and size > 0):
        raise InputError(
            f"{start} equation of {y} must be harmonic, {y}' = -omega^2 {x} with omega^2 > 0; "
            f"omega^2 = {short(square)} is {size:.6g} for the default parameters"
        )
    return square


def excess(equation: Expression, eps: Expression, wanted: Mapping[str, Expression], states: int) -> str:
    """Text of the terms of `equation` at eps = 0 beyond those wanted; empty where there are none."""
    at_zero = substitute([equation], {eps: ZERO})[0]
    found = {t: c for c, t in additive_terms(at_zero, states)}
    for name, coefficient in wanted.items():
        left = sub(found.pop(symbol(name), ZERO), coefficient)
        if not is_zero(left):
            found[symbol(name)] = left
    left_over = [mul(c, t) for t, c in found.items() if not is_zero(c)]
    return short(add(*left_over)) if left_over else ""


def short(expression: Expression) -> str:
    """Its text, cut where it is long."""
    text = to_text(expression)
    return text if len(text) <= _SHOWN else text[: _SHOWN - 4] + " ..."


def is_zero(expression: Expression) -> bool:
    """True where sympy expands the formula, or its numerator, to 0."""
    if expression is ZERO or (expression.is_number and expression.value == 0):
        return True
    if not expression.args:
        return False
    import sympy

    value = sympy.expand(to_sympy(expression))
    return bool(value == 0 or (value.is_rational_function() and sympy.cancel(sympy.together(value)) == 0))


def is_equal(a: Expression, b: Expression) -> bool:
    """True where sympy finds the two formulas equal."""
    return a is b or is_zero(sub(a, b))


def series(equation: Expression, small: str, order: int) -> list[Expression]:
    """Coefficients of eps^1 ... eps^order."""
    coefficients = []
    current, factorial = equation, 1
    for k in range(1, order + 1):
        current = derivative(current, small)
        factorial *= k
        at_zero = substitute([current], {symbol(small): ZERO})[0]
        coefficients.append(mul(number(Fraction(1, factorial)), at_zero) if factorial > 1 else at_zero)
    return coefficients


def root(square: Expression, values: Mapping[str, float]) -> Expression:
    """sqrt(omega^2), with parameters that are positive by default taken as positive."""
    if square.is_number and square is ONE:
        return ONE
    import sympy

    positive = [name for name in symbols_in([square]) if values.get(name, 0.0) > 0]
    return from_sympy(sympy.sqrt(sympy.factor(to_sympy(square, positive))))


def simplest(formula: Expression, values: Mapping[str, float]) -> Expression:
    """The formula cancelled by computer algebra, with parameters that are positive by default taken as positive."""
    import sympy

    positive = [name for name in symbols_in([formula]) if values.get(name, 0.0) > 0]
    return from_sympy(sympy.cancel(sympy.together(to_sympy(formula, positive))))
