"""The verbs of contin as the executor calls them: the only place where run files meet the numerical engine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Protocol

from contin.continuation.branch import Branch
from contin.continuation.seed import Seed
from contin.diagram.images import images
from contin.errors import InputError
from contin.records import Record
from contin.special.table import special_type

if TYPE_CHECKING:
    from types import ModuleType

    from contin.continuation.journal import Journal
    from contin.model.model import Model
    from contin.runs.plans import DiagramPlan, PhasePlan, RunPlan

Watcher = Callable[[Record], None]


class Found(Protocol):
    """What the explorer returns."""

    @property
    def branches(self) -> Iterable[Branch]: ...

    @property
    def notes(self) -> Sequence[str]: ...

    @property
    def stopped(self) -> bool: ...

    @property
    def failed(self) -> Sequence[str]: ...

    def as_data(self) -> Record: ...


class FoundPhase(Protocol):
    """What a phase diagram consists of."""

    @property
    def loci(self) -> Iterable[Branch]: ...

    @property
    def notes(self) -> Sequence[str]: ...

    @property
    def defects(self) -> Sequence[str]: ...

    @property
    def stopped(self) -> bool: ...

    def as_data(self) -> Record: ...


class Engine(Protocol):
    """What the executor needs; tests put a double in its place."""

    def prepare(self, model: Model) -> None:
        """Make the model's machine code: what is not part of any run."""

    def start(self, model: Model, run: RunPlan, parameters: Record) -> Any:
        """The start of a run from the model's starts."""

    def start_at_point(self, branch: Branch, label: str, run: RunPlan) -> object:
        """The start of a run from a labelled point of a branch."""

    def connect(self, model: Model, run: RunPlan, points: Mapping[str, Any], parameters: Record) -> object:
        """The start of a connecting orbit with cycles (labelled points) at its ends `start`, `to`."""

    def continuation(self, start: object, run: RunPlan) -> Iterable[Branch]:
        """The branch and its images under declared symmetries; several where several branches start at the point."""

    def diagram(self, model: Model, diagram: DiagramPlan, parameters: Record) -> Found:
        """Everything that is connected to the starts."""

    def phase(self, model: Model, phase: PhasePlan, parameters: Record) -> FoundPhase:
        """The curves and regions of a phase diagram."""


