"""Carry out the simulations and the sweep of a run file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from contin import lazy
from contin.records import Fields
from contin.runs.simulated import Simulated
from contin.runs.skipping import skipping
from contin.simulate.run import simulate
from contin.simulate.steady import Criterion
from contin.simulate.sweep import sweep

if TYPE_CHECKING:
    from contin.runs.plans import Plan, SimulationPlan, SweepPlan


def carry_out(
    plan: Plan, say: Callable[[str], None], watch: Callable[[int, int], None] | None = None, stopped: bool = False
) -> Simulated:
    """Carry out what the plan simulates, unless the user `stopped` before.

    A trajectory that escapes, and a run of the sweep that does not settle, are incomplete results, not errors. One that
    cannot be carried out is skipped with a note. Ctrl-C keeps the simulations that are done.
    watch : called with (runs done, runs in all) of the sweep.
    """
    names = [*(s.name for s in plan.simulations), *(["sweep"] if plan.sweep is not None else [])]
    if stopped:
        return Simulated({}, not names, [f"{name} skipped: stopped by the user" for name in names])
    found: Fields = {"simulations": []} if plan.simulations else {}
    notes: list[str] = []
    complete = True
    name = ""

    def skip(text: str) -> None:
        nonlocal complete
        complete = False
        notes.append(f"{name} skipped: {text}")

    try:
        for simulation in plan.simulations:
            name = simulation.name
            say(name)
            with skipping(skip):
                entry = _simulated(simulation)
                found["simulations"].append(entry)
                complete &= entry["outcome"] == "done"
        if plan.sweep is not None:
            name = "sweep"
            say(f"sweep in {plan.sweep.parameter}")
            with skipping(skip):
                found["sweep"] = _swept(plan.sweep, watch)
                complete &= all(outcome == "settled" for outcome in found["sweep"]["columns"]["outcome"])
    except KeyboardInterrupt:
        skip("stopped by the user")
        notes += [f"{later} skipped: stopped by the user" for later in names[names.index(name) + 1 :]]
    return Simulated(found, complete, notes)


def _simulated(plan: SimulationPlan) -> Fields:
    found = simulate(plan.model, plan.start, plan.parameters, time=plan.time, transient=plan.transient, **plan.options)
    jumps: Fields = {"events": found.events} if found.jumps else {}
    if (section := found.section) is not None:
        jumps["section"] = section
    return jumps | {
        "name": plan.name,
        "model": plan.model.name,
        "parameters": plan.model.default_parameters(dict(plan.parameters)),
        "outcome": found.outcome,
        "why": found.why,
        "end_time": found.end_time,
        "columns": found.columns,
    } | ({} if plan.exponents is None else {"lyapunov": _exponents(plan)})


def _exponents(plan: SimulationPlan) -> Fields:
    """Lyapunov exponents of the trajectory, in means over its time after the transient."""
    found = lazy.module("exponents").lyapunov(
        plan.model, plan.start, plan.parameters, time=plan.time, transient=plan.transient, count=plan.exponents,
        **{key: value for key, value in plan.options.items() if key == "rtol"},
    )  # fmt: skip
    return {
        "exponents": found.exponents, "errors": found.errors, "dimension": found.dimension,
        "time": float(found.times[0]), "outcome": found.outcomes[0],
    }  # fmt: skip


def _swept(plan: SweepPlan, watch: Callable[[int, int], None] | None) -> Fields:
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
