"""Averages of functions of several oscillators that have no closed form: fixed rules over the common turn tau.

    <f(x(tau), y(tau)) exp(-i tau)>,   x_j = u_j cos tau - v_j sin tau,   y_j = -omega (u_j sin tau + v_j cos tau)

Smooth functions take equidistant nodes. Where conditions are linear in the states, the turn is cut where they change
sign, and each piece takes a Gauss rule; the cuts are formulas in the amplitudes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from contin.machine import elementary
from contin.model.expression import COMPARISONS, ZERO, Expression, add, call, mul, number, postorder, power, symbol
from contin.model.parts import Limit
from contin.symbolic.averaging.cells import SAME
from contin.symbolic.averaging.complex_formulas import Complex
from contin.symbolic.averaging.gauss_rule import ACCURACY, Array, agreement, beyond_quadrature, next_size
from contin.symbolic.averaging.piecewise_turn import Turn, pieces_of_turn, piecewise_rule
from contin.symbolic.averaging.radial import Setting, first_size
from contin.symbolic.averaging.rule_values import COS, SIN, Segment, arc_values, turn_values
from contin.symbolic.averaging.terms import factors_apart, without_kinks
from contin.symbolic.averaging.weak import WeakOscillators
from contin.symbolic.calculus.guards import is_guard

Amplitudes = Sequence[Complex]  # u_j + i v_j


def shared_average(
    term: Expression, oscillators: WeakOscillators, setting: Setting, amplitudes: Amplitudes, harmonic: int = 1
) -> Complex:
    """Real and imaginary part of <term exp(-i harmonic tau)> as formulas in the given amplitudes, phasors' included."""
    shared = _Shared(_plain(term, oscillators), oscillators, setting, harmonic)
    n = shared.size()
    return (ZERO, ZERO) if shared.vanishes(n) else shared.rule(n, amplitudes)


def shared_limit(
    term: Expression, oscillators: WeakOscillators, setting: Setting, amplitudes: Amplitudes, harmonic: int = 1
) -> Limit:
    """Where `shared_average` is accurate: its rule against the next one, beside the mean square of the term."""
    term = _plain(term, oscillators)
    shared = _Shared(term, oscillators, setting, harmonic)
    n = shared.size()
    square = _Shared(power(term, number(2)), oscillators, setting).mean(n, amplitudes)
    margin = agreement(shared.rule(n, amplitudes), shared.rule(next_size(n), amplitudes), square)
    return Limit(margin, beyond_quadrature(n), ACCURACY)


def _plain(term: Expression, oscillators: WeakOscillators) -> Expression:
    return factors_apart(without_kinks(term, oscillators.mask), oscillators.mask)


@dataclass(frozen=True)
class _Shared:
    """The rules for one term."""

    term: Expression
    oscillators: WeakOscillators
    setting: Setting
    harmonic: int = 1

    def turn(self, amplitudes: Amplitudes) -> Turn:
        """The common turn of the oscillators in the term."""
        members = self.oscillators.members(self.term)
        return Turn(self.oscillators, self.setting.omega, {i: amplitudes[i] for i in members})

    def rule(self, n: int, amplitudes: Amplitudes) -> Complex:
        """<term exp(-i tau)> with n nodes on an arc."""
        turn = self.turn(amplitudes)
        if has_conditions(self.term, self.oscillators.mask):
            return piecewise_rule(self.term, turn, n, self.harmonic)
        return _smooth_rule(self.term, turn, 2 * n, self.harmonic)

    def mean(self, n: int, amplitudes: Amplitudes) -> Expression:
        """<term>: equidistant nodes are enough for a size."""
        nodes = [(k + 0.5) * math.pi / n for k in range(2 * n)]
        turn = self.turn(amplitudes)
        values = (turn.at(self.term, number(elementary.cos(tau)), number(elementary.sin(tau))) for tau in nodes)
        return mul(number(0.5 / n), add(*values))

    def means(self) -> tuple[Callable[[int, Mapping[str, float]], Array], float]:
        """Values of the rules of a size at random amplitudes, (2, 12), and the mean size of the term there."""
        trial = [(symbol(f"@u{i}"), symbol(f"@v{i}")) for i in range(len(self.oscillators.turning))]
        used = {i: trial[i] for i in self.oscillators.members(self.term)}
        turn = self.turn(trial)
        if has_conditions(self.term, self.oscillators.mask):
            pieces = pieces_of_turn(self.term, turn)
            segments = [Segment(*interval, turn.at(formula, COS, SIN)) for interval, formula in pieces]
            rule = partial(arc_values, segments, harmonic=self.harmonic)
        else:
            rule = partial(turn_values, turn.at(self.term, COS, SIN), harmonic=self.harmonic)
        size = turn_values(
            call("abs", turn.at(self.term, COS, SIN)), 32, self.samples(used, self.setting.values), harmonic=0
        )
        return lambda n, values: rule(n, self.samples(used, values)), float(np.max(size))

    def size(self) -> int:
        """The size of an accurate rule: at random amplitudes, and at the ends of the parameters' ranges if it can."""
        means, size_of = self.means()

        def values(size: int, corners: Sequence[Mapping[str, float]]) -> Array:
            return np.hstack([means(size, corner) for corner in corners])

        return first_size(values, self.setting.towards_corners(), size_of)

    def vanishes(self, n: int) -> bool:
        """True where the mean is 0 at all the amplitudes, to rounding: the term has a symmetry."""
        means, size_of = self.means()
        return float(np.max(np.abs(means(n, self.setting.values)))) <= 1e-14 * size_of

    def samples(self, trial: Mapping[int, Complex], values: Mapping[str, float]) -> dict[str, Array | float]:
        """Random amplitudes of the expected size, the same ones every time; phasors have the size 1."""
        chance = np.random.default_rng(11)
        env: dict[str, Array | float] = dict(values)
        for i, (u, v) in trial.items():
            radius = self.setting.reach * np.sqrt(chance.uniform(0.01, 1.0, 12)) / 2
            angle = chance.uniform(0, 2 * math.pi, 12)
            if i >= self.oscillators.count:
                radius = np.ones(12)
            env[str(u.value)], env[str(v.value)] = radius * elementary.cos(angle), radius * elementary.sin(angle)
        return env


def has_conditions(term: Expression, mask: int) -> bool:
    """True where a condition on the states chooses the formula."""
    return any(n.op in COMPARISONS and n.mask & mask and not is_guard(n) for n in postorder([term]))


def _smooth_rule(term: Expression, turn: Turn, n: int, harmonic: int) -> Complex:
    re, im = [], []
    for k in range(n):
        tau = (k + 0.5) * 2 * math.pi / n
        c, s = elementary.cos(tau), elementary.sin(tau)
        c, s = (0.0 if abs(t) < SAME else t for t in (c, s))
        value = turn.at(term, number(c), number(s))
        if harmonic != 1:
            c, s = elementary.cos(harmonic * tau), elementary.sin(harmonic * tau)
        re.append(mul(number(c / n), value))
        im.append(mul(number(-s / n), value))
    return add(*re), add(*im)
