"""An orbit of a shooting problem at many times: profiles, meshes to integrate on, and why it may not exist."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import state_sizes
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sizes import absolute_tolerances
from contin.simulate.between_samples import DENSE
from contin.simulate.flight import Flight, fly

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

INTERVALS, POINTS = 64, 4  # of a profile: enough to draw, to find slow places and symmetries
SAMPLES = 400  # times an extreme is looked for at; where many steps are between, at those too
NARROW = 1e-12  # (scaled time) between two times that are one
RTOL, LOOSER = 1e-10, 10.0  # relative tolerance, at most this many times that of the orbits themselves
BESIDE = 1e-5  # distance (relative) of trajectories beside an orbit that cannot be followed further


def flights(problem: ShotFamily, z: Array, times: Array, steps: list[float] | None = None) -> list[Flight]:
    """The segments, with the states at scaled `times` in [0, 1] (each in the segment it falls into).

    steps : gets the time (unscaled) at the end of every step.
    """
    nodes = Nodes.of(z, problem.n)
    p, length = problem.full_parameters(z), nodes.period / nodes.count
    found, owners = [], segments_of(times, nodes.count)
    rtol = min(RTOL, LOOSER * problem.accuracy)
    atol = absolute_tolerances(problem, nodes, p, rtol)
    for i, u in enumerate(nodes.u):
        wanted = np.minimum(times[owners == i] * nodes.period, (i + 1) * length)
        found.append(
            fly(
                problem.system, u, p, (i + 1) * length - i * length, start=i * length, times=wanted, rtol=rtol,
                atol=atol, budget=problem.budget, pieces=problem.held.get(i), steps=steps,
            )
        )  # fmt: skip
    return found


def states(problem: ShotFamily, z: Array, times: Array) -> Array:
    """u at scaled times in any order, (K, n); NaN where a trajectory does not get there."""
    order = np.argsort(times, kind="stable")
    found = flights(problem, z, times[order])
    owners = segments_of(times[order], len(found))
    out = np.full((len(times), problem.n), np.nan)
    for i, flight in enumerate(found):
        out[order[owners == i][: len(flight.u)]] = flight.u
    return out


def segments_of(times: Array, count: int) -> NDArray[np.intp]:
    """Which of `count` segments scaled times in [0, 1] fall into; 1 into the last."""
    starts = np.arange(count) / count
    return np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)


def sampled(problem: ShotFamily, z: Array) -> Profile:
    """The orbit at the nodes of a uniform mesh."""
    nodes = Nodes.of(z, problem.n)
    h = np.full(INTERVALS, 1.0 / INTERVALS)
    empty = Profile(POINTS, np.empty((INTERVALS * POINTS + 1, problem.n)), nodes.period, h, nodes.parameter)
    return Profile(POINTS, states(problem, z, empty.times), nodes.period, h, nodes.parameter)


def measured(problem: ShotFamily, z: Array) -> Profile:
    """The orbit on a mesh whose ends of intervals are all crossings of surfaces: integrals over it are smooth."""
    empty = mesh_of(problem, z, turning_places(problem, z))
    return Profile(POINTS, states(problem, z, empty.times), empty.period, empty.h, empty.parameter)


def mesh_of(problem: ShotFamily, z: Array, crossed: Array) -> Profile:
    """Its mesh, without values."""
    nodes = Nodes.of(z, problem.n)
    ends = np.unique(np.concatenate([np.arange(INTERVALS + 1) / INTERVALS, crossed]))
    h = np.diff(ends)
    h = h[h > NARROW]
    h /= h.sum()
    return Profile(POINTS, np.empty((len(h) * POINTS + 1, problem.n)), nodes.period, h, nodes.parameter)


def turning_places(problem: ShotFamily, z: Array) -> Array:
    """The scaled times of crossings, and those of the steps of an orbit that takes many: it spikes between samples."""
    steps: list[float] = []
    taken = flights(problem, z, np.empty(0), steps)
    found = [f.crossings[:, 0] for f in taken] if problem.system.n_switches else []
    ends = np.unique(steps)
    samples = np.arange(SAMPLES + 1) / SAMPLES * Nodes.of(z, problem.n).period
    if len(ends) > SAMPLES or np.diff(np.searchsorted(ends, samples)).max() > DENSE:
        found.append(ends)
    places = np.concatenate([*found, np.empty(0)]) / Nodes.of(z, problem.n).period
    return np.asarray(np.unique(places[(places >= 0.0) & (places < 1.0)]))


def crossings(problem: ShotFamily, z: Array) -> Array:
    """Scaled times in [0, 1) at which the orbit crosses switching surfaces."""
    if not problem.system.n_switches:
        return np.empty(0)
    period = Nodes.of(z, problem.n).period
    found = np.concatenate([f.crossings[:, 0] for f in flights(problem, z, np.empty(0))]) / period
    return np.asarray(np.unique(found[(found >= 0.0) & (found < 1.0)]))


def why_not(problem: ShotFamily, z: Array) -> str:
    """What may keep Newton from converging at z."""
    for flight in flights(problem, z, np.empty(0)):
        if flight.outcome != "done":
            return f"The trajectory from there stops at t = {flight.end_time:.6g}: {flight.why}."
        if flight.touched:
            return (
                "The orbit touches a switching surface there without crossing it (a grazing orbit): the return map has "
                "no derivative, and the family cannot be followed through by Newton's method."
            )
    return sliding(problem, z) or (
        "Try a smaller settings.step or min_step, or settings.intervals: several segments (multiple shooting), where "
        "the orbit is very unstable."
    )


def sliding(problem: ShotFamily, z: Array) -> str | None:
    """That trajectories slide along a surface on the orbit, or right beside it, in words; None where none does."""
    for flight in flights(problem, z, np.empty(0)):
        if flight.outcome == "sliding":
            return f"The trajectory from there stops at t = {flight.end_time:.6g}: {flight.why}."
        if flight.outcome != "done" or flight.touched:
            return None
    beside = _slides_beside(problem, z)
    return None if beside is None else f"Trajectories right beside the orbit stop: {beside}."


def _slides_beside(problem: ShotFamily, z: Array) -> str | None:
    """Why a trajectory slides that starts beside the orbit; None where none does."""
    if not problem.system.n_switches:
        return None
    sizes = state_sizes(problem, problem.profile(z))
    for k in range(problem.n):
        for step in (BESIDE * sizes[k], -BESIDE * sizes[k]):
            moved = z.copy()
            moved[k : z.size - problem.n - 3 : problem.n] += step
            for flight in flights(problem, moved, np.empty(0)):
                if flight.outcome == "sliding":
                    return flight.why
    return None
