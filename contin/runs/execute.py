"""Carry out a plan: run after run, each result kept, whatever becomes of the later ones."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from contin.continuation.branch import ANNOUNCED_FAILURES, Branch, SpecialPoint
from contin.continuation.spectra import spectral_columns
from contin.errors import InputError
from contin.records import Record
from contin.runs.engine import Engine
from contin.runs.plans import DiagramPlan, PhasePlan, Plan, RunPlan
from contin.runs.skipping import skipping
from contin.symbolic.passes.conserved import conserved_notes

Progress = Callable[[str], None]
"""Called with what is being computed, in words."""


@dataclass(frozen=True, eq=False)
class RunResult:
    """Branches by name, in the order computed; not `complete` where a requested one is cut short or missing."""

    branches: Mapping[str, Branch]
    notes: Sequence[str]
    complete: bool
    seconds: float
    phase: Record | None = None  # the regions of a phase diagram, as plain data
    stopped: bool = False  # by the user
    diagram: Record | None = None  # which of the branches are those of a diagram, and of which


@dataclass
class _State:
    branches: dict[str, Branch] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    complete: bool = True
    phase: Record | None = None
    diagram: Record | None = None
    stopped: bool = False
    refused: list[InputError] = field(default_factory=list)  # what is wrong with runs as they are written

    def add(self, branch: Branch) -> None:
        self.branches[branch.name] = branch
        self.stopped |= any(end.reason == "stopped" for end in branch.ends)
        if branch.unexplained or branch.jumped or any(end.reason in ANNOUNCED_FAILURES for end in branch.ends):
            self.complete = False

    def stop(self) -> None:
        self.stopped, self.complete = True, False

    def skip(self, note: str) -> None:
        self.notes.append(note)
        self.complete = False


def execute(plan: Plan, engine: Engine, progress: Progress | None = None) -> RunResult:
    """Carry out every run of the plan.

    A run that cannot start (no solution, no connection, a point that was not found, a start that is no good) is skipped
    with a note, and so are the runs that need it; the others go on.

    Raises
    ------
    InputError
        Nothing could be begun, because of what is written: there is no result to put a note in.
    """
    began = time.perf_counter()
    say = progress or (lambda _: None)
    state = _State()
    if plan.diagram is not None:
        say(f"diagram in {plan.diagram.parameter}")
        _explore(plan, plan.diagram, engine, state)
    if plan.phase is not None and not state.stopped:
        say(f"phase diagram in {' and '.join(plan.phase.parameters)}")
        _cut_into_regions(plan, plan.phase, engine, state)
    for run in plan.runs:
        if state.stopped:
            state.skip(f"{run.name} skipped: stopped by the user")
            continue
        say(run.name)
        _carry_out(plan, run, engine, state)
    seconds = time.perf_counter() - began
    nothing_else = not state.branches and state.phase is None and not plan.simulations and plan.sweep is None
    if state.refused and nothing_else and len(state.refused) == len(state.notes):
        raise state.refused[0]
    notes = [*conserved_notes(plan.model), *state.notes]
    return RunResult(state.branches, notes, state.complete, seconds, state.phase, state.stopped, state.diagram)


def _explore(plan: Plan, diagram: DiagramPlan, engine: Engine, state: _State) -> None:
    with _skipping("diagram", state):
        found = engine.diagram(plan.model, diagram, plan.parameters)
        for branch in found.branches:
            state.add(_shown(branch, diagram.spectra))
        state.notes.extend(found.notes)
        state.diagram = found.as_data()
        if found.failed:
            state.complete = False
        if found.stopped:
            state.stop()


def _cut_into_regions(plan: Plan, phase: PhasePlan, engine: Engine, state: _State) -> None:
    with _skipping("phase diagram", state):
        found = engine.phase(plan.model, phase, plan.parameters)
        for branch in found.loci:  # a curve that leads into a degenerate point does not make the diagram incomplete
            state.branches[branch.name] = branch
        state.phase = {**found.as_data(), "notes": list(found.notes)}
        state.notes.extend(found.notes)
        if found.defects:
            state.complete = False
        if found.stopped:
            state.stop()


@contextmanager
def _skipping(what: str, state: _State, as_written: bool = True) -> Iterator[None]:
    """A run that cannot be done is skipped with a note; Ctrl-C keeps what was done.

    as_written : whether it can be done depends on what is written alone, not on what is found.
    """
    try:
        refuse = state.refused.append if as_written else None
        with skipping(lambda text: state.skip(f"{what} skipped: {text}"), refuse):
            yield
    except KeyboardInterrupt:
        state.stop()
        state.skip(f"{what}: stopped by the user")


def _carry_out(plan: Plan, run: RunPlan, engine: Engine, state: _State) -> None:
    written = run.as_ is None or (run.as_ == "connection" and len(run.parameters) == 1)  # whether one is enough
    with _skipping(run.name, state, as_written=run.reference is None and not run.ends and written):
        if run.stored is not None:
            start = engine.start_at_point(run.stored.read(), run.stored.label, run)
        elif run.ends:
            points = {key: _point(run, reference, state) for key, reference in run.ends.items()}
            if None in points.values():
                return
            start = engine.connect(plan.model, run, points, plan.parameters)
        elif run.reference is None:
            start = engine.start(plan.model, run, plan.parameters)
        else:
            start = _from_point(run, run.reference, engine, state)
            if start is None:
                return
        for branch in engine.continuation(start, run):
            state.add(_shown(branch, run.spectra))


def _shown(branch: Branch, spectra: bool) -> Branch:
    """The branch, with its eigenvalues among the columns if a picture shows them."""
    return replace(branch, columns={**branch.columns, **spectral_columns(branch)}) if spectra else branch


def _from_point(run: RunPlan, reference: tuple[str, str], engine: Engine, state: _State) -> object:
    """The start at a point of an earlier branch; None, with a note, where there is no such point."""
    point = _point(run, reference, state)
    return None if point is None else engine.start_at_point(state.branches[reference[0]], reference[1], run)


def _point(run: RunPlan, reference: tuple[str, str], state: _State) -> SpecialPoint | None:
    """A labelled point of an earlier branch; None, with a note, where there is none."""
    name, label = reference
    branch = state.branches.get(name)
    if branch is None:
        known = ", ".join(state.branches) or "none"
        state.skip(
            f"{run.name} skipped: it starts from {name}.{label}, and there is no branch {name!r} (branches: {known})"
        )
        return None
    if all(point.label != label for point in branch.points):
        known = ", ".join(point.label for point in branch.points) or "none"
        state.skip(
            f"{run.name} skipped: it starts from {name}.{label}, and {name} has no point {label} (points: {known})"
        )
        return None
    return branch[label]
