"""What the kind of a model lets one ask of it, and what to do instead, in words."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Final

from contin.errors import InputError
from contin.model.expression import depends_on, postorder
from contin.model.parts import TIME
from contin.offers import offers

JUMPING: Final = frozenset({"floor", "ceil", "mod"})


def need_model(model: Any) -> None:
    """Raises InputError where a verb that takes a model gets its name, its file, a bare function or a result."""
    kind: type = type(model)
    if offers(kind, "start_point"):
        return
    if isinstance(model, (str, os.PathLike)):
        advice = f"load it first: contin.load({model!r})"
    elif isinstance(model, Mapping):
        advice = "load it first: contin.load(mapping)"
    elif offers(kind, "switch"):
        advice = "what is born at a labelled point is followed by contin.continuation(point.switch(), ...)"
    elif callable(model):
        advice = "make a model of a function first: contin.FunctionProblem(function, u0, parameters)"
    else:
        advice = "contin.load(...) and contin.FunctionProblem(...) make one"
    raise InputError(f"expected a model, got {kind.__name__}: {advice}")


def need_time(model: Any, what: str) -> None:
    """Raises InputError where a model has no motion in time: `what` names the verb's result, such as 'trajectories'."""
    kind = getattr(model, "kind", "flow")
    if kind == "algebraic":
        raise InputError(
            f"model {model.name!r} is algebraic (its equations vanish; there is no time), so it has no {what}: follow "
            "its solutions with `continuations:`, or contin.continuation(contin.equilibrium(model), ...)"
        )
    need_states(model, what)


def need_states(model: Any, what: str) -> None:
    """Raises InputError for a boundary-value problem, whose unknowns are functions."""
    if getattr(model, "kind", "flow") == "bvp":
        raise InputError(
            f"model {model.name!r} is a boundary-value problem, so it has no {what}: follow its solutions with "
            "`continuations:`, or contin.continuation(contin.boundary_problem(model), ...)"
        )


def need_autonomous(model: Any) -> None:
    """Raises InputError for what can be simulated only: a flow that uses the time without `forcing`, or no states."""
    name = repr(getattr(model, "name", "model"))
    need_no_events(model, "equilibria and diagrams")
    if getattr(model, "uses_time", False):
        raise InputError(
            f"model {name} uses the time t without `forcing`, so it can only be simulated (`contin simulate`, "
            "contin.simulate). For branches there are two ways out: declare `forcing: {period: ...}` where it is "
            "periodic in t, or replace t by a parameter (or by a state with an equation of its own)"
        )
    if getattr(model, "kind", "flow") == "flow" and has_steps(model):
        raise InputError(
            f"model {name} has floor, ceil or mod of a state or of the time: these jump, so it can only be simulated "
            "(`contin simulate`). For branches write the jump as a condition (u if c else v), or an angle with `period`"
        )
    if not getattr(model, "states", True):
        raise InputError(f"model {name} has no states, so it can only be simulated (`contin simulate`)")


def need_no_events(model: Any, what: str) -> None:
    """Raises InputError where states jump: `what` names what does not know of jumps."""
    if getattr(model, "events", ()):
        raise InputError(
            f"model {model.name!r} has `events`: it can be simulated (`contin simulate`, contin.simulate), and its "
            "periodic orbits be followed (`as: orbit` in a run, contin.periodic_orbit); "
            f"{what} do not know of jumps: leave `events` out where the solutions of interest meet none"
        )


def has_steps(model: Any) -> bool:
    """True where a step function of a state or of the time occurs in the equations."""
    moving = [*model.state_names, TIME]
    return any(node.op in JUMPING and depends_on(node, moving) for node in postorder(model.equations))
