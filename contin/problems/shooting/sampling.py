"""An orbit of a shooting problem at many times: profiles, extremes of its columns, and why it may not exist."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Array
from contin.problems.orbits.layout import Profile
from contin.problems.shooting.layout import Nodes
from contin.simulate.flight import Flight, fly

INTERVALS, POINTS = 64, 4  # of a profile: enough to draw, to find slow places and symmetries
SAMPLES = 600  # times an extreme is looked for at
RTOL = 1e-10


def flights(problem: Any, z: Array, times: Array) -> list[Flight]:
    """The segments, with the states at scaled `times` in [0, 1] (each in the segment it falls into)."""
    nodes = Nodes.of(z, problem.n)
    p, length = problem.full_parameters(z), nodes.period / nodes.count
    found = []
    for i, u in enumerate(nodes.u):
        first, last = i / nodes.count, (i + 1) / nodes.count
        inside = times[(times >= first) & ((times < last) | (i == nodes.count - 1))]
        wanted = np.minimum(inside * nodes.period, (i + 1) * length)
        atol = 1e-2 * RTOL * max(float(np.abs(nodes.u).max()), 1e-300)
        found.append(
            fly(
                problem.system, u, p, (i + 1) * length - i * length, start=i * length, times=wanted, rtol=RTOL,
                atol=atol, budget=problem.budget,
            )
        )  # fmt: skip
    return found


def states(problem: Any, z: Array, times: Array) -> Array:
    """u at scaled times, (K, n); NaN where a trajectory does not get there."""
    found = np.vstack([f.u for f in flights(problem, z, times)])
    out = np.full((len(times), problem.n), np.nan)
    out[: len(found)] = found
    return out


def sampled(problem: Any, z: Array) -> Profile:
    """The orbit at the nodes of a uniform mesh."""
    nodes = Nodes.of(z, problem.n)
    h = np.full(INTERVALS, 1.0 / INTERVALS)
    empty = Profile(POINTS, np.empty((INTERVALS * POINTS + 1, problem.n)), nodes.period, h, nodes.parameter)
    return Profile(POINTS, states(problem, z, empty.times), nodes.period, h, nodes.parameter)


def extremes(problem: Any, rows: Array) -> tuple[Array, Array]:
    """Smallest and largest value of every state and observable on the orbits of rows z, (R, k) each.

    Between samples a parabola through three neighbours: an error of the fourth order in the distance of samples.
    """
    system = problem.system
    width = len(system.state_names) + len(system.observable_names)
    low, high = np.full((len(rows), width), np.nan), np.full((len(rows), width), np.nan)
    times = np.linspace(0.0, 1.0, SAMPLES + 1)[:-1]
    for k, z in enumerate(rows):
        u = states(problem, z, times)
        values = u
        if system.observable_names:
            p = problem.full_parameters(z)
            observed = system.observables(np.ascontiguousarray(u), p)
            values = np.hstack([u, np.asarray(observed).reshape(len(u), -1)])
        low[k], high[k] = -_top(-values), _top(values)
    return low, high


def _top(values: Array) -> Array:
    """Largest value of every column of a closed curve's samples, between them by a parabola."""
    if not np.all(np.isfinite(values)):
        return np.full(values.shape[1], np.nan)
    best = np.argmax(values, axis=0)
    columns = np.arange(values.shape[1])
    a, b, c = (values[(best + d) % len(values), columns] for d in (-1, 0, 1))
    bend = a - 2.0 * b + c
    safe = np.where(bend < 0.0, bend, -1.0)
    shift = np.clip(0.5 * (a - c) / safe, -0.5, 0.5)
    smooth = (bend < 0.0) & (np.abs(a - c) < 0.5 * np.abs(values).max())  # not across an angle's jump
    return np.where(smooth, b - 0.25 * (a - c) * shift, b)


def why_not(problem: Any, z: Array) -> str:
    """What may keep Newton from converging at z."""
    for flight in flights(problem, z, np.empty(0)):
        if flight.outcome != "done":
            return f"The trajectory from there stops at t = {flight.end_time:.6g}: {flight.why}."
        if flight.touched:
            return (
                "The orbit touches a switching surface there without crossing it (a grazing orbit): the return map has "
                "no derivative, and the family cannot be followed through by Newton's method."
            )
    return (
        "Try a smaller settings.step or min_step, or settings.intervals: several segments (multiple shooting), where "
        "the orbit is very unstable."
    )
