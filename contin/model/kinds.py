"""What the kind of a model lets one ask of it, and what to do instead, in words."""

from __future__ import annotations

from typing import Any

from contin.errors import InputError


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
    if getattr(model, "uses_time", False):
        raise InputError(
            f"model {name} uses the time t without `forcing`, so it can only be simulated (`contin simulate`, "
            "contin.simulate). For branches there are two ways out: declare `forcing: {period: ...}` where it is "
            "periodic in t, or replace t by a parameter (or by a state with an equation of its own)"
        )
    if not getattr(model, "states", True):
        raise InputError(f"model {name} has no states, so it can only be simulated (`contin simulate`)")
