"""Is a piecewise function of one oscillator odd or even under a half turn (x, y) -> (-x, -y)?

Decided arc by arc: the cuts half a turn apart must match, and the formulas, which are smooth, are sampled.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from contin.model.expression import ZERO, Expression
from contin.records import Fields
from contin.symbolic.averaging.cells import SAME, Arc
from contin.symbolic.averaging.switching_lines import X, Y
from contin.symbolic.calculus.sampling import sample

SAMPLES: Final = 40
ROUNDING: Final = 1e-12


def arcs_parity(arcs: Sequence[Arc], values: Mapping[str, float], reach: float) -> int:
    """-1 for an odd function, 1 for an even one, 0 otherwise; the function is 0 outside the arcs."""
    if not arcs:
        return 1
    if len(arcs) == 1 and arcs[0].stop.number - arcs[0].start.number > 2 * math.pi - SAME:
        pairs = [(arcs[0].formula, arcs[0].formula)]
    else:
        pairs = []
        for arc in arcs:
            partner = next((other for other in arcs if _opposite(arc, other)), None)
            if partner is None:
                return 0
            pairs.append((arc.formula, partner.formula))
    found = {_relation(here, there, values, reach) for here, there in pairs}
    return found.pop() if len(found) == 1 else 0


def _opposite(arc: Arc, other: Arc) -> bool:
    starts, stops = other.start.number - arc.start.number, other.stop.number - arc.stop.number
    return all(abs(math.remainder(gap - math.pi, 2 * math.pi)) < SAME for gap in (starts, stops))


def _relation(here: Expression, there: Expression, values: Mapping[str, float], reach: float) -> int:
    """s with there(-x, -y) = s here(x, y), at random points and parameters."""
    if here is ZERO and there is ZERO:
        return 1
    chance = np.random.default_rng(7)
    env: Fields = {n: v * chance.uniform(0.8, 1.2, SAMPLES) for n, v in values.items()}
    x, y = (chance.uniform(-reach, reach, SAMPLES) for _ in range(2))
    first = sample([here], {**env, X: x, Y: y})[0]
    second = sample([there], {**env, X: -x, Y: -y})[0]
    if not (np.all(np.isfinite(first)) and np.all(np.isfinite(second))):
        return 0
    size = ROUNDING * max(float(np.max(np.abs(first))), float(np.max(np.abs(second))), 1e-300)
    return next((sign for sign in (1, -1) if np.max(np.abs(second - sign * first)) <= size), 0)
