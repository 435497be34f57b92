"""The verbs of contin: equilibrium, continuation, walk."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np

from contin.continuation.branch import Branch, End, LocusStart
from contin.continuation.departure import Seed, depart
from contin.continuation.journal import Journal
from contin.continuation.rows import Rows
from contin.continuation.settings import Settings
from contin.continuation.targets import Target
from contin.continuation.trace import Watcher, followed, trace
from contin.errors import ContinError, InputError, NoSolutionError, NotFiniteError
from contin.model.model import Model
from contin.problems.deflation import FoundEquilibrium
from contin.problems.functions.problem import FunctionProblem
from contin.problems.maps.iterate import iterate
from contin.problems.orbits.homoclinic.shooting import ConnectingOrbit
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.orbits.start import PeriodicOrbit
from contin.problems.shooting.problem import ShootingProblem
from contin.problems.shooting.start import ShotOrbit, orbit_from_return, settled_orbit, shooting_chosen
from contin.problems.sparse.start import LargeEquilibrium, converge_large
from contin.problems.start import Equilibrium, converge

Range: TypeAlias = tuple[float, float] | Sequence[float] | Mapping[str, Sequence[float]]
EVERYWHERE = "all"  # the start of a diagram that stands for all equilibria
_compiled: WeakKeyDictionary[Any, Any] = WeakKeyDictionary()


def compiled(model: Any) -> Any:
    """The machine code of a model (of a user function: its derivatives), made once per model object."""
    from contin.lowering import compile_system

    try:
        return _compiled[model]
    except (KeyError, TypeError):
        system = model.system() if isinstance(model, FunctionProblem) else compile_system(model)
        with suppress(TypeError):  # an object that cannot be a weak key is compiled anew
            _compiled[model] = system
        return system


def equilibrium(
    model: Any,
    start: str | Mapping[str, Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    *,
    period: int = 1,
) -> Any:
    """Solve f(u, p) = 0 (a map: f(u, p) = u) by Newton from a named start, a mapping of states, or the states' values.

    period : of a cycle of a map: f(...f(f(u, p), p)..., p) = u.

    In a model that declares a rotation, a start that it moves leads to a rotating wave (relative equilibrium);
    it is solved, and continued, in the frame that turns with it (`contin.symbolic.corotating`).

    Raises NoSolutionError (with the residual history and the nearest point) and NotFiniteError (naming the equation).
    """
    from contin.symbolic.corotating import frame_for

    u, p = model.start_point(start, dict(parameters or {}))
    model, u = frame_for(model, u, p)
    if isinstance(model, FunctionProblem) and model.method != "dense":
        return large_equilibrium(model, u, p, period)
    system = compiled(model) if period == 1 else iterate(compiled(model), period)
    try:
        return converge(system, u, p, np.asarray(model.periods(), dtype=float))
    except NotFiniteError as error:
        advice = [s.beyond for s, x in zip(getattr(model, "states", ()), u, strict=False) if s.beyond and x == 0.0]
        raise NotFiniteError(". ".join([str(error), *advice[:1]])) from None


def large_equilibrium(model: FunctionProblem, u: Any, p: Any, period: int) -> LargeEquilibrium:
    """An equilibrium of a function with a sparse or matrix-free Jacobian."""
    if model.kind == "map" or period != 1:
        raise InputError("maps need a dense Jacobian; sparse and matrix-free ones are for equilibria of flows")
    return converge_large(compiled(model), u, p)


def periodic_orbit(
    model: Any,
    start: Any = None,
    parameters: Mapping[str, Any] | None = None,
    *,
    period: float | None = None,
    times: Any = None,
    transient: float = 0.0,
    intervals: int | None = None,
    points: int = 4,
    method: str | None = None,
) -> PeriodicOrbit | ShotOrbit:
    """A periodic orbit at fixed parameters: the start of a continuation.

    method : 'collocation' or 'shooting'; by default collocation, shooting where the flow is piecewise smooth.

    start : a named start or mapping of states, from which the trajectory is integrated until it returns (after
    `transient`);
        or an array (K, n) of states over one period, the last row the first again, at `times` (K,) or, with `period`,
        at equal times.
    intervals, points : of the mesh; by default as many intervals as the error needs, with 4 Gauss points each. By
        shooting: intervals is the number of segments.

    Raises NoSolutionError where the trajectory comes to rest or does not return, NotFiniteError where it escapes.
    """
    from contin.problems.orbits.samples import orbit_from_samples

    if isinstance(start, np.ndarray):
        if period is None and times is None:
            raise InputError(
                "an array of states over one period needs its period: periodic_orbit(model, u, period=...)"
            )
        t = np.linspace(0.0, period or 0.0, len(start)) if times is None else np.asarray(times, dtype=float)
        if t.shape != (len(start),):
            raise InputError(f"`times` must have one entry for each of the {len(start)} rows; got shape {t.shape}")
        _, p = model.start_point(None, dict(parameters or {}))
        periods = np.asarray(model.periods(), dtype=float)
        if shooting_chosen(compiled(model), method):
            return orbit_from_return(compiled(model), start[0], p, periods, float(t[-1] - t[0]), 1, intervals)
        return orbit_from_samples(compiled(model), t, start, p, periods, intervals, points)
    u, p = model.start_point(start, dict(parameters or {}))
    periods = np.asarray(model.periods(), dtype=float)
    return settled_orbit(
        compiled(model), u, p, periods, method=method, transient=transient, intervals=intervals, points=points
    )


def connecting_orbit(
    model: Any,
    first: str | Mapping[str, Any],
    last: str | Mapping[str, Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
) -> ConnectingOrbit:
    """The start of a curve, in two parameters, of orbits that lead from one saddle to another.

    first, last : named starts or mappings of states, from which the saddles are solved; without `last` the orbits
    return to the first one (homoclinic). At the parameters a trajectory that leaves the first saddle must pass near the
    second one. `continuation(..., (p, q), ranges)` then solves for the orbit at the present value of q.
    """
    saddles = [equilibrium(model, one, parameters) for one in (first, first if last is None else last)]
    if any(not isinstance(saddle, Equilibrium) for saddle in saddles) or saddles[0].system.kind == "map":
        raise InputError("connecting orbits need a flow given by formulas")
    return ConnectingOrbit(saddles[0].system, saddles[0].p, np.array([saddle.u for saddle in saddles]))


def continuation(
    start: Any,
    parameter: str | Sequence[str],
    range: Range | None = None,
    *,
    name: str = "branch",
    direction: str = "both",
    values: Mapping[str, Sequence[float]] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
    watch: Watcher | None = None,
    journal: Journal | None = None,
) -> Branch:
    """Follow the branch through `start` while `parameter` varies in `range`, and label its special points.

    start : an `Equilibrium`, a model (solved from the states' values, or u0 of a `FunctionProblem`), or a seed from
        `point.switch()`; of a list of seeds the first is followed.
        A curve of special points in two parameters starts from `point.locus()`, with the pair of names for `parameter`.
    range : (lo, hi), for two parameters {name: (lo, hi)}; default the range that the model gives for the parameter.
    direction : 'up' or 'down' follows one arm only, in the sense in which the parameter changes on leaving the start.
    values : {column: [values]} marks these values of the parameter, a state or an observable as UZ points.
    watch : called with a mapping (parameter, value, fraction, rows, labels) after every chunk.
    journal : keeps every chunk, and answers with those of an earlier, killed run (see `contin.continuation.journal`).
    """
    seed, bounds = placed(start, parameter, range)
    chosen = Settings.of(settings)
    senses = {"both": (-1, 1), "up": (1,), "down": (-1,)}
    if direction not in senses:
        raise InputError(f"direction must be 'up', 'down' or 'both'; got {direction!r}")
    if not seed.born:
        seed = replace(seed, arms=senses[direction])
    return trace(
        seed,
        bounds,
        name=name,
        settings=chosen,
        targets=targets_of(seed.problem, values),
        watch=watch,
        journal=journal,
    )


def walk(
    start: Any,
    parameter: str,
    range: Range | None = None,
    *,
    direction: str = "up",
    values: Mapping[str, Sequence[float]] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
) -> Iterator[dict[str, Any]]:
    """The points of one arm as they are computed: mappings of columns, with `label` (a type such as 'LP', or None).

    The start is not repeated. Computing goes chunk by chunk, a little ahead of what is taken; stop whenever you like.
    """
    if direction not in ("up", "down"):
        raise InputError(f"a walk goes one way: direction must be 'up' or 'down'; got {direction!r}")
    seed = as_seed(start, parameter)
    problem = seed.problem
    departure = depart(seed, bounds_of(problem, parameter, range), Settings.of(settings))
    seed, problem = departure.seed, departure.seed.problem
    ready = departure.arm(1 if direction == "up" else -1, targets_of(problem, values))
    if isinstance(ready, End):
        return
    arm, pieces = ready
    for piece in chain(pieces, followed(arm, seed.z)):
        rows = Rows()
        rows.add_piece(piece)
        if not len(rows):
            continue
        (z, _, unstable, _), _ = rows.joined(0)
        columns = problem.columns(z)
        labels = {row: point.type for row, point, _ in rows.labelled}
        for k in np.arange(len(z)):
            point = {key: column[k].item() for key, column in columns.items()}
            yield {"label": labels.get(int(k)), **point, "unstable": int(unstable[k]), "stable": bool(unstable[k] == 0)}


def placed(start: Any, parameter: str | Sequence[str], range: Range | None) -> tuple[Seed, tuple[float, float]]:
    """What can start a continuation, as a seed within its bounds: those of the (first) parameter are returned too."""
    names = (parameter,) if isinstance(parameter, str) else tuple(parameter)
    if len(names) == 1:
        seed = as_seed(start, names[0])
        return seed, bounds_of(seed.problem, names[0], range)
    if isinstance(start, LocusStart):
        start = start.point.locus(names)
    elif isinstance(start, ConnectingOrbit):
        start = start.locus((names[0], names[1]))
    seed = start[0] if isinstance(start, list) and start else start
    if not isinstance(seed, Seed) or tuple(seed.problem.parameters) != names:
        raise InputError(
            f"a curve in {', '.join(names)} starts from a labelled point: pass point.locus(), and the pair as parameter"
        )
    if range is not None and not isinstance(range, Mapping):
        raise InputError(f"two parameters need a range each: {{{names[0]!r}: (lo, hi), {names[1]!r}: (lo, hi)}}")
    first, second = (bounds_of(seed.problem, name, range) for name in names)
    return replace(seed, problem=seed.problem.within(first, second)), first  # type: ignore[attr-defined]


def as_seed(start: Any, parameter: str) -> Seed:
    """What can start a continuation, as a seed with `parameter` free."""
    if isinstance(start, list) and start and all(isinstance(s, Seed) for s in start):
        return as_seed(start[0], parameter)
    if isinstance(start, FunctionProblem | Model):
        start = equilibrium(start)
    if isinstance(start, FoundEquilibrium):
        start = start.equilibrium
    if isinstance(start, Seed):
        if start.problem.parameters[0] != parameter:
            raise InputError(
                f"this start varies {start.problem.parameters[0]}; switch with parameter={parameter!r} instead"
            )
        return start
    if isinstance(start, Equilibrium | LargeEquilibrium | PeriodicOrbit | ShotOrbit):
        known = list(start.system.parameter_names)
        if parameter not in known:
            raise InputError(f"no parameter {parameter!r}; the model has {', '.join(known) or 'none'}")
        return start.seed(parameter)
    raise InputError(f"a continuation starts from an equilibrium or a switched point; got {type(start).__name__}")


def bounds_of(problem: Any, parameter: str, given: Range | None) -> tuple[float, float]:
    """(lo, hi) from a pair, a mapping {parameter: pair}, or the model's own range."""
    if isinstance(given, Mapping):
        given = given.get(parameter)
    if given is None:
        given = problem.default_range(parameter)
    if given is None:
        raise InputError(f"range: say how far {parameter} may vary, e.g. range: [0, 1]; the model gives none")
    lo, hi = (float(x) for x in given)
    return lo, hi


def targets_of(problem: Any, values: Mapping[str, Sequence[float]] | None) -> list[Target]:
    """User values as targets; every name must be a column of the branch."""
    if isinstance(problem, OrbitProblem | ShootingProblem):
        known = set(problem.column_names())
    else:
        known = {*problem.parameters, *problem.system.state_names, *problem.system.observable_names}
    targets = []
    for column, wanted in (values or {}).items():
        if column not in known:
            raise InputError(f"values: unknown column {column!r}; known: {', '.join(sorted(known))}")
        targets += [Target(column, float(v)) for v in wanted]
    return targets


def diagram(
    model: Any,
    parameter: str,
    range: Range | None = None,
    *,
    start: Any = None,
    box: Any = None,
    parameters: Mapping[str, Any] | None = None,
    orbits: bool = True,
    values: Mapping[str, Sequence[float]] | None = None,
    settings: Settings | Mapping[str, Any] | None = None,
    budget: Any = None,
    watch: Watcher | None = None,
    journal: Journal | None = None,
) -> Any:
    """Follow every branch that is reachable from the starts through special points, each once: a `Diagram`.

    start : a named start, a mapping of states, or a list of them; default the states' values. 'all' (unless the model
        has a start of this name) looks for all equilibria in `box` (see `find_equilibria`), at the parameter's value
        and at some others in the range, so that disconnected branches are found.
    orbits : follow families of periodic orbits from Hopf points too.
    budget : {branches, steps, seconds}: the exploration stops there and says what it left.
    """
    from contin.diagram.explore import Budget, Explorer

    named, everywhere = _named_starts(model, start)
    seeds: list[tuple[str, Seed]] = []
    notes: list[str] = []
    failure: ContinError | None = None
    for name, one in named:
        try:
            seeds.append((name, as_seed(equilibrium(model, one, parameters), parameter)))
        except (NoSolutionError, NotFiniteError) as error:
            notes.append(f"start {name!r}: {error}")
            failure = error
    if not seeds and failure is not None and not everywhere:
        raise failure
    reserve: list[Seed] = []
    if everywhere:
        limits = None if range is None else bounds_of(None, parameter, range)
        reserve = everywhere_in(model, parameter, limits, box, parameters)
    if not seeds and not reserve:
        raise failure or NoSolutionError("no equilibrium found in the box; give a larger box")
    problem = (seeds[0][1] if seeds else reserve[0]).problem
    bounds = bounds_of(problem, parameter, range)
    targets = targets_of(problem, values)
    explorer = Explorer(parameter, bounds, Settings.of(settings), Budget.of(budget), targets, orbits, watch, journal)
    result = explorer.explore(seeds, reserve)
    result.notes[:0] = notes
    return result


def phase(
    model: Any,
    pair: Sequence[str],
    range: Mapping[str, Sequence[float]] | None = None,
    *,
    start: Any = None,
    parameters: Mapping[str, Any] | None = None,
    orbits: bool = True,
    settings: Settings | Mapping[str, Any] | None = None,
    watch: Watcher | None = None,
) -> Any:
    """The phase diagram of a model in two parameters: a `PhaseDiagram` of curves and regions.

    pair : the two names; the first is drawn horizontally.  range : {name: (lo, hi)}, by default the model's own.
    start : a named start, a mapping of states, or a list of them.  parameters : values of the others.
    orbits : periodic orbits and their curves too (LPC, PD, NS, BPC and homoclinic ones), not only equilibria.

    Ctrl-C ends the search: what was computed is returned, with `stopped` true.

    Raises NoSolutionError where no start leads to an equilibrium.
    """
    from contin.diagram.phase.compute import phase as compute

    named, _ = _named_starts(model, start)
    found, failure = [], None
    for _, one in named:
        try:
            found.append(equilibrium(model, one, parameters))
        except (NoSolutionError, NotFiniteError) as error:
            failure = error
    if not found:
        raise failure or NoSolutionError("a phase diagram needs a start")
    if any(not isinstance(e, Equilibrium) for e in found):
        raise InputError("phase diagrams need a model of formulas or a function with a dense Jacobian")
    box = {name: bounds_of(found[0].problem(name), name, range) for name in pair}
    return compute(found, pair, box, settings, watch, orbits)


def _named_starts(model: Any, start: Any) -> tuple[list[tuple[str, Any]], bool]:
    """Starts with their names, and whether all equilibria are wanted too."""
    given = list(start) if isinstance(start, list | tuple) else [start]
    everywhere = any(isinstance(one, str) and one == EVERYWHERE for one in given) and not any(
        s.name == EVERYWHERE for s in model.starts
    )
    if everywhere:
        given = [one for one in given if not (isinstance(one, str) and one == EVERYWHERE)]
    named = []
    for k, one in enumerate(given):
        name = one if isinstance(one, str) else "start" if len(given) == 1 else f"start{k + 1}"
        named.append((name, one))
    return named, everywhere


def find_equilibria(
    model: Any,
    box: Mapping[str, Sequence[float]] | Sequence[float] | None = None,
    parameters: Mapping[str, Any] | None = None,
    *,
    starts: int | None = None,
) -> list[FoundEquilibrium]:
    """Equilibria (fixed points of a map) in a box of states, by deflated Newton from many starts in compiled code.

    box : {state: (lo, hi)}, or (lo, hi) for all states; angles need no bounds. Default: twice as far in both directions
        as the model's states and starts reach.
    starts : number of starting points a round; default so many that a search takes some tenths of a second.
    Solutions are told apart modulo angle periods; those that a declared symmetry makes of another one have `image_of`.
    There is no guarantee that all are found: more `starts` or a smaller box find more.
    """
    from contin.problems.deflation import find, make_box

    system = compiled(model)
    _, p = model.start_point(None, dict(parameters or {}))
    periods = np.asarray(model.periods(dict(parameters or {})), dtype=float)
    wanted = box if box is not None else reach_of(model, parameters)
    return find(system, make_box(system.state_names, wanted, periods), p, starts)


def reach_of(model: Any, parameters: Mapping[str, Any] | None = None) -> dict[str, tuple[float, float]]:
    """Twice the largest size of each state in the model's default and named starts, in both directions.

    Angles apart.
    """
    names = (None, *(s.name for s in model.starts))
    points = [model.start_point(name, dict(parameters or {}))[0] for name in names]
    largest = np.abs(np.array(points)).max(axis=0)
    sizes = 2.0 * np.where(largest > 0.0, largest, max(float(largest.max(initial=0.0)), 0.5))
    angles = np.asarray(model.periods()) > 0.0
    return {
        name: (-float(size), float(size))
        for name, size, angle in zip(model.state_names, sizes, angles, strict=True)
        if not angle
    }


def everywhere_in(
    model: Any, parameter: str, limits: tuple[float, float] | None, box: Any, parameters: Mapping[str, Any] | None
) -> list[Seed]:
    """Seeds of all equilibria found at the parameter's own value and at some values spread over its range."""
    _, p = model.start_point(None, dict(parameters or {}))
    own = float(p[list(model.parameter_names).index(parameter)])
    lo, hi = limits or bounds_of(_Ranges(model), parameter, None)
    spread = lo + (hi - lo) * np.array([0.5, 0.25, 0.75, 0.05, 0.95])
    seeds = []
    for value in ([own] if lo <= own <= hi else []) + spread.tolist():
        found = find_equilibria(model, box, {**(parameters or {}), parameter: value})
        seeds += [as_seed(one, parameter) for one in found if one.isolated]
    return seeds


class _Ranges:
    """The default ranges of a model, for `bounds_of`."""

    def __init__(self, model: Any) -> None:
        self.model = model

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        found: tuple[float, float] | None = self.model.parameter_range(parameter)
        return found
