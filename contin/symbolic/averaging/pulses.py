"""Piecewise polynomial forces of one oscillator, taken apart for second-order averaging.

All the terms of one oscillator share the cuts of the turn, so that products of two of them are formulas on each arc.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.errors import InputError
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import (
    ONE,
    ZERO,
    Expression,
    add,
    call,
    compare,
    if_,
    mul,
    number,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.parts import Limit
from contin.symbolic.averaging.cells import RADIUS, Region, regions
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.cut_turn import CutTurn, Quasi, Rational, monomial, quasi
from contin.symbolic.averaging.radial import R, presumed
from contin.symbolic.averaging.resonant import state_powers
from contin.symbolic.averaging.switching_lines import PLANE, X, Y
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.calculus.sympy_bridge import from_sympy

VANISHES: Final = 1e-13  # of means of functions of size 1
JUMPS: Final = 1e-9  # relative to the values on both sides
IN_PLANE: Final = {X: (0, False), Y: (0, True)}


@dataclass(frozen=True)
class Pulse:
    """coefficient * number * r^d L(phi) (times exp(i theta) where h = 1): a term of a piecewise force of `source`.

    `pieces` are L on the arcs of each region of amplitudes, `jumps` the cuts where the whole force of the term jumps.
    """

    coefficient: Expression
    number: complex
    source: int
    d: int
    h: int
    pieces: tuple[tuple[Quasi, ...], ...]
    jumps: tuple[frozenset[int], ...]


@dataclass(frozen=True)
class PiecewiseTurn:
    """The regions of amplitude of one oscillator, and for each the turn with the formula of every term on its arcs."""

    found: tuple[Region, ...]
    turns: tuple[CutTurn, ...]
    formulas: Mapping[Expression, tuple[tuple[Expression, ...], ...]]
    values: Mapping[str, float]
    omega: Expression
    limits: tuple[Limit, ...]
    jumps: dict[Expression, tuple[frozenset[int], ...]] = field(default_factory=dict)

    @classmethod
    def of(
        cls, terms: Sequence[Expression], omega: Expression, values: Mapping[str, float], positive: tuple[str, ...]
    ) -> PiecewiseTurn:
        """The common turn of `terms`, functions of X and Y."""
        tags = [symbol(f"@tag{k}") for k in range(len(terms))]
        together = add(*(mul(tag, term) for tag, term in zip(tags, terms, strict=True)))
        found, order = regions(together, omega, values, positive)
        cut = [CutTurn.of(region) for region in found]
        formulas = {}
        for k, term in enumerate(terms):
            only = {tag: ONE if j == k else ZERO for j, tag in enumerate(tags)}
            formulas[term] = tuple(tuple(substitute(list(of), only)) for _, of in cut)
        limits = tuple(presumed(margin, words) for margin, words in order)
        made = cls(tuple(found), tuple(turn for turn, _ in cut), formulas, values, omega, limits)
        for term in terms:
            made.jumps[term] = tuple(made.jumping(term, k) for k in range(len(found)))
        return made

    def pulses(self, scale: Expression, unit: complex, term: Expression, source: int, h: int) -> list[Pulse]:
        """One term against exp(-i h phi)."""
        parts: dict[tuple[Expression, int], list[list[dict[tuple[int, int], Complex]]]] = {}
        shape = [len(turn.arcs) for turn in self.turns]
        for k, arcs in enumerate(self.formulas[term]):
            for j, formula in enumerate(arcs):
                for key, trig in _polynomial(formula, self.omega, h):
                    own = parts.setdefault(key, [[{} for _ in range(n)] for n in shape])
                    _accumulate(own[k][j], quasi(trig))
        return [
            Pulse(mul(scale, c), unit, source, d, h, tuple(tuple(region) for region in own), self.jumps[term])
            for (c, d), own in parts.items()
        ]

    def jumping(self, term: Expression, k: int) -> frozenset[int]:
        """The cuts of region k that move with the amplitude and where the term jumps, whatever its parameters are."""
        turn, formulas = self.turns[k], self.formulas[term][k]
        chance = np.random.default_rng(3)
        values = {n: v * (1 + 0.01 * chance.uniform()) + 0.003 * chance.uniform() for n, v in self.values.items()}
        low, high = self.found[k].numbers_at(values)
        values[RADIUS] = 0.5 * (low + high) if np.isfinite(high) else 1.7 * low + (1.0 if low == 0 else 0.0)
        found = set()
        for j, point in enumerate(turn.points[:-1]):
            if point.slope is ZERO:
                continue
            c, s = evaluate_all(point.unit, values)
            rate = float(evaluate(self.omega, values))
            at = {**values, X: values[RADIUS] * c, Y: -rate * values[RADIUS] * s}
            before, after = evaluate_all([formulas[j - 1], formulas[j]], at)
            if not abs(before - after) <= JUMPS * (abs(before) + abs(after)):
                found.add(j)
        return frozenset(found)

    def chained(self, of: Callable[[int], Complex]) -> list[tuple[Expression, complex, bool]]:
        """`of` the regions as (formula in R or 1, factor, is it not 0 in the first): a number where it is one."""
        each = [of(k) for k in range(len(self.turns))]
        parts: list[tuple[Expression, complex, bool]] = []
        for part, factor in ((0, 1.0), (1, 1j)):
            formulas = [value[part] for value in each]
            if len(formulas) == 1 and not formulas[0].mask:
                parts.append((ONE, factor * float(evaluate(formulas[0], {})), True))
                continue
            formulas = [ZERO if self.vanishes(f, k) else f for k, f in enumerate(formulas)]
            chain = formulas[-1]
            for region, formula in zip(reversed(self.found[:-1]), reversed(formulas[:-1]), strict=True):
                chain = if_(compare("<", R, from_sympy(region.high)), formula, chain)
            if any(f is not ZERO for f in formulas):
                parts.append((chain, factor, formulas[0] is not ZERO))
        return parts

    def vanishes(self, formula: Expression, k: int) -> bool:
        """True where it is 0 to rounding at sample amplitudes of region k."""
        low, high = self.found[k].numbers
        high = high if np.isfinite(high) else 2.0 * low + 1.0
        radii = [low + share * (high - low) for share in (0.13, 0.48, 0.91)]
        return all(abs(float(evaluate(formula, {**self.values, RADIUS: r}))) <= VANISHES for r in radii)

    def grazing(self, small: Expression) -> tuple[Limit, ...]:
        """Where an oscillation just reaches a threshold at which a force jumps, its correction is singular."""
        if not any(cuts for each in self.jumps.values() for cuts in each):
            return ()
        found = []
        for region in self.found[:-1]:
            level = from_sympy(region.high)
            margin = sub(call("abs", sub(R, level)), call("abs", mul(small, level)))
            found.append(Limit(margin, GRAZES))
        return tuple(found)


GRAZES: Final = (
    "the oscillation only just reaches a threshold at which a force jumps (closer than eps, relatively): its "
    "second-order average is singular there; average with `order: 1`"
)


def _polynomial(
    formula: Expression, omega: Expression, h: int
) -> list[tuple[tuple[Expression, int], dict[int, Rational]]]:
    found = []
    for coefficient, term in additive_terms(formula, PLANE):
        powers = {} if term is ONE else state_powers(term, IN_PLANE)
        if powers is None:
            raise InputError(
                "second-order averaging: forces must be polynomials, piece by piece; average with `order: 1`"
            )
        m, n = powers.get((0, False), 0), powers.get((0, True), 0)
        found.append(((mul(coefficient, power(omega, number(n))), m + n), monomial(m, n, h)))
    return found


def _accumulate(own: dict[tuple[int, int], Complex], more: Quasi) -> None:
    for key, (a, b) in more.items():
        re, im = own.get(key, (ZERO, ZERO))
        own[key] = (add(re, a), add(im, b))
