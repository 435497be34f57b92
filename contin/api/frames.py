"""The frame in which a state, or an orbit, is looked for, where the equations have a rotation that moves it."""

from __future__ import annotations

from typing import Any

from contin.abi import Array
from contin.symbolic.passes import corotating
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
    found = in_frame(model, states, p) if isinstance(model, FunctionProblem) else None
    return (model, states) if found is None else found
