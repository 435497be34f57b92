"""The entries of a run file -> plans of runs, of a diagram, of a phase diagram."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

from contin import lazy
from contin.continuation.settings import Settings
from contin.errors import InputError, NotFiniteError
from contin.model.functionals import condition_count
from contin.model.relations import relations, relations_on_orbits
from contin.model.source import Path
from contin.records import Fields
from contin.runs.columns import check_columns
from contin.runs.entry_parts import EntryParts
from contin.runs.plans import EVERYWHERE, DiagramPlan, Number, PhasePlan, RunPlan, StartPoint
from contin.runs.references import is_stored
from contin.runs.samples import read_samples
from contin.runs.schema import ContinuationEntry, DiagramEntry, PhaseEntry

if TYPE_CHECKING:
    from contin.runs.stored_starts import StoredStart


class Planner(EntryParts):
    """Plans of the entries `diagram`, `phase` and `continuations`."""

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
        ends = _cycles(entry)
        start = None if entry.start is None or "start" in ends else self.start(entry.start, (*path, "start"))
        to = None if entry.to is None or "to" in ends else self.start(entry.to, (*path, "to"))
        values = self.targets(entry.values, path)
        if not all(known):
            return None
        bounds = self.bounds(entry.range, parameters, path)
        if len(bounds) < len(parameters):
            return None
        if entry.from_ is None and not ends:
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
            ends=ends, connecting=_written(truncation=entry.truncation, reversor=entry.reversor, pulses=entry.pulses),
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
        options = _written(side=entry.side, dimension=entry.dimension, length=entry.length, spacing=entry.spacing)
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
        if entry.from_ is None or entry.free:  # from a label, those of its branch where none are named
            needed = len(self.model.conditions) - len(self.model.states)
            if needed != len(entry.free):
                self.problems.add(path, condition_count(self.model, entry.free))
        if entry.as_ is not None:
            self.problems.add((*path, "as"), f"a boundary-value problem has no {entry.as_}; leave out `as`", key=True)
        if entry.settings.method == "shooting":
            told = "boundary-value problems are solved by collocation; leave out `method`"
            self.problems.add((*path, "settings", "method"), told, key=True)
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


def _mistake(attempt: Callable[[], object]) -> str:
    """What is wrong in words, or ''."""
    try:
        attempt()
    except InputError as error:
        return str(error).splitlines()[0]
    return ""


def _written(**keys: object) -> Fields:
    """The options that are there."""
    return {key: value for key, value in keys.items() if value is not None}


def _cycles(entry: ContinuationEntry) -> dict[str, tuple[str, str]]:
    """The ends of a connecting orbit that are labels NAME.LABEL of families of periodic orbits."""
    found = {}
    for key, end in (("start", entry.start), ("to", entry.to)):
        if entry.as_ == "connection" and isinstance(end, str) and "." in end:
            branch, _, label = end.rpartition(".")
            found[key] = (branch, label)
    return found