class ContinEngine:
    """The engine of this package; `watch` is called after every chunk."""

    def __init__(self, watch: Watcher | None = None, journal: Journal | None = None) -> None:
        self.watch, self.journal = watch, journal

    def load(self) -> None:
        """Import the numerical part; otherwise the first run does."""
        _ = _verbs().continuation

    def prepare(self, model: Model) -> None:
        _verbs().prepare(model)

    def start(self, model: Model, run: RunPlan, parameters: Record) -> Any:
        api = _verbs()
        if model.interval is not None:
            return api.boundary_problem(model, run.start, parameters, free=run.free, samples=_table(run.samples))
        if run.as_ == "orbit" and model.kind == "map" and run.samples is None:
            return api.find_start(model, parameters, run.start)  # the cycle that its iterates settle on
        if run.as_ == "orbit":
            mesh = {key: run.settings[key] for key in ("intervals", "points", "method") if key in run.settings}
            if run.samples is not None:
                return api.periodic_orbit(model, run.samples.states, parameters, times=run.samples.times, **mesh)
            return api.periodic_orbit(model, run.start, parameters, **mesh)
        if run.as_ == "manifold":
            return api.manifold(model, run.start, parameters, name=run.name, **run.manifold)
        if run.as_ == "torus":
            return api.torus(
                model, run.parameters, run.range, start=run.start, parameters=parameters, direction=run.direction,
                name=run.name, settings=run.settings,
            )  # fmt: skip
        if run.as_ == "connection":
            along = _table(run.samples)
            return api.connection(model, run.start, run.to, parameters, samples=along, **run.connecting)
        if run.as_ is None:
            return api.solution(model, run.start, parameters)
        return api.equilibrium(model, run.start, parameters)

    def start_at_point(self, branch: Branch, label: str, run: RunPlan) -> object:
        point: Any = branch[label]
        if run.as_ == "manifold":
            return _verbs().manifold(point, name=run.name, **run.manifold)
        if run.as_ == "torus":
            return _verbs().torus(point, run.parameters, run.range, name=run.name, settings=run.settings)
        if run.as_ == "connection":
            return _verbs().connection(point, run.start, run.to, **run.connecting)
        if len(run.parameters) == 1 and _goes_on(branch, point, run):
            return _same_solution(branch, point, run)
        if branch.kind == "bvp" and run.free and set(run.free) != set(point.problem.free_names):
            raise InputError(
                f"{run.name}: what is born at {branch.name}.{label} has the free parameters of its parent "
                f"({', '.join(point.problem.free_names) or 'none'}); leave out `free`, or start from a user value"
            )
        return point.locus(run.parameters) if len(run.parameters) > 1 else point.switch(run.parameters[0])

    def connect(self, model: Model, run: RunPlan, points: Mapping[str, Any], parameters: Record) -> object:
        first, last = points.get("start", run.start), points.get("to", run.to)
        return _verbs().connection(model, first, last, parameters, samples=_table(run.samples), **run.connecting)

    def continuation(self, start: object, run: RunPlan) -> Iterable[Branch]:
        if isinstance(start, Branch):  # a manifold, at fixed parameters, or a family of tori
            yield self._kept(start)
            return
        parameter = run.parameters[0] if len(run.parameters) == 1 else run.parameters
        seeds = start if isinstance(start, list) else [start]
        for position, seed in enumerate(seeds):
            branch: Branch = _verbs().continuation(
                seed,
                parameter,
                run.range,
                name=run.name if position == 0 else f"{run.name}.{position + 1}",  # as the explorer names them
                direction=run.direction,
                values=run.values,
                extrema=run.extrema,
                columns=run.columns,
                shown=run.recorded,
                conditions=run.conditions,
                free=run.free if run.conditions else (),
                settings=run.settings,
                watch=self.watch,
                journal=self.journal,
            )
            yield self._kept(branch)
            for image in images(branch):
                yield self._kept(image)

    def _kept(self, branch: Branch) -> Branch:
        """The branch, in the journal before the next one begins."""
        if self.journal is not None:
            self.journal.finished(branch)
        return branch

    def diagram(self, model: Model, diagram: DiagramPlan, parameters: Record) -> Found:
        found: Found = _verbs().diagram(
            model,
            diagram.parameter,
            diagram.range,
            start=list(diagram.starts),
            box=diagram.box,
            parameters=parameters,
            orbits=diagram.orbits,
            values=diagram.values,
            columns=diagram.columns,
            settings=diagram.settings,
            budget=diagram.budget,
            watch=self.watch,
            journal=self.journal,
        )
        return found

    def phase(self, model: Model, phase: PhasePlan, parameters: Record) -> FoundPhase:
        found: FoundPhase = _verbs().phase(
            model,
            phase.parameters,
            phase.range,
            start=list(phase.starts),
            parameters=parameters,
            orbits=phase.orbits,
            settings=phase.settings,
            watch=self.watch,
            journal=self.journal,
        )
        return found


def _table(samples: Any) -> Any:
    return None if samples is None else (samples.times, samples.states)


# kinds of branch that others of the kind leave
_BRANCHING: Final = ("equilibrium", "algebraic", "fixed-point", "orbit", "bvp")


def _goes_on(branch: Branch, point: Any, run: RunPlan) -> bool:
    """True where a run from a point means the solution there, not a branch that is born there.

    That is so at a user value and at an extremum; at other points where no branch of this kind is born, if another
    parameter varies or `as:` names the kind of the branch.
    """
    if branch.kind not in _BRANCHING or branch.kind in special_type(point.type).continues:
        return False
    kind = "orbit" if branch.kind == "orbit" else "equilibrium"
    if run.as_ is not None or point.type in ("UZ", "EX"):
        return run.as_ in (None, kind)
    return point.type != "HB" and run.parameters[0] != branch.parameters[0]


def _same_solution(branch: Branch, point: Any, run: RunPlan) -> Any:
    """The start of a run at the solution that a point is, with any parameter varying and any others solved for."""
    problem, parameter = point.problem, run.parameters[0]
    if branch.kind == "bvp" and run.free and set(run.free) != set(problem.free_names):
        return Seed(*problem.with_free(run.free, parameter, point.z, point.values))
    problem = problem.with_active(parameter, point.z)
    z = point.z.copy()
    z[-1] = point.values[parameter]
    return Seed(problem, z)


def _verbs() -> ModuleType:
    """`contin.api`, imported when the first run begins: it brings the compiled kernels."""
    from contin import api

    return api
