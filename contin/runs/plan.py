"""A run file, its model and the command line -> a `Plan`: every name and number checked before anything is computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from contin import lazy
from contin.continuation.settings import Settings
from contin.continuation.spectra import asked
from contin.errors import ContinError, ExpressionError, InputError, NotFiniteError
from contin.limits import as_double
from contin.model.advice import closest
from contin.model.evaluate import evaluate
from contin.model.functionals import condition_count
from contin.model.parser import parse
from contin.model.registry import find
from contin.model.relations import relations, relations_on_orbits
from contin.model.source import PartSource, Path, Problems, Source, Span
from contin.model.yaml_loader import model_from_mapping
from contin.records import Fields, Json, Record
from contin.runs.columns import STANDARD, check_columns, column_mistake, formulas
from contin.runs.outputs import output_paths
from contin.runs.references import check_references, is_stored
from contin.runs.samples import Samples, read_samples
from contin.runs.schema import ContinuationEntry, DiagramEntry, PhaseEntry, RunEntry, StartMapping
from contin.runs.transforms import apply_passes
from contin.symbolic.passes.conserved import starting_names, with_named_totals, without_conserved

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.runs.simulation_plan import SimulationPlan, SweepPlan
    from contin.runs.stored_starts import StoredStart

Number = float | int | str | Any  # a number, or a formula in the parameters
StartPoint = str | Record | None

AUTO = "auto"  # the start that is found
EVERYWHERE = "all"  # the start of a diagram that stands for all equilibria in its box


@dataclass(frozen=True)
class RunPlan:
    """One continuation: where it starts, what varies and how far."""

    name: str
    parameters: tuple[str, ...]
    range: Mapping[str, tuple[float, float]]
    start: StartPoint = None
    reference: tuple[str, str] | None = None  # (branch, label)
    stored: StoredStart | None = None  # a label of a stored result
    as_: str | None = None
    direction: str = "both"
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    settings: Record = field(default_factory=dict)
    to: StartPoint = None  # of a connecting orbit: the saddle that it leads to
    samples: Samples | None = None  # of an orbit to begin with
    free: tuple[str, ...] = ()  # parameters that are solved for beside those that vary
    extrema: tuple[str, ...] = ()  # columns to be labelled where they turn
    conditions: tuple[str, ...] = ()  # equations that the solutions meet
    columns: tuple[str, ...] = ()  # formulas that families of orbits record
    recorded: tuple[str, ...] = ()  # the same, for the picture's axes, where the run follows orbits
    manifold: Record = field(default_factory=dict)  # side, dimension, length, spacing
    truncation: float | None = None  # of a connecting orbit: distance of its ends from the saddles, relative
    spectra: bool = False  # eigenvalues are columns


@dataclass(frozen=True)
class DiagramPlan:
    """What the explorer is asked for."""

    parameter: str
    range: tuple[float, float]
    starts: Sequence[StartPoint] = (None,)
    orbits: bool = True
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    settings: Record = field(default_factory=dict)
    budget: Record = field(default_factory=dict)
    box: Mapping[str, Sequence[float]] | None = None  # where `start: all` looks for equilibria
    columns: tuple[str, ...] = ()  # formulas that families of orbits record
    spectra: bool = False  # eigenvalues are columns


@dataclass(frozen=True)
class PhasePlan:
    """The phase diagram that is asked for."""

    parameters: tuple[str, str]
    range: Mapping[str, tuple[float, float]]
    starts: Sequence[StartPoint] = (None,)
    settings: Record = field(default_factory=dict)
    orbits: bool = True


@dataclass(frozen=True)
class Plan:
    """All that a run file asks for. `parameters` are the overrides of the file and the command line together."""

    model: Model
    parameters: Mapping[str, Number]
    runs: Sequence[RunPlan] = ()
    diagram: DiagramPlan | None = None
    phase: PhasePlan | None = None
    outputs: Mapping[str, FilePath] = field(default_factory=dict)
    look: Fields = field(default_factory=dict)  # of the picture, as `contin.plot.look.Look.of` takes it
    title: str | None = None
    simulations: Sequence[SimulationPlan] = ()
    sweep: SweepPlan | None = None

    def simulated_files(self) -> list[Mapping[str, FilePath]]:
        """What the simulations and the sweep write."""
        return [*(s.outputs for s in self.simulations), *([self.sweep.outputs] if self.sweep else [])]


def _mistake(attempt: Callable[[], object]) -> str:
    """What is wrong in words, or ''."""
    try:
        attempt()
    except InputError as error:
        return str(error).splitlines()[0]
    return ""


def make_plan(entry: RunEntry, source: Source, file: FilePath, overrides: Mapping[str, Number] | None = None) -> Plan:
    """Find the model of a run file and check the entries against it.

    Raises
    ------
    InputError
        Everything that is wrong, each with its place in the file.
    """
    problems = Problems(source)
    model = _model(entry, source, file, problems, overrides or {}, swept(entry))
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
    planner = _Planner(model, problems, {**entry.parameters, **(overrides or {})})
    planner.check_parameters(entry.parameters, overrides or {})
    diagram = None if entry.diagram is None else planner.diagram(entry.diagram)
    phase = None if entry.phase is None else planner.phase(entry.phase)
    runs = planner.runs(entry.continuations, file)
    check_references(entry, model, problems)
    look = entry.outputs.look()
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
        "plot": entry.outputs.plot_file,
        "html": entry.outputs.html,
        "save": entry.outputs.save,
        "json": entry.outputs.json_,
    }
    return {kind: path for kind, path in files.items() if path is not None}


def _model(
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


class _Planner:
    def __init__(self, model: Model, problems: Problems, overrides: Mapping[str, Number]) -> None:
        self.model, self.problems, self.overrides = model, problems, dict(overrides)
        self.names = list(model.parameter_names)
        self.values: dict[str, float] = {}

    def check_parameters(self, written: Mapping[str, Number], typed: Mapping[str, Number]) -> None:
        """Names and values of the overrides, those of the file at their place."""
        for name in typed:
            if name not in self.names:
                raise InputError(f"--set {name}: {self.model.name} has no parameter {name!r}: {self.advice(name)}")
        for name, value in written.items():
            if self.known(name, ("parameters", name), key=True):
                self.formula(value, ("parameters", name))
        if not self.problems:
            try:
                self.values = self.model.default_parameters(self.overrides)
            except (InputError, NotFiniteError) as error:
                raise InputError(f"the parameters given: {error}") from None

    def diagram(self, entry: DiagramEntry) -> DiagramPlan | None:
        path: Path = ("diagram",)
        starts: list[StartPoint] = [None]
        if entry.start is not None:
            starts = [
                s if s == EVERYWHERE and not self.has_start(EVERYWHERE) else self.start(s, (*path, "start", k))
                for k, s in enumerate(entry.start)
            ]
        box = self.box(entry.box, (*path, "box"))
        if not self.known(entry.parameter, (*path, "parameter")):
            return None
        bounds = self.bounds(entry.range, [entry.parameter], path).get(entry.parameter)
        values = self.targets(entry.values, path)
        if bounds is None:
            return None
        for start in starts:
            if start != EVERYWHERE or self.has_start(EVERYWHERE):
                self.inside(start, entry.parameter, bounds, (*path, "range"))
        budget = entry.budget.model_dump(exclude_none=True)
        settings = self.settings(entry, ("diagram",))
        columns = self.columns(entry, path)
        return DiagramPlan(entry.parameter, bounds, starts, entry.orbits, values, settings, budget, box, columns)

    def phase(self, entry: PhaseEntry) -> PhasePlan | None:
        path: Path = ("phase",)
        starts: list[StartPoint] = [self.start(s, (*path, "start", k)) for k, s in enumerate(entry.start or [])]
        first, second = entry.parameter
        known = [self.known(name, (*path, "parameter")) for name in (first, second)]
        bounds = self.bounds(entry.range, (first, second), path) if all(known) else {}
        if len(bounds) < 2:
            return None
        return PhasePlan((first, second), bounds, starts or [None], self.settings(entry, ("phase",)), entry.orbits)

    def runs(self, entries: Sequence[ContinuationEntry], file: FilePath) -> list[RunPlan]:
        names: list[str] = []
        runs = []
        for position, entry in enumerate(entries):
            path: Path = ("continuations", position)
            name = entry.name or f"run{position + 1}"
            if name in names:
                self.problems.add((*path, "name"), f"{name!r} is already the name of an earlier run; choose another")
            names.append(name)
            run = self.run(name, entry, path, file)
            if run is not None:
                runs.append(run)
        return runs

    def run(self, name: str, entry: ContinuationEntry, path: Path, file: FilePath) -> RunPlan | None:
        if entry.as_ == "manifold":
            return self.manifold(name, entry, path)
        parameters = tuple(entry.parameter)
        known = [self.known(p, (*path, "parameter")) for p in parameters]
        start = None if entry.start is None else self.start(entry.start, (*path, "start"))
        to = None if entry.to is None else self.start(entry.to, (*path, "to"))
        values = self.targets(entry.values, path)
        if not all(known):
            return None
        bounds = self.bounds(entry.range, parameters, path)
        if len(bounds) < len(parameters):
            return None
        if entry.from_ is None:
            self.inside(start, parameters[0], bounds[parameters[0]], (*path, "range"))
        reference = None
        stored = None
        if entry.from_ is not None and is_stored(entry.from_):
            stored = self.stored(entry.from_, file, parameters, (*path, "from"))
        elif entry.from_ is not None:
            branch, _, label = entry.from_.rpartition(".")
            reference = (branch, label)
        free = self.free(entry, parameters, path)
        self.extrema(entry.extrema, path)
        settings, as_, samples = self.settings(entry, path), entry.as_, None
        if entry.samples is not None:
            as_ = (as_ or "orbit") if self.model.interval is None else None
            samples = read_samples(entry.samples, file, self.model.state_names, self.problems, (*path, "samples"))
        return RunPlan(
            name, parameters, bounds, start, reference, stored, as_, entry.direction, values, settings, to, samples,
            free, tuple(entry.extrema), tuple(entry.conditions), self.columns(entry, path),
            truncation=entry.truncation,
        )  # fmt: skip

    def manifold(self, name: str, entry: ContinuationEntry, path: Path) -> RunPlan:
        """Of the equilibrium next to a start, or at a label."""
        assert entry.of is not None
        start, reference = None, None
        if isinstance(entry.of, str) and "." in entry.of:
            branch, _, label = entry.of.rpartition(".")
            reference = (branch, label)
        else:
            start = self.start(entry.of, (*path, "of"))
        chosen = {"side": entry.side, "dimension": entry.dimension, "length": entry.length, "spacing": entry.spacing}
        options = {key: value for key, value in chosen.items() if value is not None}
        return RunPlan(name, (), {}, start, reference, as_="manifold", manifold=options)

    def stored(self, text: str, file: FilePath, varying: tuple[str, ...], path: Path) -> StoredStart | None:
        """A label of a stored result to start from."""
        found: StoredStart | None = lazy.module("stored starts").stored_start(
            text, file, self.model, self.values, self.overrides, varying, self.problems, path
        )
        return found

    def free(self, entry: ContinuationEntry, parameters: Sequence[str], path: Path) -> tuple[str, ...]:
        """Parameters that are solved for: as many as there are more conditions than equations."""
        for k, name in enumerate(entry.free):
            if self.known(name, (*path, "free", k)) and name in parameters:
                self.problems.add((*path, "free", k), f"{name} varies in this run already (`parameter`)")
        if self.model.interval is None:
            self.conditions(entry, path)
            return tuple(entry.free)
        if entry.conditions:
            self.problems.add((*path, "conditions"), "of a boundary-value problem they stand in the model", key=True)
        if entry.from_ is None:
            needed = len(self.model.conditions) - len(self.model.states)
            if needed != len(entry.free):
                self.problems.add(path, condition_count(self.model, entry.free))
        if entry.as_ is not None:
            self.problems.add((*path, "as"), f"a boundary-value problem has no {entry.as_}; leave out `as`", key=True)
        return tuple(entry.free)

    def conditions(self, entry: ContinuationEntry, path: Path) -> None:
        """Equations on the solutions of a run, one for each free parameter."""
        count = len(entry.conditions)
        if count != len(entry.free):
            have = f"{count} condition{'s' * (count != 1)} and {len(entry.free)} free parameters"
            self.problems.add(path, f"{have}: each condition needs one parameter under `free` that is solved for")
        if count and self.model.kind == "algebraic":
            self.problems.add((*path, "conditions"), "of kind: algebraic: write them as further equations", key=True)
        if entry.as_ == "orbit" or entry.samples is not None:
            relations_on_orbits(self.model, entry.conditions, self.problems, (*path, "conditions"))
            return
        for k, text in enumerate(entry.conditions):  # on states or on orbits, as the start turns out to be
            mistakes = [_mistake(partial(relations, self.model, [text], orbits)) for orbits in (False, True)]
            if all(mistakes):
                self.problems.add((*path, "conditions", k), mistakes[0])

    def settings(self, entry: ContinuationEntry | DiagramEntry | PhaseEntry, path: Path) -> Fields:
        """The settings that were written, which must fit together."""
        chosen = entry.settings.chosen()
        mistake = _mistake(partial(Settings.of, chosen))
        if mistake:
            self.problems.add((*path, "settings"), mistake, key=True)
        return chosen

    def extrema(self, columns: Sequence[str], path: Path) -> None:
        """Columns that are to be labelled where they turn."""
        places = [((*path, "extrema", k), name) for k, name in enumerate(columns)]
        check_columns(places, self.model, self.problems)

    def columns(self, entry: ContinuationEntry | DiagramEntry, path: Path) -> tuple[str, ...]:
        """Formulas to be recorded on families of orbits."""
        places = [((*path, "columns", k), name) for k, name in enumerate(entry.columns)]
        check_columns(places, self.model, self.problems)
        return tuple(entry.columns)

    # Parts of an entry ------------------------------------------------------------------------------------------------

    def known(self, name: str, path: Path, *, key: bool = False) -> bool:
        if name in self.names:
            return True
        self.problems.add(path, f"{self.model.name} has no parameter {name!r}: {self.advice(name)}", key=key)
        return False

    def advice(self, name: str) -> str:
        return closest(name, self.names) or f"there are {', '.join(self.names) or 'none'}"

    def formula(self, value: Number, path: Path) -> float | None:
        """The value of a number or a formula in the parameters; a mistake is noted at its place."""
        if not isinstance(value, str):
            return as_double(value)
        try:
            expression = parse(value, self.names, self.model.functions)
        except ExpressionError as error:
            span = Span(error.position, error.position + 1)
            self.problems.add(path, str(error), value=value, span=span)
            return None
        if not self.values and self.names:
            return None
        number = float(evaluate(expression, self.values))
        if not math.isfinite(number):
            self.problems.add(path, f"{value!r} is {number}; a finite number is needed")
            return None
        return number

    def has_start(self, name: str) -> bool:
        return any(start.name == name for start in self.model.starts)

    def box(self, written: Mapping[str, Sequence[Any]] | None, path: Path) -> dict[str, tuple[float, float]] | None:
        """Bounds of states, in numbers."""
        if written is None:
            return None
        box: dict[str, tuple[float, float]] = {}
        for name, (low, high) in written.items():
            if name not in self.model.state_names:
                known = list(self.model.state_names)
                advice = closest(name, known) or f"there are {', '.join(known)}"
                self.problems.add((*path, name), f"{self.model.name} has no state {name!r}: {advice}", key=True)
                continue
            bounds = self.formula(low, (*path, name, 0)), self.formula(high, (*path, name, 1))
            if bounds[0] is not None and bounds[1] is not None:
                box[name] = (bounds[0], bounds[1])
                if not box[name][0] < box[name][1]:
                    self.problems.add((*path, name), f"the lower bound must be below the upper one; got {list(bounds)}")
        return box

    def start(self, written: str | StartMapping, path: Path) -> StartPoint:
        """A start as the model takes it, its names checked."""
        if isinstance(written, str):
            names = [start.name for start in self.model.starts]
            if written not in (*names, AUTO):
                advice = closest(written, names) or (
                    f"there are {', '.join(names)}" if names else "it declares no starts"
                )
                self.problems.add(path, f"{self.model.name} has no start {written!r}: {advice}")
            return written
        states = dict(written.model_extra or {})
        for name in states:
            if name not in starting_names(self.model):
                known = list(starting_names(self.model))
                advice = closest(name, known) or f"there are {', '.join(known)}"
                self.problems.add((*path, name), f"{self.model.name} has no state {name!r}: {advice}", key=True)
            elif not getattr(self.model, "axes", ()):  # formulas in coordinates are read where the start is made
                self.formula(states[name], (*path, name))
        for name, value in written.parameters.items():
            if self.known(name, (*path, "parameters", name), key=True):
                self.formula(value, (*path, "parameters", name))
        return {**states, "parameters": dict(written.parameters)} if written.parameters else states

    def bounds(self, written: object, parameters: Iterable[str], path: Path) -> dict[str, tuple[float, float]]:
        """The range of every parameter that varies: as written, or the model's own."""
        parameters = list(parameters)
        path = (*path, "range")
        given: Record = {}
        if isinstance(written, Mapping):
            given = written
            for name in written:
                if name not in parameters:
                    self.problems.add(
                        (*path, name),
                        f"{name!r} does not vary in this run; it varies {', '.join(parameters)}",
                        key=True,
                    )
        elif written is not None and len(parameters) == 1:
            given = {parameters[0]: written}
        elif written is not None:
            one = ", ".join(f"{name}: [low, high]" for name in parameters)
            self.problems.add(path, f"two parameters need a range each: write {{{one}}}")
            return {}
        found = {}
        for name in parameters:
            place = (*path, name) if isinstance(written, Mapping) and name in written else path
            bounds = self.interval(given[name], place) if name in given else self.default_range(name, place)
            if bounds is not None:
                found[name] = bounds
        return found

    def interval(self, written: Sequence[Number], path: Path) -> tuple[float, float] | None:
        low, high = (self.formula(value, (*path, k)) for k, value in enumerate(written))
        if low is None or high is None:
            return None
        if not low < high:
            self.problems.add(path, f"expected [low, high] with low < high, got [{low:g}, {high:g}]")
            return None
        return low, high

    def default_range(self, name: str, path: Path) -> tuple[float, float] | None:
        if self.names and not self.values:
            return None  # the values of the parameters are wrong, which is noted
        bounds = self.model.parameter_range(name, self.overrides)
        if bounds is None:
            self.problems.add(
                path[:-1] if path[-1] == "range" else path, f"the range of {name} is missing; add `range: [low, high]`"
            )
        return bounds

    def targets(self, written: Mapping[str, Sequence[Number]], path: Path) -> dict[str, list[float]]:
        """User values by column."""
        columns = [*self.names, *self.model.state_names, *self.model.observables, "period", *STANDARD]
        found: dict[str, list[float]] = {}
        for name, entries in written.items():
            known = name in columns or name.rpartition(".")[0] in columns
            if not known and not formulas([name], self.model):
                advice = closest(name, columns) or column_mistake(name, self.model)
                advice = advice or f"there are {', '.join(columns)}"
                self.problems.add((*path, "values", name), f"there is no column {name!r}: {advice}", key=True)
                continue
            numbers = [self.formula(value, (*path, "values", name)) for value in entries]
            found[name] = [number for number in numbers if number is not None]
        return found

    def inside(self, start: StartPoint, parameter: str, bounds: tuple[float, float], path: Path) -> None:
        """The start must lie in the range."""
        if self.problems:
            return
        start = None if start == AUTO and not self.has_start(AUTO) else start
        try:
            _, p = self.model.start_point(start, self.overrides)
        except (InputError, NotFiniteError) as error:
            self.problems.add((*path[:-1], "start"), str(error))
            return
        value = float(p[self.names.index(parameter)])
        if not bounds[0] <= value <= bounds[1]:
            self.problems.add(
                path,
                f"the start has {parameter} = {value:.10g}, outside the range [{bounds[0]:g}, {bounds[1]:g}]; "
                f"widen the range, or set {parameter} under `parameters`",
            )
