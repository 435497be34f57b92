"""`simulate:` and `sweep:` of a run file, checked: what to integrate, from where, and which files to write.

Both take the model as it is written, so that a trajectory of the equations of motion stands beside branches of their
average; `transformed: true` takes the model after the passes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

from contin.errors import ContinError
from contin.model.source import Path, Problems, Source
from contin.records import Fields, Json, Record
from contin.runs.outputs import output_path
from contin.runs.picture_entry import PictureEntry, file_of, look_of
from contin.runs.planner import Planner
from contin.runs.plans import Plan, SimulationPlan, StartPoint, SweepPlan
from contin.runs.schema import RunEntry, SimulateEntry, SweepEntry
from contin.simulate.crossings import section_of
from contin.symbolic.passes.conserved import with_named_totals

if TYPE_CHECKING:
    from contin.model.model import Model


def with_simulations(plan: Plan, written: Json, entry: RunEntry, source: Source, file: FilePath) -> Plan:
    """The plan with its simulations and its sweep; InputError with everything that is wrong, each at its place."""
    problems = Problems(source)
    taken = list(plan.outputs.values())
    simulations: list[SimulationPlan] = []
    for position, item in enumerate(entry.simulate):
        path: Path = ("simulate", position)
        model = plan.model if item.transformed else with_named_totals(written, [*plan.parameters, *item.parameters])
        name = item.name or f"simulation{position + 1}"
        if any(name == earlier.name for earlier in simulations):
            problems.add((*path, "name"), f"{name!r} is already the name of an earlier simulation; choose another")
        files = _files({"plot": file_of(item.plot), "csv": item.csv}, file, problems, taken, path)
        simulation = _simulation(item, name, model, plan.parameters, problems, path)
        simulations.append(replace(simulation, outputs=files))
    sweep = None
    if entry.sweep is not None:
        named = [entry.sweep.parameter, *plan.parameters, *entry.sweep.parameters]
        model = plan.model if entry.sweep.transformed else with_named_totals(written, named)
        sweep = _sweep(entry.sweep, model, plan.parameters, problems)
        if sweep is not None:
            sweep = replace(sweep, outputs=_files({"csv": entry.sweep.csv}, file, problems, taken, ("sweep",)))
    problems.raise_if_any()
    return replace(plan, simulations=simulations, sweep=sweep)


def _files(
    written: Mapping[str, str | None], file: FilePath, problems: Problems, taken: list[FilePath], path: Path
) -> dict[str, FilePath]:
    files = {}
    for kind, text in written.items():
        place = None if text is None else output_path(text, kind, file, problems, taken, (*path, kind))
        if place is not None:
            files[kind] = place
    return files


def _planner(
    model: Model, shared: Record, own: Record, problems: Problems, path: Path
) -> tuple[Planner, Fields]:
    """The checker of names and numbers for this model, and the parameters of the file and of the entry together."""
    known = {name: value for name, value in shared.items() if name in model.parameter_names}  # a pass may bring others
    planner = Planner(model, problems, known)
    planner.check_parameters({}, {})
    for name, value in own.items():
        if planner.known(name, (*path, "parameters", name), key=True):
            planner.formula(value, (*path, "parameters", name))
            known[name] = value
    final = Planner(model, problems, known)
    final.check_parameters({}, {})  # the values that formulas and default ranges are taken at
    return final, known


def _start(
    planner: Planner, written: Json, parameters: Record, problems: Problems, path: Path
) -> StartPoint:
    start = None if written is None else planner.start(written, (*path, "start"))
    if not problems:
        try:
            planner.model.start_point(start, dict(parameters))
        except ContinError as error:
            problems.add((*path, "start") if written is not None else path, str(error))
    return start


def _simulation(
    item: SimulateEntry, name: str, model: Model, shared: Record, problems: Problems, path: Path
) -> SimulationPlan:
    planner, parameters = _planner(model, shared, item.parameters, problems, path)
    start = _start(planner, item.start, parameters, problems, path)
    look = look_of(item.plot, x=item.x, y=item.y)
    columns = ["t", *model.state_names, *model.observables]
    inside: Path = ("plot",) if isinstance(item.plot, PictureEntry) else ()
    for key in ("x", "y", "log", "limits"):
        said = look.get(key) or ()
        for column in [said] if isinstance(said, str) else said:
            if column not in columns:
                place: Path = (*path, key) if getattr(item, key, None) is not None else (*path, *inside, key)
                problems.add(place, f"there is no column {column!r}; there are {', '.join(columns)}")
    if item.section is not None:
        try:
            section_of(model, item.chosen()["section"])
        except ContinError as error:
            problems.add((*path, "section"), str(error).removeprefix("section: "))
    times = item.time, item.transient
    return SimulationPlan(name, model, start, parameters, *times, item.exponents, item.chosen(), look=look)


def _sweep(item: SweepEntry, model: Model, shared: Record, problems: Problems) -> SweepPlan | None:
    path: Path = ("sweep",)
    planner, parameters = _planner(model, shared, item.parameters, problems, path)
    start = _start(planner, item.start, parameters, problems, path)
    for name, formula in item.measures.items():
        try:
            model.expression(formula)
        except ContinError as error:
            problems.add((*path, "measures", name), str(error))
    if not planner.known(item.parameter, (*path, "parameter")):
        return None
    bounds = planner.bounds(item.range, [item.parameter], path).get(item.parameter)
    if bounds is None:
        return None
    settle = {} if item.settle is None else item.settle.model_dump(exclude_none=True)
    return SweepPlan(
        model, item.parameter, bounds, start, parameters, item.steps, item.down, dict(item.measures), settle
    )


def described(plans: Sequence[SimulationPlan], sweep: SweepPlan | None) -> list[str]:
    """What is asked for, in words."""
    return [*(f"simulation {plan.name}" for plan in plans), *([f"sweep in {sweep.parameter}"] if sweep else [])]
