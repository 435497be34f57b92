"""A periodic orbit with its jumps, sampled over one period; smallest and largest values on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.landed import POLISHED
from contin.problems.hybrid.landing import BUDGET, SMALLER
from contin.simulate.between_samples import DENSE, ends_of_steps, in_parts, resolving
from contin.simulate.extrema import extremes_between
from contin.simulate.flight import fly

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents
    from contin.problems.hybrid.passage import Flown, Passage
    from contin.systems.protocol import System

SAMPLES = 240  # of an orbit
LEAST = 24  # ... and of each arc
FINER = 32
QUADRATURE = 241  # times of each arc
IN_A_STEP = 4  # looks within a step, of which a turn has at least twelve at this accuracy
BOOLE = (7.0 / 90.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0)  # weights of their ends


@dataclass(frozen=True, eq=False)
class HybridProfile:
    """States u (K, n) at the scaled times (K,), 0 to 1, of an orbit; a jump is two rows at one time."""

    u: Array
    times: Array
    period: float
    parameter: float


def sampled(problem: CycleOfEvents, z: Array) -> HybridProfile:
    """The orbit through the solution z; NaN where it is none."""
    names = len(problem.system.state_names)
    passage = problem.passage(z)
    if passage is None:
        return HybridProfile(np.full((2, names), np.nan), np.array([0.0, 1.0]), np.nan, float(z[-1]))
    times, states, begun = [], [], 0.0
    for flown in passage.flown:
        t = _times(problem, z, passage, flown)
        states.append(_states(problem, z, flown, t)[:, :names])
        times.append(begun + t)
        begun += flown.time
    times.append(np.array([begun]))
    states.append(passage.flown[-1].after[None, :names])
    return HybridProfile(np.vstack(states), np.concatenate(times) / begun, begun, float(z[-1]))


def orbit_columns(system: System, orbits: Sequence[tuple[CycleOfEvents, Array]]) -> dict[str, Array]:
    """Period, and smallest and largest value of every state and observable, of N orbits z of their problems."""
    passages = [problem.passage(z) for problem, z in orbits]
    columns = {"period": np.array([np.nan if p is None else p.period for p in passages])}
    names = (*system.state_names, *system.observable_names)
    ranges = np.array([_extremes(problem, z) for problem, z in orbits]).reshape(len(orbits), 2, len(names))
    for k, name in enumerate(names):
        columns[f"{name}.min"], columns[f"{name}.max"] = ranges[:, 0, k], ranges[:, 1, k]
    return columns


def _extremes(problem: CycleOfEvents, z: Array) -> tuple[Array, Array]:
    """Smallest and largest value of every state and observable on the orbit."""
    flow, p, names = problem.flow, problem.inner.full_parameters(z), len(problem.system.state_names)
    passage = problem.passage(z)
    count = names + len(problem.system.observable_names)
    if passage is None:
        return np.full(count, np.nan), np.full(count, np.nan)

    def seen(u: Array) -> Array:
        return np.hstack([u[:, :names], flow.seen(u, p)[:, : count - names]])

    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    for flown in passage.flown:
        t = _times(problem, z, passage, flown)
        states = _states(problem, z, flown, t)

        def at(times: Array, flown: Flown = flown, t: Array = t, states: Array = states) -> Array:
            row = max(int(np.searchsorted(t, times[0], side="right")) - 1, 0)
            nearby = _flown_states(problem, p, states[row], times - t[row])
            return seen(_up_to_surface(problem, p, flown, times, nearby))

        found = extremes_between(t, seen(states), at)
        low, high = np.fmin(low, found[0]), np.fmax(high, found[1])
    ends = seen(np.array([f.after for f in passage.flown]))
    return np.fmin(low, ends.min(axis=0)), np.fmax(high, ends.max(axis=0))


def norm(problem: CycleOfEvents, z: Array) -> float:
    """Root mean square of all states over the orbit, sqrt(mean(x^2 + y^2 + ..)).

    By Boole's rule in every step of the integrator where an arc has many within one of its equal times; else by the
    trapezoidal rule with slopes at the ends, of the fourth order, on times that are equally far apart in time and along
    the orbit.
    """
    names, passage = len(problem.system.state_names), problem.passage(z)
    if passage is None:
        return float("nan")
    total = 0.0
    for flown in passage.flown:
        t, ends = np.linspace(0.0, flown.time, QUADRATURE), _ends_of_steps(problem, z, flown)
        if np.diff(np.searchsorted(ends, t)).max() <= DENSE:
            total += _by_slopes(problem, z, flown, t)
            continue
        ends = np.union1d(ends, t[::IN_A_STEP])
        u = _states(problem, z, flown, in_parts(ends, IN_A_STEP))[:, :names]
        g = np.einsum("kn,kn->k", u, u)
        steps = np.diff(ends)
        total += float(sum(w * (steps @ g[k : len(g) - IN_A_STEP + k : IN_A_STEP]) for k, w in enumerate(BOOLE)))
    return float(np.sqrt(max(total, 0.0) / passage.period))


def _by_slopes(problem: CycleOfEvents, z: Array, flown: Flown, t: Array) -> float:
    """The integral of the states' squares over an arc."""
    names, p = len(problem.system.state_names), problem.inner.full_parameters(z)
    u = _states(problem, z, flown, t)
    steps = np.abs(np.diff(u / problem.map.sizes, axis=0)).sum(axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps / (steps.sum() or 1.0) + 1.0 / len(steps))])
    t = np.interp(np.linspace(0.0, way[-1], QUADRATURE), way, t)
    u = _states(problem, z, flown, t)
    fields = np.array([problem.flow.system.value(one, p) for one in u])
    g = np.einsum("kn,kn->k", u[:, :names], u[:, :names])
    slope = 2.0 * np.einsum("kn,kn->k", u[:, :names], fields[:, :names])
    h = np.diff(t)
    return float(0.5 * h @ (g[:-1] + g[1:]) + (h * h) @ (slope[:-1] - slope[1:]) / 12.0)


