"""What drives an oscillator, along the turn of another one: waves and antiderivatives of pulses on its arcs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from contin.model.expression import ONE, ZERO, Expression, number
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.cut_turn import CutTurn, Quasi, product

Mean = Callable[[int, CutTurn], Complex]  # of the turn of a region
Driven = Callable[[int, CutTurn], tuple[Sequence[Quasi], Sequence[Quasi]]]


def mean_with(pieces: Sequence[Sequence[Quasi]], k: int) -> Mean:
    """<L exp(i k phi)>"""

    def mean(at: int, turn: CutTurn) -> Complex:
        return turn.mean(product(pieces[at], _wave(k, turn, ONE)))

    return mean


def driven_by_wave(k: int) -> Driven:
    """exp(i k phi)/(i k)"""
    inverse = number(Fraction(-1, k))

    def of(_: int, turn: CutTurn) -> tuple[Sequence[Quasi], Sequence[Quasi]]:
        return _wave(k, turn, ZERO, inverse), _wave(k, turn, ONE)

    return of


def driven_by_pulse(pieces: Sequence[Sequence[Quasi]]) -> Driven:
    """The zero-mean antiderivative."""

    def of(at: int, turn: CutTurn) -> tuple[Sequence[Quasi], Sequence[Quasi]]:
        return turn.antiderivative(pieces[at]), pieces[at]

    return of


def _wave(k: int, turn: CutTurn, re: Expression, im: Expression = ZERO) -> tuple[Quasi, ...]:
    """(re + i im) exp(i k phi) on every arc."""
    return tuple({(0, k): (re, im)} for _ in turn.arcs)
