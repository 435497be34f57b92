"""Files and report lines of the simulations and the sweep of a run file."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contin.cli.outputs import Output
from contin.cli.simulate import write_figure, write_table
from contin.plot.look import Look
from contin.plot.trajectory import figure
from contin.records import Fields, Record
from contin.runs.outputs import make_folder

if TYPE_CHECKING:
    from contin.runs.plans import Plan, SimulationPlan


def simulated_outputs(plan: Plan, document: Record) -> list[Output]:
    """One for each file that a simulation or the sweep writes; a simulation that could not be carried out has none."""
    outputs = []
    found = {entry["name"]: entry for entry in document.get("simulations", [])}
    for simulation in plan.simulations:
        if simulation.name in found:
            entry = found[simulation.name]
            for kind, path in simulation.outputs.items():
                outputs.append(Output(kind, partial(_write, simulation, kind, path, entry)))
    if plan.sweep is not None and "csv" in plan.sweep.outputs and "sweep" in document:
        outputs.append(Output("csv", partial(_table, document["sweep"]["columns"], plan.sweep.outputs["csv"])))
    return outputs


def _write(plan: SimulationPlan, kind: str, path: Path, entry: Fields) -> str:
    columns, section = entry["columns"], entry.get("section")
    if kind == "csv":
        return _table(columns if section is None else section, path)

    make_folder(path)
    title = f"{plan.model.title or plan.model.name}: {plan.name}"
    look = Look.of({"title": title, **plan.look})
    write_figure(figure(columns, list(plan.model.state_names), look=look, section=section), path)
    return f"wrote {os.path.relpath(path)}"


def _table(columns: Fields, path: Path) -> str:
    make_folder(path)
    write_table(columns, path)
    return f"wrote {os.path.relpath(path)}"


def draw_sweep(plan: Plan, document: Record, path: Path) -> None:
    """The sweep over the branches of the same file; alone where there is none."""
    from contin.plot.sweep import figure

    found = document["sweep"]
    over = document if document["branches"] else None
    look = Look.of({"title": plan.title, **plan.look})
    drawing = figure(found["columns"], found["parameter"], found["quantities"], look=look, over=over)
    write_figure(drawing, path)


def exponents_in_words(found: Record) -> str:
    """Lyapunov exponents with their errors, or why there are none."""
    if found["outcome"] != "done":
        return f"Lyapunov exponents: {found['outcome']}"
    pairs = zip(found["exponents"], found["errors"], strict=True)
    words = ", ".join(f"{value:.6g} +- {error:.1g}" for value, error in pairs)
    dimension = found["dimension"]  # null in a document where more exponents decide it
    told = "" if dimension is None or np.isnan(dimension) else f"; Kaplan-Yorke dimension {dimension:.5g}"
    return f"Lyapunov exponents {words}{told}"


def lines(document: Record) -> list[str]:
    """What became of every simulation and of the sweep, in words."""
    text = []
    for found in document.get("simulations", []):
        why = "" if found["outcome"] == "done" else f": {found['outcome']}, {found['why']}"
        text.append(f"simulation {found['name']} of {found['model']} to t = {found['end_time']:.6g}{why}")
        if "lyapunov" in found:
            text.append(f"  {exponents_in_words(found['lyapunov'])}")
    if "sweep" in document:
        found = document["sweep"]
        parameter, outcomes = found["parameter"], found["columns"]["outcome"]
        settled = sum(outcome == "settled" for outcome in outcomes)
        text.append(f"sweep of {found['model']} in {parameter}: {len(outcomes)} runs, {settled} settled")
        for direction, before, after in found["jumps"]:
            way = "up" if direction > 0 else "down"
            text.append(
                f"  {found['quantities'][0]} jumps on the way {way} between {parameter} = {before:g} and {after:g}"
            )
    return text
