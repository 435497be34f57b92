"""A model read as weakly nonlinear oscillators: x' = y + eps E, y' = -omega^2 x + eps F, one omega for all.

The pass needs the equations at eps = 0 to be exactly harmonic, and the frequencies to differ by order eps at most
(1:1 resonance); everything else is refused with the term that does not fit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    div,
    mask_of,
    mul,
    neg,
    number,
    sub,
    substitute,
    symbol,
    symbol_bit,
    symbols_in,
)
from contin.model.model import Model
from contin.model.parts import Oscillator
from contin.model.printing import to_text
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.sympy_bridge import from_sympy, to_sympy

NEAR: Final = 5.0  # a relative detuning up to this many times eps counts as of order eps
_SHOWN: Final = 90


@dataclass(frozen=True)
class WeakOscillators:
    """x_i' = y_i + eps E_i(x, y), y_i' = -omega^2 x_i + eps F_i(x, y), each as a power series in eps.

    `position[k][i]` and `velocity[k][i]` are the coefficients of eps^(k + 1) in the equations of oscillator i;
    `detuned` lists the oscillators whose own frequency was moved into F because it differs from omega by order eps.
    """

    model: Model
    small: str
    pairs: tuple[Oscillator, ...]
    omega: Expression
    position: tuple[tuple[Expression, ...], ...]
    velocity: tuple[tuple[Expression, ...], ...]
    detuned: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """Number of oscillators."""
        return len(self.pairs)

    @property
    def mask(self) -> int:
        """The bits of all states."""
        return mask_of(name for pair in self.pairs for name in (pair.position, pair.velocity))

    def members(self, term: Expression) -> tuple[int, ...]:
        """The oscillators whose states occur in a term."""
        return tuple(
            i
            for i, pair in enumerate(self.pairs)
            if term.mask & (symbol_bit(pair.position) | symbol_bit(pair.velocity))
        )


def weak_oscillators(model: Model, order: int = 1) -> WeakOscillators:
    """The oscillators that the model declares under `averaging:`, with their perturbations up to eps^order.

    Raises
    ------
    InputError
        The model declares none, is forced or has other states; a term of order 1 is not harmonic (the message quotes
        it); the frequencies are in another resonance than 1:1, or in none.
    """
    small, pairs = _declared(model)
    eps = symbol(small)
    equations = model.equation_map
    values = model.default_parameters()
    states = mask_of(model.state_names)
    squares = [_stiffness(model, pair, equations, eps, states, values) for pair in pairs]
    reference = squares[0]
    position = [_series(equations[p.position], small, order) for p in pairs]
    velocity = [_series(equations[p.velocity], small, order) for p in pairs]
    detuned = []
    for i, square in enumerate(squares):
        if not _equal(square, reference):
            _check_resonance(i, square, reference, values, small)
            detuned.append(i)
            shift = mul(div(sub(reference, square), eps), symbol(pairs[i].position))
            velocity[i][0] = add(velocity[i][0], shift)
    return WeakOscillators(
        model,
        small,
        pairs,
        _frequency(reference, values),
        tuple(zip(*position, strict=True)),
        tuple(zip(*velocity, strict=True)),
        tuple(detuned),
    )


def _declared(model: Model) -> tuple[str, tuple[Oscillator, ...]]:
    if not isinstance(model, Model):
        raise InputError("only a model of formulas can be averaged; this is a Python function: write its equations")
    averaging = model.averaging
    if averaging is None:
        raise InputError(
            f"model {model.name} declares no oscillators; to average it, add to its file\n"
            "averaging: {small: eps, oscillators: [{position: x, velocity: y}]}"
        )
    if model.kind != "flow" or model.forcing is not None or model.uses_time:
        what = "a map" if model.kind != "flow" else "forced"
        raise InputError(f"model {model.name} is {what}; averaging takes autonomous flows")
    used = {name for p in averaging.oscillators for name in (p.position, p.velocity)}
    others = [name for name in model.state_names if name not in used]
    if others:
        raise InputError(
            f"averaging model {model.name}: the state {others[0]} belongs to no oscillator; eliminate it first, "
            "or add the oscillator it belongs to under averaging: oscillators"
        )
    return averaging.small, averaging.oscillators


def _stiffness(
    model: Model,
    pair: Oscillator,
    equations: Mapping[str, Expression],
    eps: Expression,
    states: int,
    values: Mapping[str, float],
) -> Expression:
    """omega^2 of one oscillator at eps = 0."""
    x, y = pair.position, pair.velocity
    start = f"averaging model {model.name}: at {eps.value} = 0 the"
    rest = _excess(equations[x], eps, {y: ONE}, states)
    if rest:
        raise InputError(f"{start} equation of {x} must be {x}' = {y}; the term {rest} is left over")
    at_zero = substitute([equations[y]], {eps: ZERO})[0]
    square = add(*(neg(c) for c, t in additive_terms(at_zero, states) if t is symbol(x)))
    rest = _excess(equations[y], eps, {x: neg(square)}, states)
    if rest:
        raise InputError(
            f"{start} equation of {y} must be harmonic, {y}' = -omega^2 {x}; the term {rest} is left over. "
            f"If it is small, multiply it by {eps.value}"
        )
    size = evaluate(square, {**values, str(eps.value): 0.0})
    if not (math.isfinite(size) and size > 0):
        raise InputError(
            f"{start} equation of {y} must be harmonic, {y}' = -omega^2 {x} with omega^2 > 0; "
            f"omega^2 = {_short(square)} is {size:.6g} for the default parameters"
        )
    return square


def _excess(equation: Expression, eps: Expression, wanted: Mapping[str, Expression], states: int) -> str:
    """Text of the terms of `equation` at eps = 0 beyond those wanted; empty where there are none."""
    at_zero = substitute([equation], {eps: ZERO})[0]
    found = {t: c for c, t in additive_terms(at_zero, states)}
    for name, coefficient in wanted.items():
        left = sub(found.pop(symbol(name), ZERO), coefficient)
        if not is_zero(left):
            found[symbol(name)] = left
    left_over = [mul(c, t) for t, c in found.items() if not is_zero(c)]
    return _short(add(*left_over)) if left_over else ""


def _short(expression: Expression) -> str:
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


def _equal(a: Expression, b: Expression) -> bool:
    return a is b or is_zero(sub(a, b))


def _series(equation: Expression, small: str, order: int) -> list[Expression]:
    """Coefficients of eps^1 ... eps^order."""
    coefficients = []
    current, factorial = equation, 1
    for k in range(1, order + 1):
        current = derivative(current, small)
        factorial *= k
        at_zero = substitute([current], {symbol(small): ZERO})[0]
        coefficients.append(mul(number(Fraction(1, factorial)), at_zero) if factorial > 1 else at_zero)
    return coefficients


def _check_resonance(
    i: int, square: Expression, reference: Expression, values: Mapping[str, float], small: str
) -> None:
    own, first = (math.sqrt(evaluate(s, {**values, small: 0.0})) for s in (square, reference))
    eps = abs(values[small])
    if abs(own - first) <= NEAR * eps * first:
        return
    raise InputError(
        f"averaging: oscillators 1 and {i + 1} have the frequencies {first:.6g}, {own:.6g}: ratio {own / first:.6g} "
        "with the default parameters; only near-identical frequencies are averaged (1:1 resonance, difference of order "
        f"{small} = {eps:g}). If the difference is small, write it as {small} times a detuning"
    )


def _frequency(square: Expression, values: Mapping[str, float]) -> Expression:
    """omega = sqrt(omega^2), with parameters that are positive by default taken as positive."""
    if square.is_number and square is ONE:
        return ONE
    import sympy

    positive = [name for name in symbols_in([square]) if values.get(name, 0.0) > 0]
    return from_sympy(sympy.sqrt(sympy.factor(to_sympy(square, positive))))
