"""Stable orbits that no family on a line leads to, found from where unstable equilibria send trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.departure import Seed
from contin.diagram.identity import wrapped
from contin.diagram.orbits import known_orbit
from contin.diagram.phase.states import State
from contin.errors import ContinError

PUSH: Final = 1e-2  # length of the perturbation along an unstable direction, relative to the states' sizes
LONGEST: Final = 4000.0  # time scales until a trajectory is given up
TRANSIENT, STEPS = 300.0, 20_000  # time scales of the first look, which must not take more steps (or escapes)
ARRIVED: Final = 1e-3  # distance (relative) from a stable equilibrium at which a trajectory has reached it
TRIED: Final = 6  # trajectories at one point of the box


def orbits_reached(problem: Any, states: Sequence[State], value: float) -> list[Seed]:
    """Families of stable orbits, in the parameter of `problem`, on which trajectories settle that leave `states`.

    `problem` : of the equilibria on the line.  `states` : all that is known where its parameter has this value.
    Trajectories start beside every unstable equilibrium, on both sides along its most unstable direction.
    """
    from contin.problems.orbits.simulation import orbit_by_simulation, time_scale
    from contin.simulate.trajectory import integrate

    if problem.system.n_switches:  # families of piecewise-smooth flows are found from Hopf points only
        return []
    p = problem.full_parameters(np.append(np.zeros(problem.n), value))[: len(problem.base)]
    periods = np.asarray(problem.angle_periods, dtype=float)
    known = [state.orbit for state in states if state.orbit is not None]
    found: list[Seed] = []
    for u in _pushed(problem, states, value)[:TRIED]:
        with suppress(ContinError, np.linalg.LinAlgError):
            scale = time_scale(problem.system, u, p)
            end = integrate(problem.system, u, p, TRANSIENT * scale, rtol=1e-8, atol=1e-10, budget=STEPS).end
            if _at_rest(end, states, periods):
                continue
            orbit = orbit_by_simulation(problem.system, end, p, periods, longest=LONGEST)
            seed = orbit.seed(problem.parameters[0])
            if known_orbit(seed.problem, seed.z, known) is None:
                known.append((seed.problem, seed.z))
                found.append(seed)
    return found


def carried(family: Branch, names: tuple[str, str], values: tuple[float, float], search: Any) -> list[Seed]:
    """Orbits of a family in the first parameter, followed in the second one to another point of the box."""
    from contin.continuation.trace import trace

    problem: Any = family.problem
    first, second = values
    column = family.z[:, -1] - first
    found: list[Seed] = []
    for row in np.flatnonzero(column[:-1] * column[1:] <= 0.0):
        z = family.z[row][~np.isnan(family.z[row])]
        z = problem.at_parameter(z, first, problem.initial_scale(z, search.box[0]))
        if z is None:
            continue
        across = problem.with_active(names[1], z)
        here = float(across.base[across.active])
        start = np.append(z[:-1], here)
        if here != second:
            bounds = min(here, second), max(here, second)
            try:
                way = trace(Seed(across, start, arms=(1 if second > here else -1,)), bounds, settings=search.settings)
            except ContinError:
                continue
            last = way.z[-1 if second > here else 0]
            if abs(float(last[-1]) - second) > 1e-9 * max(1.0, abs(second)):
                continue
            start = last[~np.isnan(last)]
        along = across.with_active(names[0], start)
        found.append(Seed(along, np.append(start[:-1], first)))
    return found


def _at_rest(u: Array, states: Sequence[State], periods: Array) -> bool:
    """True near a stable equilibrium."""
    rests = [state.vector for state in states if state.orbit is None and state.unstable == 0]
    size = max((float(np.abs(v).max()) for v in rests), default=1.0)
    return any(float(np.abs(wrapped(u - v, periods)).max()) < ARRIVED * size for v in rests)


def _pushed(problem: Any, states: Sequence[State], value: float) -> list[Array]:
    """Starts beside the unstable equilibria, the most unstable ones first."""
    starts: list[tuple[float, Array]] = []
    for state in states:
        if state.orbit is not None or state.unstable == 0:
            continue
        values, vectors = np.linalg.eig(problem.linear_part(np.append(state.vector, value)))
        k = int(np.argmax(values.real))
        q = np.real(vectors[:, k])
        size = max(float(np.abs(state.vector).max()), 1e-3)
        step = PUSH * size * q / max(float(np.abs(q).max()), 1e-300)
        starts += [(-float(values[k].real), state.vector + sign * step) for sign in (1.0, -1.0)]
    return [u for _, u in sorted(starts, key=lambda item: item[0])]
