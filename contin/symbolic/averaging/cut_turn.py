"""Means over a turn that is cut at angles which are formulas in the amplitude: closed forms.

Forces are trigonometric polynomials sum c_k exp(i k phi) on every arc (`Trig`); their zero-mean antiderivatives are
sums of c phi^m exp(i k phi) (`Quasi`), continuous over the cuts.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Final

from contin.model.expression import (
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    call,
    mul,
    neg,
    number,
    numeric_value,
    postorder,
    power,
    rebuild,
    symbol,
)
from contin.symbolic.averaging.cells import RADIUS, Cut, Region
from contin.symbolic.averaging.complex_formulas import Complex, conjugate, plus, times, to_power
from contin.symbolic.calculus.derivatives import derivative
from contin.symbolic.calculus.sympy_bridge import from_sympy

Rational = tuple[Fraction, Fraction]
Trig = Mapping[int, Rational]
Quasi = Mapping[tuple[int, int], Complex]
R: Final = symbol(RADIUS)
NOTHING: Final[Complex] = (ZERO, ZERO)
GAP: Final = 1e-9  # angles closer than this are one
PER_TURN: Final = power(mul(number(2), PI), number(-1))


@dataclass(frozen=True)
class Point:
    """A cut: cos, sin and the angle as formulas in the amplitude `RADIUS` and the parameters, and the angle's slope."""

    unit: Complex
    angle: Expression
    slope: Expression

    @classmethod
    def of(cls, cut: Cut) -> Point:
        """A cut of `cells`."""
        angle = regular(from_sympy(cut.phi))
        slope = regular(derivative(angle, RADIUS))
        return cls((from_sympy(cut.cos), from_sympy(cut.sin)), angle, slope)

    def wave(self, m: int, k: int) -> Complex:
        """The integral of phi^m exp(i k phi), at this angle."""
        if k == 0:
            return mul(number(Fraction(1, m + 1)), power(self.angle, number(m + 1))), ZERO
        own = times(self.value(m, k), (ZERO, number(Fraction(-1, k))))
        if m == 0:
            return own
        return plus(own, times(self.wave(m - 1, k), (ZERO, number(Fraction(m, k)))))

    def value(self, m: int, k: int) -> Complex:
        """phi^m exp(i k phi)"""
        if self.unit[0].is_number and self.unit[1].is_number:
            turned = to_power(self.unit, abs(k))
            re, im = turned if k >= 0 else conjugate(turned)
        else:  # the angle keeps the quotients of thresholds and amplitudes in one place
            turn = mul(number(k), self.angle)
            re, im = (call("cos", turn), call("sin", turn)) if k else (ONE, ZERO)
        size = power(self.angle, number(m)) if m else ONE
        return mul(size, re), mul(size, im)

    def at(self, terms: Quasi) -> Complex:
        """The value of a sum."""
        return total(times(c, self.value(m, k)) for (m, k), c in terms.items())

    def integral(self, terms: Quasi) -> Complex:
        """The value of its antiderivative."""
        return total(times(c, self.wave(m, k)) for (m, k), c in terms.items())


