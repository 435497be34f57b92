"""A run file, its model and the command line -> a `Plan`: every name and number checked before anything is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

from contin import lazy
from contin.continuation.spectra import asked
from contin.errors import ContinError
from contin.model.registry import find
from contin.model.source import PartSource, Problems, Source
from contin.model.yaml_loader import model_from_mapping
from contin.records import Json
from contin.runs.columns import check_columns, formulas
from contin.runs.outputs import output_paths
from contin.runs.picture_entry import file_of, look_of
from contin.runs.planner import Planner
from contin.runs.plans import Number, Plan
from contin.runs.references import check_references
from contin.runs.schema import RunEntry
from contin.runs.transforms import apply_passes
from contin.symbolic.passes.conserved import with_named_totals, without_conserved

if TYPE_CHECKING:
    from contin.model.model import Model


def make_plan(entry: RunEntry, source: Source, file: FilePath, overrides: Mapping[str, Number] | None = None) -> Plan:
    """Find the model of a run file and check the entries against it.

    Raises
    ------
    InputError
        Everything that is wrong, each with its place in the file.
    """
    problems = Problems(source)
    model = model_of(entry, source, file, problems, overrides or {}, swept(entry))
    problems.raise_if_any()
    plan = make_plan_for(model, entry, source, file, overrides)
    if entry.simulate or entry.sweep is not None:
        written = _written_model(entry, source, file, problems)
        plan = lazy.module("simulation plan").with_simulations(plan, written, entry, source, file)
    return plan


def make_plan_for(
    model: Model, entry: RunEntry, source: Source, file: FilePath, overrides: Mapping[str, Number] | None = None
) -> Plan:
    """Check the entries of a run file against a model at hand; `InputError` as `make_plan`."""
    problems = Problems(source)
    if entry.diagram is not None or entry.phase is not None or entry.continuations:
        model = without_conserved(model)
    else:
        model = with_named_totals(model, [*entry.parameters, *(overrides or ())])
    outputs = output_paths(_written_files(entry), file, problems)
    planner = Planner(model, problems, {**entry.parameters, **(overrides or {})})
    planner.check_parameters(entry.parameters, overrides or {})
    diagram = None if entry.diagram is None else planner.diagram(entry.diagram)
    phase = None if entry.phase is None else planner.phase(entry.phase)
    runs = planner.runs(entry.continuations, file)
    check_references(entry, model, problems)
    look = look_of(entry.outputs.plot, x=entry.outputs.x, y=entry.outputs.y)
    quantities = [] if entry.sweep is None else list(entry.sweep.measures)
    shown = [(("outputs", "x"), look.get("x")), *((("outputs", "y"), name) for name in look.get("y") or [])]
    check_columns(shown, model, problems, quantities)
    problems.raise_if_any()
    spectra = asked([name for _, name in shown])
    recorded = tuple(formulas([name for _, name in shown if name is not None], model, quantities))
    runs = [replace(run, recorded=recorded, spectra=spectra) for run in runs]
    diagram = diagram and replace(diagram, columns=(*diagram.columns, *recorded), spectra=spectra)
    return Plan(model, planner.overrides, runs, diagram, phase, outputs, look, entry.title or model.title)


def _written_files(entry: RunEntry) -> dict[str, str]:
    files = {
        "plot": file_of(entry.outputs.plot),
        "html": entry.outputs.html,
        "save": entry.outputs.save,
        "json": entry.outputs.json_,
    }
    return {kind: path for kind, path in files.items() if path is not None}


def model_of(
    entry: RunEntry, source: Source, file: FilePath, problems: Problems, overrides: Mapping[str, Number],
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Model:  # fmt: skip
    model = _written_model(entry, source, file, problems)
    return apply_passes(model, entry.transform, problems, {**entry.parameters, **overrides}, ranges)


def swept(entry: Json) -> dict[str, tuple[float, float]]:
    """The smallest interval that holds all ranges of each parameter in the file, where these are numbers."""
    found: dict[str, tuple[float, float]] = {}
    if not isinstance(entry, RunEntry):  # a scan file
        axes = {name: axis for name, axis in entry.scan.axes.items() if hasattr(axis, "from_")}
        return {
            name: (min(axis.from_, axis.to), max(axis.from_, axis.to))
            for name, axis in axes.items()
            if isinstance(axis.from_, int | float) and isinstance(axis.to, int | float)
        }
    for part in (entry.diagram, entry.phase, *entry.continuations, entry.sweep):
        if part is None or part.range is None:
            continue
        names = [part.parameter] if isinstance(part.parameter, str) else list(part.parameter or ())
        ranges = part.range if isinstance(part.range, Mapping) else dict.fromkeys(names[:1], part.range)
        for name, ends in ranges.items():
            if all(isinstance(end, int | float) for end in ends):
                values = [float(end) for end in ends] + list(found.get(name, ()))
                found[name] = min(values), max(values)
    return found


def _written_model(entry: RunEntry, source: Source, file: FilePath, problems: Problems) -> Json:
    """The model that the file names or holds, before any pass."""
    if isinstance(entry.model, str):
        try:
            return find(entry.model, file.parent)
        except ContinError as error:
            problems.add(("model",), str(error))
            problems.raise_if_any()
            raise
    return model_from_mapping(entry.model, PartSource(source, ("model",)))
