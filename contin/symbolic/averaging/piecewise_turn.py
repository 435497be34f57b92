"""The common turn of several oscillators, cut where conditions linear in their states change sign.

A linear condition a.x + b.y + c > 0 is D cos(tau + delta) > -c: true on one arc of the turn, whose ends are formulas in
the amplitudes (empty or everything where |c| > D). Conditions nest: the arc of each is intersected with the arcs on
which it is asked, by min and max, so the order of the cuts need not be known.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from contin.errors import InputError
from contin.model.expression import (
    COMPARISONS,
    ONE,
    PI,
    ZERO,
    Expression,
    add,
    call,
    mul,
    number,
    postorder,
    power,
    sub,
    substitute,
    symbol,
)
from contin.model.printing import to_text
from contin.symbolic.averaging.complex_formulas import Complex, to_power
from contin.symbolic.averaging.gauss_rule import gauss
from contin.symbolic.averaging.terms import additive_terms
from contin.symbolic.averaging.weak import WeakOscillators

TWO_PI = mul(number(2), PI)


@dataclass(frozen=True)
class Turn:
    """x_j = u_j cos(h tau) - v_j sin(h tau), y_j = -h omega (u_j sin(h tau) + v_j cos(h tau)) for those in
    `amplitudes`, h their harmonics."""

    oscillators: WeakOscillators
    omega: Expression
    amplitudes: Mapping[int, Complex]

    def at(self, term: Expression, cos: Expression, sin: Expression) -> Expression:
        """The term at cos(tau), sin(tau)."""
        mapping = {}
        for i, (u, v) in self.amplitudes.items():
            pair = self.oscillators.turning[i]
            c, s = multiple(cos, sin, pair.harmonic)
            mapping[symbol(pair.position)] = sub(mul(c, u), mul(s, v))
            rate = mul(number(-pair.harmonic), self.omega)
            mapping[symbol(pair.velocity)] = mul(rate, add(mul(s, u), mul(c, v)))
        return substitute([term], mapping)[0]

    def harmonic(self, coefficients: Mapping[int, tuple[Expression, Expression]]) -> Complex:
        """sum a_j x_j + b_j y_j = p cos(h tau) + q sin(h tau): (p, q), where all have the harmonic h."""
        p, q = [], []
        for i, (a, b) in coefficients.items():
            u, v = self.amplitudes[i]
            rate = self.oscillators.frequency(i)
            p += [mul(a, u), mul(number(-1), b, rate, v)]
            q += [mul(number(-1), a, v), mul(number(-1), b, rate, u)]
        return add(*p), add(*q)


Interval = tuple[Expression, Expression]


def pieces_of_turn(term: Expression, turn: Turn) -> list[tuple[Interval, Expression]]:
    """The arcs of the turn, whose ends are formulas in the amplitudes, and the smooth formula on each."""
    return _pieces(term, (ZERO, TWO_PI), turn)


def multiple(cos: Expression, sin: Expression, harmonic: int) -> Complex:
    """cos and sin of `harmonic` times the angle."""
    return (cos, sin) if harmonic == 1 else to_power((cos, sin), harmonic)


def piecewise_rule(term: Expression, turn: Turn, n: int, harmonic: int = 1) -> Complex:
    """<term exp(-i harmonic tau)> with n Gauss nodes on every arc."""
    total: tuple[list[Expression], list[Expression]] = ([], [])
    for interval, formula in pieces_of_turn(term, turn):
        re, im = _on(interval, formula, turn, n, harmonic)
        total[0].append(re)
        total[1].append(im)
    return add(*total[0]), add(*total[1])


def _pieces(term: Expression, interval: Interval, turn: Turn) -> list[tuple[Interval, Expression]]:
    """The arcs inside `interval` and the smooth formula on each."""
    mask = turn.oscillators.mask
    comparison = next((n for n in postorder([term]) if n.op in COMPARISONS and n.mask & mask), None)
    if comparison is None:
        return [] if term is ZERO else [(interval, term)]
    pieces = []
    inside, outside = _arcs(comparison, turn)
    for arcs, truth in ((inside, ONE), (outside, ZERO)):
        formula = substitute([term], {comparison: truth})[0]
        if formula is ZERO:
            continue
        for arc in arcs:
            for shift in (-1, 0, 1):
                low = add(arc[0], mul(number(shift), TWO_PI))
                high = add(arc[1], mul(number(shift), TWO_PI))
                cut = _intersection((low, high), interval)
                pieces += _pieces(formula, cut, turn)
    return pieces


def _intersection(a: Interval, b: Interval) -> Interval:
    low = call("max", a[0], b[0])
    return low, call("max", low, call("min", a[1], b[1]))


def _arcs(comparison: Expression, turn: Turn) -> tuple[list[Interval], list[Interval]]:
    """Arcs within one turn on which a linear comparison holds, and those on which it does not."""
    found = linear_in_turning(sub(*comparison.args), turn.oscillators)
    if found is None:
        raise InputError(
            f"averaging: cannot locate where the condition {to_text(comparison)} changes sign along an oscillation;"
            " conditions on several oscillators must be linear in their states"
        )
    coefficients, constant = found
    found_harmonics = {turn.oscillators.harmonics[i] for i in coefficients}
    if len(found_harmonics) != 1:
        raise InputError(
            f"averaging: the condition {to_text(comparison)} compares oscillators of different frequencies; "
            "conditions are averaged where they are of one frequency"
        )
    (h,) = found_harmonics
    p, q = turn.harmonic(coefficients)
    size = call("sqrt", add(power(p, number(2)), power(q, number(2))))
    angle = call("atan2", q, p)  # p cos tau + q sin tau = size cos(tau - angle)
    if constant is ZERO:
        half: Expression = mul(number(0.5), PI)
    else:
        level = mul(number(-1), constant, power(size, number(-1)))
        half = call("acos", call("max", number(-1), call("min", ONE, level)))
    upper = _repeated((sub(angle, half), add(angle, half)), h)
    lower = _repeated((add(angle, half), add(sub(angle, half), TWO_PI)), h)
    if comparison.op in (">", ">="):
        return upper, lower
    if comparison.op in ("<", "<="):
        return lower, upper
    everything = (ZERO, TWO_PI)  # an equality holds at single instants
    return ([], [everything]) if comparison.op == "==" else ([everything], [])


def linear_in_turning(
    formula: Expression, oscillators: WeakOscillators
) -> tuple[dict[int, tuple[Expression, Expression]], Expression] | None:
    """{j: (a_j, b_j)}, c of a formula sum a_j x_j + b_j y_j + c; None for any other."""
    coefficients: dict[int, tuple[Expression, Expression]] = {}
    constant: Expression = ZERO
    places = oscillators.places()
    for c, t in additive_terms(formula, oscillators.mask):
        if t is ONE:
            constant = c
        elif t.op == "symbol":
            j, is_velocity = places[str(t.value)]
            a, b = coefficients.get(j, (ZERO, ZERO))
            coefficients[j] = (a, add(b, c)) if is_velocity else (add(a, c), b)
        else:
            return None
    return coefficients, constant


def _repeated(arc: Interval, h: int) -> list[Interval]:
    """The arc of h tau as arcs of tau."""
    if h == 1:
        return [arc]
    share = number(Fraction(1, h))
    low, high = arc
    return [
        (mul(share, add(low, mul(number(k), TWO_PI))), mul(share, add(high, mul(number(k), TWO_PI)))) for k in range(h)
    ]


def _on(interval: Interval, formula: Expression, turn: Turn, n: int, harmonic: int) -> Complex:
    low, high = interval
    middle, half = mul(number(0.5), add(low, high)), mul(number(0.5), sub(high, low))
    nodes, weights = gauss(n)
    re, im = [], []
    for xi, w in zip(nodes, weights, strict=True):
        tau = add(middle, mul(number(float(xi)), half))
        cos, sin = call("cos", tau), call("sin", tau)
        value = turn.at(formula, cos, sin)
        factor = mul(number(float(w)), half, power(TWO_PI, number(-1)))
        cos, sin = (ONE, ZERO) if harmonic == 0 else multiple(cos, sin, harmonic)
        re.append(mul(factor, value, cos))
        im.append(mul(number(-1), factor, value, sin))
    return add(*re), add(*im)
