"""Families whose first node comes to a switching surface: that is no corner of theirs."""

from __future__ import annotations

from math import exp

import numpy as np
import pytest
from scipy.optimize import brentq

import contin
from contin.model.model import Model

RATE = 0.5
TIMES = np.logspace(-7, 2, 2000)
DECAY = {rate: np.exp(-rate * TIMES) for rate in (RATE, 1.0, RATE + 1.0, 2.0)}


def flown(T: float, S: float, mixing: float, e: float) -> tuple[float, float, float]:
    """Time and place at which S - T = e again: T' = 1 - (1 + k) T, S' = RATE - (RATE + k) S, k = `mixing`."""
    rest = 1.0 / (1.0 + mixing), RATE / (RATE + mixing)

    def at(t: float) -> tuple[float, float]:
        decay = exp(-(1.0 + mixing) * t), exp(-(RATE + mixing) * t)
        return rest[0] + (T - rest[0]) * decay[0], rest[1] + (S - rest[1]) * decay[1]

    def height(t: float) -> float:
        there = at(t)
        return float(there[1] - there[0] - e)

    heights = (rest[1] - rest[0] - e) + (S - rest[1]) * DECAY[RATE + mixing] - (T - rest[0]) * DECAY[1.0 + mixing]
    away = heights * (1.0 if mixing else -1.0) > 0.0
    first = int(np.argmax(away))
    back = first + int(np.argmin(away[first:]))
    t = float(brentq(height, TIMES[back - 1], TIMES[back], xtol=1e-15))
    return t, *at(t)


def period(e: float) -> float:
    """Of Welander's flip-flop (Tellus 34 (1982) 231), by its return map, whose multiplier is .03 or less."""
    T, total = 1.0 + 0.2 * e, 0.0
    for _ in range(40):
        above, T1, S1 = flown(T, T + e, 1.0, e)
        below, T, _ = flown(T1, S1, 0.0, e)
        total = above + below
    return total


@pytest.mark.seldom
def test_a_flip_flop_is_followed_to_where_it_vanishes():
    """Mixing where S - T > e. At e = 0 the cycle has shrunk to the point (1, 1).

    A row at e = -5.2e-4 had the period 3.532 for 3.525 and no multiplier 1; the family ended there.
    """
    model = Model(
        "flip-flop", states={"T": 0.7, "S": 0.5}, parameters={"e": -0.05},
        definitions={"k": "1 if S - T > e else 0"},
        equations={"T": "1 - T - k*T", "S": f"{RATE}*(1 - S) - k*S"},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(model, {"T": 0.7, "S": 0.5}), "e", (-0.1, 0.1))
    e, found = family.columns["e"], family.columns["period"]
    assert e.max() > -2e-4
    away = np.flatnonzero(e < -2e-4)
    for row in [*away[:: max(1, len(away) // 25)].tolist(), int(away[-1])]:
        assert found[row] == pytest.approx(period(float(e[row])), rel=1e-8)
