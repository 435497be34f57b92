"""Periodic orbits at fixed parameters, where branches may start."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from contin.abi import Array
from contin.api.fixed_totals import for_branches, is_auto, named_start, named_table
from contin.api.frames import frame_for, samples_in_frame
from contin.api.machine_code import compiled, for_orbits
from contin.api.requirements import need_parameters
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.lazy import module
from contin.model.kinds import need_model, need_time
from contin.model.model import Model
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.records import Fields, Record
from contin.search.hybrid_orbit import HybridOrbit, hybrid_orbit
from contin.search.large_orbit_from_samples import LargeOrbit, large_orbit_from_samples
from contin.search.orbit_from_samples import orbit_from_samples
from contin.search.shot_orbit import ShotOrbit, orbit_from_return, settled_orbit, shooting_chosen
from contin.simulate.consistent import consistent_start
from contin.symbolic.passes.corotating import of_orbits
from contin.systems.functions.function_problem import DENSE_IN_KERNELS, FunctionProblem


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
) -> PeriodicOrbit | ShotOrbit | HybridOrbit | LargeOrbit:
    """A periodic orbit at fixed parameters: the start of a continuation.

    Of a flow with `events`: the orbit, with its jumps, that the simulation from `start` settles on.

    method : 'collocation' or 'shooting'; by default collocation, shooting where the flow is piecewise smooth.

    start : a named start or mapping of states, from which the trajectory is integrated until it returns (after
    `transient`);
        or an array (K, n) of states over one period, the last row the first again, at `times` (K,) or, with `period`,
        at equal times.
        A sparse function of more than 1,000 states starts from an array, of `simulate(..., method="BDF")`.
    intervals, points : of the mesh; by default as many intervals as the error needs, with 4 Gauss points each. By
        shooting: intervals is the number of segments.

    In a model that declares a rotation the orbit is looked for first in the frame that turns with the state: there an
    orbit that returns turned by an angle (a relative periodic orbit) is periodic, and its multipliers are those of the
    full space without the ones of the rotation.

    Raises NoSolutionError where the trajectory comes to rest or does not return, NotFiniteError where it escapes.
    """
    _need_flow(model)
    if isinstance(model, Model) and model.events:
        return _with_events(model, start, parameters, transient)
    if isinstance(start, str) and is_auto(model, start):
        return _auto_orbit(model, parameters)
    reduced = for_branches(model)
    if isinstance(start, np.ndarray):
        start, parameters = named_table(model, reduced, start, parameters)
    else:
        start = named_start(model, start)
    model = reduced
    need_parameters(model)
    if isinstance(start, np.ndarray):
        return _through_samples(model, start, parameters, period, times, method, intervals, points)
    u, p = model.start_point(start, dict(parameters or {}))

    def settled(model: Model, u: Array) -> PeriodicOrbit | ShotOrbit:
        system, periods = for_orbits(model), np.asarray(model.periods(), dtype=float)
        u = consistent_start(system, u, p)
        options: Fields = {"method": method, "transient": transient, "intervals": intervals, "points": points}
        return settled_orbit(system, u, p, periods, **options)

    turning, turned = frame_for(model, u, p)
    if turning is not model:
        with suppress(NoSolutionError, NotFiniteError):  # a rotating wave is an orbit at rest in its frame
            return settled(of_orbits(turning), turned)
    return settled(of_orbits(model), u)


def _need_flow(model: Any) -> None:
    """Refuses what is no model, models without time, and maps."""
    need_model(model)
    need_time(model, "periodic orbits")
    if getattr(model, "kind", "flow") == "map":
        raise InputError(
            f"model {model.name!r} is a map, whose cycles are fixed points of its iterates: start from the one that "
            "iterates settle on (`as: orbit` in a run, contin.find_start), or at a PD of a shorter one"
        )


def _with_events(model: Model, start: Any, parameters: Record | None, transient: float) -> HybridOrbit:
    """The orbit that a simulation with jumps settles on."""
    need_parameters(model)
    if isinstance(start, np.ndarray) or is_auto(model, start):
        raise InputError(
            f"model {model.name!r} has `events`: its orbits start from a simulation. Give a named start or a mapping "
            "of states, and perhaps transient"
        )
    if model.uses_time:
        raise InputError(
            f"model {model.name!r} uses the time t without `forcing`, so it can only be simulated: declare "
            "`forcing: {period: ...}` where it is periodic in t"
        )
    u, p = model.start_point(named_start(model, start), dict(parameters or {}))
    return hybrid_orbit(model, u, p, transient)


def _through_samples(
    model: Any, start: Array, parameters: Record | None, period: float | None, times: Any, method: str | None,
    intervals: int | None, points: int,
) -> PeriodicOrbit | ShotOrbit | LargeOrbit:  # fmt: skip
    """The orbit through states (K, n) over one period."""
    if period is None and times is None:
        raise InputError("an array of states over one period needs its period: periodic_orbit(model, u, period=...)")
    t = np.linspace(0.0, period or 0.0, len(start)) if times is None else np.asarray(times, dtype=float)
    if t.shape != (len(start),):
        raise InputError(f"`times` must have one entry for each of the {len(start)} rows; got shape {t.shape}")
    _, p = model.start_point(None, dict(parameters or {}))
    model, start = samples_in_frame(model, start, p)
    periods = np.asarray(model.periods(), dtype=float)
    if isinstance(model, FunctionProblem) and _is_large(model):
        return large_orbit_from_samples(compiled(model), t, start, p, method, intervals)
    if shooting_chosen(for_orbits(model), method):
        return orbit_from_return(for_orbits(model), start[0], p, periods, float(t[-1] - t[0]), 1, intervals)
    return orbit_from_samples(for_orbits(model), t, start, p, periods, intervals, points)


def _is_large(model: FunctionProblem) -> bool:
    """Whether its orbits are those of large systems: many states, or a mass matrix that cannot be divided by."""
    if model.method != "sparse":
        return False
    return model.n > DENSE_IN_KERNELS or model.has_singular_mass


def _auto_orbit(model: Any, parameters: Record | None) -> PeriodicOrbit | ShotOrbit:
    found = module("auto start").find_start(model, parameters, deflate=False)
    if not isinstance(found.solution, PeriodicOrbit | ShotOrbit):
        raise NoSolutionError(f"no periodic orbit from the given state: {found.words}, at {found.solution}")
    return found.solution
