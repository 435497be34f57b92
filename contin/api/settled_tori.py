"""Tori on which simulations settle, followed to both sides in a parameter."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.machine_code import compiled
from contin.api.torus_branches import end_of, torus_branch
from contin.continuation.branch import Branch, End
from contin.errors import InputError, NoSolutionError
from contin.kernels.clock import computing_time
from contin.model.model import Model
from contin.records import Record
from contin.tori.ends import Row, Stop
from contin.tori.equations import Metric, solve
from contin.tori.looks import error_of, residual_between
from contin.tori.march import Plan, follow, most_nodes
from contin.tori.settled import settled
from contin.tori.strobe import Strobe

NODES: Final = 61
GOOD: Final = 1e-2  # relative error of a first circle: what is beyond is none


def settled_torus(
    model: Any, start: str | Record | None, parameters: Record | None, parameter: str, plan: Plan, direction: str,
    name: str,
) -> Branch:  # fmt: skip
    """The family through the torus on which the trajectory from `start` settles."""
    began = computing_time()
    if not isinstance(model, Model) or model.kind not in ("flow", "map"):
        raise InputError("a torus starts at a label NS, or from a simulation of a flow or map given by formulas")
    if model.mass or model.constraints is not None or model.events:
        raise InputError("tori of flows with a mass matrix or with jumps of the states are not followed")
    u, p = model.start_point(start, dict(parameters or {}))
    system = compiled(model)
    values = dict(zip(system.parameter_names, p.tolist(), strict=True))
    strobe = Strobe(system, p, system.parameter_names.index(parameter), np.asarray(model.periods(values), dtype=float))
    row, metric = _first(strobe, u, float(p[strobe.active]), plan)
    arms: dict[str, list[Row]] = {"down": [], "up": []}
    ends = {side: End("start", "a torus on which a simulation settles") for side in arms}
    for side, sign in (("down", -1.0), ("up", 1.0)):
        if direction in (side, "both"):
            rows, stop = gathered(follow(strobe, metric, row.circle, sign * row.solved.tangent, plan))
            arms[side], ends[side] = rows, end_of(stop, parameter)
    every = [*arms["down"][::-1], row, *arms["up"]]
    return torus_branch(
        name, strobe, metric, every, (ends["down"], ends["up"]), computing_time() - began, start_row=len(arms["down"])
    )


def gathered(found: Iterable[Row | Stop]) -> tuple[list[Row], Stop]:
    """The rows, and why there are no more."""
    rows: list[Row] = []
    for one in found:
        if isinstance(one, Stop):
            return rows, one
        rows.append(one)
    return rows, Stop("steps", "all steps used up")


def _first(strobe: Strobe, u: Array, value: float, plan: Plan) -> tuple[Row, Metric]:
    """The circle on which the trajectory settles, solved for; lengths are those of the torus."""
    count = plan.nodes or min(NODES, most_nodes(strobe))
    try:
        guess, states = settled(strobe, u, value, count)
        spread = np.ptp(states, axis=0)
        metric = Metric(np.where(spread > 0.0, spread, spread.max() or 1.0), plan.bounds[1] - plan.bounds[0])
        across = np.append(np.zeros(guess.values.size), 1.0)
        solved = solve(strobe, metric, guess, across, plan.tolerance, fixed=True)
    except NoSolutionError as failure:
        raise InputError(f"no torus is found on which the trajectory settles: {failure}") from None
    error = error_of(solved.circle, residual_between(strobe, metric, solved.circle))
    if not error < GOOD:
        raise InputError(
            f"the trajectory settles on no torus that {count} nodes resolve (error {error:.2g}): it may be a periodic "
            "solution, chaos, or a torus with sharp turns; give another start or parameter"
        )
    return Row(solved, error), metric
