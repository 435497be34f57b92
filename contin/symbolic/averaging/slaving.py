"""Linear states that oscillators drive and that decay fast (a platform with its spring and damper): they follow.

    W' = L W + sum_j (p_j x_j + q_j y_j) + k + O(eps)    gives    W = sum_j (alpha_j x_j + beta_j y_j) + W_0 + O(eps),
    (L^2 + w_j^2) beta_j = -(p_j + L q_j),   alpha_j = L beta_j + q_j,   W_0 = -L^-1 k,

with w_j the frequency of the oscillator (or phasor) j: the response at that frequency. It attracts where all
eigenvalues of L have negative real parts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.expression import ONE, ZERO, Expression, add, mask_of, mul, substitute, symbol, symbols_in
from contin.model.parts import Limit, Oscillator
from contin.symbolic.averaging.reading import short
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.calculus.sympy_bridge import from_sympy, to_sympy

if TYPE_CHECKING:
    from contin.records import Sympy

BEYOND = (
    "the states under `slaved:` follow the oscillators only while their own linear system is damped; beyond, "
    "average with them as oscillators"
)


@dataclass(frozen=True)
class Slaved:
    """Each slaved state as a formula in what turns (and slow states), and where that holds."""

    states: Mapping[str, Expression]
    limits: tuple[Limit, ...]


def follow(
    names: Sequence[str],
    equations: Mapping[str, Expression],
    turning: Sequence[Oscillator],
    frequency: Callable[[int], Expression],
    small: str,
    values: Mapping[str, float],
) -> Slaved:
    """The slaved states `names`.

    values : of parameters and slow states, at which the system must be damped faster than eps.

    Raises
    ------
    InputError
        An equation is not linear in the slaved states and in what turns, or the system is not damped; in words.
    """
    import sympy

    inside = mask_of([*names, *(n for pair in turning for n in (pair.position, pair.velocity))])
    rows = {name: _linear(name, equations[name], small, inside) for name in names}
    positive = [n for n in symbols_in([c for row in rows.values() for c in row.values()]) if values.get(n, 0.0) > 0]

    def column(of: Expression) -> Sympy:
        return sympy.Matrix([to_sympy(rows[name].get(of, ZERO), positive) for name in names])

    matrix = sympy.Matrix.hstack(*(column(symbol(name)) for name in names))
    _check_decay(names, rows, small, values)
    found: dict[str, list[Expression]] = {name: [] for name in names}
    for j, pair in enumerate(turning):
        x, y = symbol(pair.position), symbol(pair.velocity)
        p, q = column(x), column(y)
        if p.is_zero_matrix and q.is_zero_matrix:
            continue
        square = to_sympy(frequency(j), positive) ** 2
        beta = (matrix**2 + square * sympy.eye(len(names))).LUsolve(-(p + matrix * q)).applyfunc(sympy.cancel)
        alpha = (matrix * beta + q).applyfunc(sympy.cancel)
        for name, a, b in zip(names, alpha, beta, strict=True):
            found[name] += [mul(from_sympy(a), x), mul(from_sympy(b), y)]
    steady = column(ONE)
    if not steady.is_zero_matrix:
        for name, value in zip(names, matrix.LUsolve(-steady).applyfunc(sympy.cancel), strict=True):
            found[name].append(from_sympy(value))
    return Slaved({name: add(*terms) for name, terms in found.items()}, _damped(matrix))


def _linear(name: str, equation: Expression, small: str, inside: int) -> dict[Expression, Expression]:
    """{state or ONE: coefficient} of an equation at eps = 0."""
    row: dict[Expression, Expression] = {}
    for c, t in additive_terms(substitute([equation], {symbol(small): ZERO})[0], inside):
        if t is not ONE and t.op != "symbol":
            raise InputError(
                f"averaging: the slaved state {name} must be linear in the slaved states and the oscillators at "
                f"{small} = 0; the term {short(mul(c, t))} is not. Multiply it by {small}, or write "
                f"{name} as an oscillator"
            )
        row[t] = c
    return row


def _check_decay(
    names: Sequence[str], rows: Mapping[str, Mapping[Expression, Expression]], small: str, values: Mapping[str, float]
) -> None:
    at = {**values, small: 0.0}
    matrix = [[float(evaluate(rows[a].get(symbol(b), ZERO), at)) for b in names] for a in names]
    slowest = 0.0 - float(np.max(np.linalg.eigvals(np.array(matrix)).real))
    if not slowest > abs(values[small]):
        raise InputError(
            f"averaging: the slaved states {', '.join(names)} decay at the rate {slowest:.6g} for the default "
            f"parameters, which is no faster than {small} = {values[small]:g}: they do not follow the oscillators. "
            "Declare them as an oscillator or as slow"
        )


def _damped(matrix: Sympy) -> tuple[Limit, ...]:
    """Hurwitz's conditions for up to three states, as margins."""
    size = matrix.shape[0]
    rest = matrix.charpoly().all_coeffs()[1:] if size <= 3 else []
    margins = list(rest)
    if size == 3:
        margins = [rest[0], rest[2], rest[0] * rest[1] - rest[2]]
    return tuple(Limit(from_sympy(m), BEYOND) for m in margins if m.free_symbols)