@dataclass(frozen=True)
class CutTurn:
    """The turn between cuts; the last point is the first one a turn later."""

    points: tuple[Point, ...]

    @classmethod
    def of(cls, region: Region) -> tuple[CutTurn, tuple[Expression, ...]]:
        """The turn of a region, and the formula on each arc."""
        cuts: list[Cut] = []
        formulas: list[Expression] = []
        for arc in region.arcs:
            if cuts and arc.start.number - cuts[-1].number > GAP:
                cuts.append(arc.start)
                formulas.append(ZERO)
            elif not cuts:
                cuts.append(arc.start)
            cuts.append(arc.stop)
            formulas.append(arc.formula)
        points = [Point.of(cut) for cut in cuts]
        if cuts and cuts[-1].number - cuts[0].number < 2 * math.pi - GAP:
            first = points[0]
            points.append(Point(first.unit, add(first.angle, mul(number(2), PI)), first.slope))
            formulas.append(ZERO)
        return cls(tuple(points)), tuple(formulas)

    @cached_property
    def arcs(self) -> tuple[tuple[Point, Point], ...]:
        """Start and stop of each."""
        return tuple(pairwise(self.points))

    def mean(self, pieces: Sequence[Quasi]) -> Complex:
        """Average over the turn."""
        found = []
        for (a, b), terms in zip(self.arcs, pieces, strict=True):
            start, stop = a.integral(terms), b.integral(terms)
            found.append((add(stop[0], neg(start[0])), add(stop[1], neg(start[1]))))
        re, im = total(found)
        return mul(PER_TURN, re), mul(PER_TURN, im)

    def mean_product(self, pieces: Sequence[Quasi], others: Sequence[Quasi]) -> Complex:
        """<f g> - <f> <g>"""
        return plus(self.mean(product(pieces, others)), minus(times(self.mean(pieces), self.mean(others))))

    def antiderivative(self, pieces: Sequence[Quasi]) -> tuple[Quasi, ...]:
        """The continuous zero-mean K with dK/dphi = f - mean(f), f of trigonometric polynomials."""
        mean = self.mean(pieces)
        found: list[dict[tuple[int, int], Complex]] = []
        level: Complex = NOTHING
        for (a, b), terms in zip(self.arcs, pieces, strict=True):
            own: dict[tuple[int, int], Complex] = {}
            for (_, k), c in terms.items():
                if k:
                    own[(0, k)] = times(c, (ZERO, number(Fraction(-1, k))))
            constant = terms.get((0, 0), NOTHING)
            own[(1, 0)] = plus(constant, minus(mean))
            own[(0, 0)] = plus(level, minus(a.at(own)))
            found.append(own)
            level = b.at(own)
        offset = minus(self.mean(found))
        return tuple({**own, (0, 0): plus(own[(0, 0)], offset)} for own in found)

    def shifts(self, pieces: Sequence[Quasi], moved: Sequence[Quasi], jumps: frozenset[int]) -> Complex:
        """sum of (f_- - f_+) phi_k'(r) V(phi_k)/(2 pi) over the cuts where f jumps: d/dr of the cuts in <f V>."""
        found = []
        for k in sorted(jumps):
            point = self.points[k]
            if point.slope is ZERO:
                continue
            # cut 0 has the last arc before it, a turn later
            before = self.points[-1] if k == 0 else point
            step = plus(before.at(pieces[k - 1]), minus(point.at(pieces[k])))
            found.append(times((mul(point.slope, step[0]), mul(point.slope, step[1])), point.at(moved[k])))
        re, im = total(found)
        return mul(PER_TURN, re), mul(PER_TURN, im)


def regular(formula: Expression) -> Expression:
    """1/a of what is positive (the amplitude, roots) as (a^2)^(-1/2): no quotient that could be 0/0.

    These formulas hold away from such a point, and the search for removable singularities is long.
    """
    done: dict[Expression, Expression] = {}
    for node in postorder([formula]):
        new = rebuild(node, tuple(done[a] for a in node.args)) if node.args else node
        if new.op == "pow" and _is_positive(new.args[0]):
            exponent = numeric_value(new.args[1]) if new.args[1].is_number else 0
            if isinstance(exponent, Fraction) and exponent.denominator == 1 and exponent < 0:
                new = power(power(new.args[0], number(2)), number(exponent / 2))
        done[node] = new
    return done[formula]


def _is_positive(base: Expression) -> bool:
    if base.op == "mul":
        return all(_is_positive(factor) for factor in base.args)
    return base is R or base.op == "sqrt"


def total(parts: Iterable[Complex]) -> Complex:
    """The sum of complex formulas."""
    listed = list(parts)
    return add(*(p[0] for p in listed)), add(*(p[1] for p in listed))


def minus(a: Complex) -> Complex:
    """-a"""
    return neg(a[0]), neg(a[1])


def conjugated(pieces: Sequence[Quasi]) -> tuple[Quasi, ...]:
    """Arc by arc."""
    return tuple({(m, -k): conjugate(c) for (m, k), c in terms.items()} for terms in pieces)


def product(pieces: Sequence[Quasi], others: Sequence[Quasi]) -> tuple[Quasi, ...]:
    """Arc by arc."""
    found = []
    for one, other in zip(pieces, others, strict=True):
        own: dict[tuple[int, int], Complex] = {}
        for (m, k), c in one.items():
            for (n, j), d in other.items():
                key = (m + n, k + j)
                own[key] = plus(own.get(key, NOTHING), times(c, d))
        found.append(own)
    return tuple(found)


def monomial(m: int, n: int, h: int) -> dict[int, Rational]:
    """cos(phi)^m (-sin phi)^n exp(-i h phi)"""
    half, zero = Fraction(1, 2), Fraction(0)
    factors = [((half, zero), (half, zero))] * m + [((zero, half), (zero, -half))] * n
    found: dict[int, Rational] = {-h: (Fraction(1), zero)}
    for up, down in factors:
        raised: dict[int, Rational] = {}
        for k, (a, b) in found.items():
            for shift, (c, d) in ((1, up), (-1, down)):
                old = raised.get(k + shift, (zero, zero))
                raised[k + shift] = (old[0] + a * c - b * d, old[1] + a * d + b * c)
        found = raised
    return {k: c for k, c in found.items() if c != (zero, zero)}


def quasi(trig: Trig) -> Quasi:
    """A trigonometric polynomial as such a sum."""
    return {(0, k): (number(a), number(b)) for k, (a, b) in trig.items()}
