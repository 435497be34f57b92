"""Equilibria at fixed parameters, where branches may start."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.api.fixed_totals import for_branches, is_auto, named_start
from contin.api.frames import frame_for, lift_for
from contin.api.machine_code import compiled
from contin.api.requirements import need_parameters, refuse_forced
from contin.errors import InputError, NotFiniteError
from contin.lazy import module
from contin.machine.one_thread import one_thread
from contin.model.kinds import need_model, need_states
from contin.problems.sparse.from_model import sparse_function
from contin.records import Record
from contin.search.equilibrium_from_guess import converge
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.iterate import iterate

DENSE_UP_TO = 1000  # states of maps


@one_thread
def equilibrium(
    model: Any,
    start: str | Record | None = None,
    parameters: Record | None = None,
    *,
    period: int = 1,
) -> Any:
    """Solve f(u, p) = 0 (a map: f(u, p) = u) by Newton from a named start, a mapping of states, or the states' values.

    start : 'auto' finds one however far the states' values are from it: see `contin.find_start`, which says how.

    Where linear conserved quantities exist, the solution is that with the start's totals: they are parameters, named
    total_A, and one state of each is eliminated (`contin.symbolic.passes.conserved`).

    period : of a cycle of a map: f(...f(f(u, p), p)..., p) = u. Angles are equal modulo their period: what the start
        gains, in full turns to the nearest one, its solution gains.

    In a model that declares a rotation, a start that it moves leads to a rotating wave (relative equilibrium);
    it is solved, and continued, in the frame that turns with it (`contin.symbolic.passes.corotating`; of functions,
    `contin.systems.functions.turning_frame`).

    Raises NoSolutionError (with the residual history and the nearest point) and NotFiniteError (naming the equation).
    """
    need_model(model)
    refuse_forced(model)
    if is_auto(model, start) and period == 1:
        return module("auto start").find_start(model, parameters, cycles=False).solution
    need_states(model, "equilibria")
    start, model = named_start(model, start), for_branches(model)
    need_parameters(model)
    u, p = model.start_point(start, dict(parameters or {}))
    model, u = frame_for(model, u, p)
    if isinstance(model, FunctionProblem) and model.method != "dense":
        if model.kind == "flow" and period == 1:
            return module("large equilibria").converge_large(compiled(model), u, p)
        _need_dense(model)
    sparse = sparse_function(model, u, p) if period == 1 else None
    if sparse is not None:
        return module("large equilibria").converge_large(sparse.system(), u, p)
    model = lift_for(model, u, p, period)
    system = compiled(model) if period == 1 else iterate(compiled(model), period)
    try:
        return converge(system, u, p, np.asarray(model.periods(), dtype=float))
    except NotFiniteError as error:
        advice = [s.beyond for s, x in zip(getattr(model, "states", ()), u, strict=False) if s.beyond and x == 0.0]
        raise NotFiniteError(". ".join([str(error), *advice[:1]])) from None


def _need_dense(model: FunctionProblem) -> None:
    """Raises InputError for a map whose sparse or matrix-free Jacobian is too large to be taken as a dense one."""
    if model.kind == "map" and model.n > DENSE_UP_TO:
        raise InputError(
            f"function {model.name!r} is a map of {model.n} states with a {model.method} Jacobian; maps are followed "
            f"with dense ones, up to {DENSE_UP_TO} states"
        )
