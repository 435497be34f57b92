"""Maps of angles lifted to the line such that fixed points that turn stand still.

A map of angles is known up to whole periods P: f and f - k P are the same map, lifted to the line in two ways. A fixed
point modulo P that gains k turns in an iteration, f(u) = u + k P, is a fixed point of f - k P, with the same
multipliers (Katok and Hasselblatt, Introduction to the Modern Theory of Dynamical Systems, sec. 11.1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.model.evaluate import evaluate_all
from contin.model.expression import mul, number, sub
from contin.model.kept import kept_with
from contin.symbolic.passes.holding import holds

if TYPE_CHECKING:
    from contin.model.model import Model

ANYWHERE: Final = 0.5  # where all states have this value two lifts differ by their turns, as they do everywhere


def lifted(model: Model, turns: tuple[int, ...]) -> Model:
    """The same map with `turns` (n,) periods taken from the images of its angles; states keep their names."""
    known: dict[tuple[int, ...], Model] = kept_with(model, "lifts", dict)
    if turns not in known:
        known[turns] = _lifted(model, turns)
    return known[turns]


def _lifted(model: Model, turns: tuple[int, ...]) -> Model:
    equations = tuple(
        f if k == 0 or state.period is None else sub(f, mul(number(float(k)), state.period))
        for f, state, k in zip(model.equations, model.states, turns, strict=True)
    )
    result = model.replace(equations=equations)
    return result.replace(symmetries=tuple(s for s in model.symmetries if holds(result, s)))


def is_lift(other: Model, model: Model) -> bool:
    """True where the other model is one of this one's lifts."""
    if model.kind != "map" or other.state_names != model.state_names or not model.periods().any():
        return False
    values = {**model.default_parameters(), **dict.fromkeys(model.state_names, ANYWHERE)}
    gained = np.array(evaluate_all([*model.equations], values)) - np.array(evaluate_all([*other.equations], values))
    periods = model.periods()
    turns = np.where(periods > 0.0, np.round(gained / np.where(periods > 0.0, periods, 1.0)), 0.0)
    if not np.isfinite(turns).all():
        return False
    return lifted(model, tuple(int(k) for k in turns)).equations == other.equations
