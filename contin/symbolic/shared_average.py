"""Averages of functions of several oscillators that have no closed form: fixed rules over the common turn tau.

    <f(x(tau), y(tau)) exp(-i tau)>,   x_j = u_j cos tau - v_j sin tau,   y_j = -omega (u_j sin tau + v_j cos tau)

Smooth functions take equidistant nodes. Where conditions are linear in the states, the turn is cut where they change
sign, and each piece takes a Gauss rule; the cuts are formulas in the amplitudes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from contin.model.expression import Expression, add, mul, number, symbol
from contin.symbolic.cells import SAME
from contin.symbolic.complex_formulas import Complex
from contin.symbolic.gauss_rule import Array, rule_size
from contin.symbolic.oscillators import WeakOscillators
from contin.symbolic.piecewise_turn import Turn, piecewise_rule
from contin.symbolic.radial import Setting
from contin.symbolic.sampling import sample
from contin.symbolic.terms import without_kinks

Amplitudes = Sequence[Complex]  # u_j + i v_j


def shared_average(term: Expression, oscillators: WeakOscillators, setting: Setting, amplitudes: Amplitudes) -> Complex:
    """Real and imaginary part of <term exp(-i tau)> as formulas in the given amplitudes."""
    term = without_kinks(term, oscillators.mask)
    members = oscillators.members(term)
    trial = {i: (symbol(f"@u{i}"), symbol(f"@v{i}")) for i in members}
    env = _samples(trial, setting)
    piecewise = has_conditions(term, oscillators.mask)

    def rule(n: int, at: Mapping[int, Complex]) -> Complex:
        turn = Turn(oscillators, setting.omega, at)
        return piecewise_rule(term, turn, n) if piecewise else _smooth_rule(term, turn, 2 * n)

    n = rule_size(lambda size: np.array(sample(rule(size, trial), env)))
    return rule(n, {i: amplitudes[i] for i in members})


def has_conditions(term: Expression, mask: int) -> bool:
    """True where a condition on the states chooses the formula."""
    from contin.model.expression import COMPARISONS, postorder
    from contin.symbolic.guards import is_guard

    return any(n.op in COMPARISONS and n.mask & mask and not is_guard(n) for n in postorder([term]))


def _samples(trial: Mapping[int, Complex], setting: Setting) -> dict[str, Array | float]:
    """Random amplitudes of the expected size, the same ones every time."""
    chance = np.random.default_rng(11)
    env: dict[str, Array | float] = dict(setting.values)
    for u, v in trial.values():
        radius = setting.reach * np.sqrt(chance.uniform(0.01, 1.0, 12)) / 2
        angle = chance.uniform(0, 2 * math.pi, 12)
        env[str(u.value)], env[str(v.value)] = radius * np.cos(angle), radius * np.sin(angle)
    return env


def _smooth_rule(term: Expression, turn: Turn, n: int) -> Complex:
    re, im = [], []
    for k in range(n):
        tau = (k + 0.5) * 2 * math.pi / n
        c, s = math.cos(tau), math.sin(tau)
        c, s = (0.0 if abs(t) < SAME else t for t in (c, s))
        value = turn.at(term, number(c), number(s))
        re.append(mul(number(c / n), value))
        im.append(mul(number(-s / n), value))
    return add(*re), add(*im)