def _times(problem: CycleOfEvents, z: Array, passage: Passage, flown: Flown) -> Array:
    """Times of an arc, from 0 to its end: equally far apart, and in every step where the integrator takes more."""
    count = max(LEAST, int(SAMPLES * flown.time / passage.period))
    return resolving(np.linspace(0.0, flown.time, count), _ends_of_steps(problem, z, flown), IN_A_STEP)


def _ends_of_steps(problem: CycleOfEvents, z: Array, flown: Flown) -> Array:
    """The times from 0 to its end between which the integrator's steps along an arc are."""
    p, accuracy = problem.inner.full_parameters(z), problem.map.accuracy
    atol = SMALLER * accuracy * problem.map.sizes
    return ends_of_steps(problem.flow.system, flown.begin, p, flown.time, rtol=accuracy, atol=atol, budget=BUDGET)


def arc_samples(problem: CycleOfEvents, z: Array, flown: Flown) -> Array:
    """States on an arc, (SAMPLES, n)."""
    return _states(problem, z, flown, np.linspace(0.0, flown.time, SAMPLES))


def _states(problem: CycleOfEvents, z: Array, flown: Flown, t: Array) -> Array:
    """The states of an arc at times from 0 to its end, before the jump."""
    p = problem.inner.full_parameters(z)
    states = _up_to_surface(problem, p, flown, t, _flown_states(problem, p, flown.begin, t))
    states[-1] = flown.before
    return states


def _up_to_surface(problem: CycleOfEvents, p: Array, flown: Flown, t: Array, states: Array) -> Array:
    """States at times t of an arc, those at its end that are beyond the surface, or escaped, replaced by its last one.

    At the top of a spike the time of landing is known to less than its height asks for.
    """
    ending = np.flatnonzero(flown.time - t < POLISHED * flown.time)
    if not len(ending):
        return states
    h = problem.flow.heights(flown.arc.event, states[ending], p)
    states[ending[~(h * np.sign(flown.rate) < 0.0)]] = flown.before
    return states


def _flown_states(problem: CycleOfEvents, p: Array, u: Array, t: Array) -> Array:
    accuracy = problem.map.accuracy
    atol = SMALLER * accuracy * problem.map.sizes
    flight = fly(problem.flow.system, u, p, float(t[-1]), times=t, rtol=accuracy, atol=atol, budget=BUDGET)
    states = np.full((len(t), problem.flow.n), np.nan)
    states[: len(flight.u)] = flight.u
    return states
