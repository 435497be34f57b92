"""Solutions at fixed parameters, where branches may start: equilibria, periodic and connecting orbits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.api.machine_code import compiled
from contin.errors import InputError, NotFiniteError
from contin.model.kinds import need_states, need_time
from contin.problems.deflation import FoundEquilibrium, find, make_box
from contin.problems.functions.problem import FunctionProblem
from contin.problems.orbits.homoclinic.shooting import ConnectingOrbit
from contin.problems.orbits.samples import orbit_from_samples
from contin.problems.orbits.start import PeriodicOrbit
from contin.problems.shooting.start import ShotOrbit, orbit_from_return, settled_orbit, shooting_chosen
from contin.problems.sparse.from_model import sparse_function
from contin.problems.sparse.start import LargeEquilibrium, converge_large
from contin.problems.start import Equilibrium, converge
from contin.records import Record
from contin.simulate.natural import natural_metric
from contin.symbolic.passes.corotating import frame_for
from contin.systems.iterate import iterate

if TYPE_CHECKING:
    from contin.model.model import Model


def equilibrium(
    model: Any,
    start: str | Record | None = None,
    parameters: Record | None = None,
    *,
    period: int = 1,
) -> Any:
    """Solve f(u, p) = 0 (a map: f(u, p) = u) by Newton from a named start, a mapping of states, or the states' values.

    period : of a cycle of a map: f(...f(f(u, p), p)..., p) = u.

    In a model that declares a rotation, a start that it moves leads to a rotating wave (relative equilibrium);
    it is solved, and continued, in the frame that turns with it (`contin.symbolic.passes.corotating`).

    Raises NoSolutionError (with the residual history and the nearest point) and NotFiniteError (naming the equation).
    """
    _need_parameters(model)
    refuse_forced(model)
    need_states(model, "equilibria")
    u, p = model.start_point(start, dict(parameters or {}))
    model, u = frame_for(model, u, p)
    if isinstance(model, FunctionProblem) and model.method != "dense":
        return _large_equilibrium(model, u, p, period)
    sparse = sparse_function(model, u, p) if period == 1 else None
    if sparse is not None:
        return converge_large(sparse.system(), u, p)
    system = compiled(model) if period == 1 else iterate(compiled(model), period)
    try:
        return converge(system, u, p, np.asarray(model.periods(), dtype=float))
    except NotFiniteError as error:
        advice = [s.beyond for s, x in zip(getattr(model, "states", ()), u, strict=False) if s.beyond and x == 0.0]
        raise NotFiniteError(". ".join([str(error), *advice[:1]])) from None


def _large_equilibrium(model: FunctionProblem, u: Any, p: Any, period: int) -> LargeEquilibrium:
    """An equilibrium of a function with a sparse or matrix-free Jacobian."""
    if model.kind == "map" or period != 1:
        raise InputError("maps need a dense Jacobian; sparse and matrix-free ones are for equilibria of flows")
    return converge_large(compiled(model), u, p)


def periodic_orbit(
    model: Any,
    start: Any = None,
    parameters: Record | None = None,
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
    _need_parameters(model)
    need_time(model, "periodic orbits")
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
    model: Model,
    first: str | Record,
    last: str | Record | None = None,
    parameters: Record | None = None,
) -> ConnectingOrbit:
    """The start of a curve, in two parameters, of orbits that lead from one saddle to another.

    first, last : named starts or mappings of states, from which the saddles are solved; without `last` the orbits
    return to the first one (homoclinic). At the parameters a trajectory that leaves the first saddle must pass near the
    second one. `continuation(..., (p, q), ranges)` then solves for the orbit at the present value of q.
    """
    need_time(model, "connecting orbits")
    saddles = [equilibrium(model, one, parameters) for one in (first, first if last is None else last)]
    if any(not isinstance(saddle, Equilibrium) for saddle in saddles) or saddles[0].system.kind == "map":
        raise InputError("connecting orbits need a flow given by formulas")
    return ConnectingOrbit(saddles[0].system, saddles[0].p, np.array([saddle.u for saddle in saddles]))


def find_equilibria(
    model: Any,
    box: Mapping[str, Sequence[float]] | Sequence[float] | None = None,
    parameters: Record | None = None,
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
    _need_parameters(model)
    refuse_forced(model)
    need_states(model, "equilibria")
    system = compiled(model)
    _, p = model.start_point(None, dict(parameters or {}))
    periods = np.asarray(model.periods(dict(parameters or {})), dtype=float)
    wanted = box if box is not None else reach_of(model, parameters)
    return find(system, make_box(system.state_names, wanted, periods), p, starts)


def _need_parameters(model: Model) -> None:
    """A solution is one of a branch, whose last unknown is a parameter."""
    if not model.parameter_names:
        raise InputError(
            f"model {model.name!r} has no parameters, and so no branches of solutions: declare one, such as "
            "parameters: {p: 0}; trajectories need none (`contin simulate`)"
        )


def refuse_forced(model: Model) -> None:
    """Raises InputError for a flow whose equations know the time: it has no equilibria."""
    if getattr(model, "forcing", None) is not None:
        raise InputError(
            f"model {model.name!r} is forced periodically and has no equilibria: its periodic responses are followed "
            "by a diagram, by contin.periodic_orbit in Python, and by `as: orbit` in a run file"
        )


USUAL: Final = 0.5  # half of the box of a state about which nothing is known
RESOLVED: Final = 1e-3  # part of the box that a search tells from a point: it takes 1e-6 of it for the same


def reach_of(model: Any, parameters: Record | None = None) -> dict[str, tuple[float, float]]:
    """Twice the largest size of each state in the model's default and named starts, in both directions.

    Where all are 0, the natural sizes of the states, if these are far from 1.

    Angles apart.
    """
    names = (None, *(s.name for s in model.starts))
    points = [model.start_point(name, dict(parameters or {}))[0] for name in names]
    largest = np.abs(np.array(points)).max(axis=0)
    usual = np.full(len(largest), max(float(largest.max(initial=0.0)), USUAL))
    if not largest.any():  # only the equations tell; sizes that a search of the usual box would see need no other
        system, (u, p) = compiled(model), model.start_point(None, dict(parameters or {}))
        natural = natural_metric(system, u, p)
        known = ~np.isin(model.state_names, natural.guessed)
        unseen = (natural.states < RESOLVED * usual) | (natural.states > usual / RESOLVED)
        usual = np.where(known & unseen, natural.states, usual)
    sizes = 2.0 * np.where(largest > 0.0, largest, usual)
    angles = np.asarray(model.periods()) > 0.0
    return {
        name: (-float(size), float(size))
        for name, size, angle in zip(model.state_names, sizes, angles, strict=True)
        if not angle
    }
