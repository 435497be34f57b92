"""Carry out the simulations and the sweep of a run file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contin.runs.plan import Plan
    from contin.runs.simulation_plan import SimulationPlan, SweepPlan


def carry_out(
    plan: Plan, say: Callable[[str], None], watch: Callable[[int, int], None] | None = None
) -> tuple[dict[str, Any], bool]:
    """The entries `simulations` and `sweep` of the result document, and whether all of them ran to their end.

    A trajectory that escapes, and a run of the sweep that does not settle, are incomplete results, not errors. Ctrl-C
    keeps the simulations that are done.
    watch : called with (runs done, runs in all) of the sweep.
    """
    found: dict[str, Any] = {}
    complete = True
    try:
        if plan.simulations:
            found["simulations"] = []
            for simulation in plan.simulations:
                say(simulation.name)
                found["simulations"].append(_simulated(simulation))
                complete &= found["simulations"][-1]["outcome"] == "done"
        if plan.sweep is not None:
            say(f"sweep in {plan.sweep.parameter}")
            found["sweep"] = _swept(plan.sweep, watch)
            complete &= all(outcome == "settled" for outcome in found["sweep"]["columns"]["outcome"])
    except KeyboardInterrupt:
        return found, False
    return found, complete


def _simulated(plan: SimulationPlan) -> dict[str, Any]:
    from contin.simulate.run import simulate

    found = simulate(plan.model, plan.start, plan.parameters, time=plan.time, transient=plan.transient, **plan.options)
    return {
        "name": plan.name,
        "model": plan.model.name,
        "parameters": plan.model.default_parameters(dict(plan.parameters)),
        "outcome": found.outcome,
        "why": found.why,
        "end_time": found.end_time,
        "columns": found.columns,
    }


def _swept(plan: SweepPlan, watch: Callable[[int, int], None] | None) -> dict[str, Any]:
    from contin.simulate.steady import Criterion
    from contin.simulate.sweep import sweep

    found = sweep(
        plan.model, plan.parameter, plan.range, start=plan.start, parameters=plan.parameters, steps=plan.steps,
        down=plan.down, measures=dict(plan.measures) or None, watch=watch,
        criterion=Criterion(**plan.settle) if plan.settle else None,
    )  # fmt: skip
    return {
        "parameter": plan.parameter,
        "model": plan.model.name,
        "quantities": list(found.names),
        "jumps": [list(jump) for jump in found.jumps(found.names[0])],
        "columns": found.columns,
    }
