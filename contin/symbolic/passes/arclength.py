"""Pass: a flow with the arclength of its orbits as a last state."""

from __future__ import annotations

from contin.model.expression import ZERO, add, call, mul, neg
from contin.model.model import Model
from contin.model.parts import State


def with_arclength(model: Model, backward: bool = False) -> Model:
    """u' = f(u, p), s' = |f(u, p)|; `backward` in time: u' = -f(u, p).

    Nothing but states, parameters and equations is kept: lengths are in the states' own units.
    """
    name = "arclength"
    while name in (*model.state_names, *model.parameter_names):
        name += "_"
    speed = call("sqrt", add(*(mul(f, f) for f in model.equations)))
    equations = tuple(neg(f) for f in model.equations) if backward else model.equations
    return Model.from_parts(
        name=model.name, states=(*model.states, State(name, ZERO)), parameters=model.parameters,
        equations=(*equations, speed),
    )  # fmt: skip
