"""The frame in which a state, or an orbit, is looked for: where a rotation moves it, or an angle gains full turns."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Array
from contin.api.machine_code import compiled
from contin.model.model import Model
from contin.symbolic.passes import corotating
from contin.symbolic.passes.lifted import lifted
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.functions.turning_frame import in_frame


def frame_for(model: Any, u: Array, p: Array) -> tuple[Any, Array]:
    """The model in which the state u (n,) can be an equilibrium, and u in it."""
    if isinstance(model, FunctionProblem):
        found = in_frame(model, u[None], p)
        return (model, u) if found is None else (found[0], found[1][0])
    return corotating.frame_for(model, u, p)


def samples_in_frame(model: Any, states: Array, p: Array) -> tuple[Any, Array]:
    """The same for samples (K, n) of an orbit of a function; other models as they are."""
    if not isinstance(model, FunctionProblem):
        return model, states
    states = model.in_frame(states)
    found = in_frame(model, states, p)
    return (model, states) if found is None else found


def lift_for(model: Any, u: Array, p: Array, period: int) -> Any:
    """The lift of a map of angles in which the cycle of this length next to u gains no full turns; other models as are.

    A cycle that turns a number of times that its length does not divide has none.
    """
    if not isinstance(model, Model) or model.kind != "map":
        return model
    periods = model.periods(dict(zip(model.parameter_names, p.tolist(), strict=True)))
    if not periods.any():
        return model
    system, image = compiled(model), u
    for _ in range(period):
        image = system.value(image, p)
    turns = np.where(periods > 0.0, np.round((image - u) / np.where(periods > 0.0, periods, 1.0)), 0.0)
    if not np.isfinite(turns).all() or not turns.any() or np.any(turns % period):
        return model
    return lifted(model, tuple(int(k) for k in turns / period))
