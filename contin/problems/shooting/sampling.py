"""An orbit of a shooting problem at many times: profiles, extremes of its columns, and why it may not exist."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.measured.columns import names_of
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import state_sizes
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sizes import absolute_tolerances
from contin.simulate.flight import Flight, fly

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

INTERVALS, POINTS = 64, 4  # of a profile: enough to draw, to find slow places and symmetries
SAMPLES = 400  # times an extreme is looked for at
NARROW = 1e-12  # (scaled time) between two times that are one
FINER = 33  # ... and times around it
RTOL, LOOSER = 1e-10, 10.0  # relative tolerance, at most this many times that of the orbits themselves
BESIDE = 1e-5  # distance (relative) of trajectories beside an orbit that cannot be followed further


def flights(problem: ShotFamily, z: Array, times: Array) -> list[Flight]:
    """The segments, with the states at scaled `times` in [0, 1] (each in the segment it falls into)."""
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
                atol=atol, budget=problem.budget, pieces=problem.held.get(i),
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
    empty = _mesh(problem, z, crossings(problem, z))
    return Profile(POINTS, states(problem, z, empty.times), empty.period, empty.h, empty.parameter)


def _mesh(problem: ShotFamily, z: Array, crossed: Array) -> Profile:
    """Its mesh, without values."""
    nodes = Nodes.of(z, problem.n)
    ends = np.unique(np.concatenate([np.arange(INTERVALS + 1) / INTERVALS, crossed]))
    h = np.diff(ends)
    h = h[h > NARROW]
    h /= h.sum()
    return Profile(POINTS, np.empty((len(h) * POINTS + 1, problem.n)), nodes.period, h, nodes.parameter)


def measures(problem: ShotFamily, rows: Array) -> tuple[Array, Array, Array]:
    """Smallest and largest value of what `names_of` names on the orbits of rows z, (R, k) each, and norms (R,).

    The norm is the root mean square of all states, by quadrature between the crossings of switching surfaces.
    Extremes are looked for among equal times and those crossings, where a solution may have a corner; then among times
    between the neighbours of each extreme, and there by a parabola, except across a crossing.
    """
    found = [_measures(problem, z) for z in rows]
    width = len(names_of(problem.system))
    both = np.array([one[:2] for one in found]).reshape(len(rows), 2, width)
    return both[:, 0], both[:, 1], np.array([one[2] for one in found])


def _measures(problem: ShotFamily, z: Array) -> tuple[Array, Array, float]:
    crossed = crossings(problem, z)
    mesh = _mesh(problem, z, crossed)
    times = np.union1d(np.union1d(np.arange(SAMPLES) / SAMPLES, crossed), mesh.times)
    values = _functions(problem, z, times)
    if not np.all(np.isfinite(values)):
        nothing = np.full(len(names_of(problem.system)), np.nan)
        return nothing, nothing, np.nan
    u = values[np.searchsorted(times, mesh.times), : problem.n]
    norm = float(np.sqrt(mesh.weights @ np.einsum("kn,kn->k", u, u)))
    places = times[np.concatenate([np.argmin(values, axis=0), np.argmax(values, axis=0)])]
    around = np.linspace(-1.0, 1.0, FINER) / SAMPLES
    finer = (places[:, None] + around) % 1.0
    wanted, back = np.unique(finer, return_inverse=True)
    fine = _functions(problem, z, wanted)[back.reshape(finer.shape)]  # (2 k, FINER, k)
    k = values.shape[1]
    own = fine[np.arange(2 * k), :, np.tile(np.arange(k), 2)]
    own[:k] *= -1.0
    smooth = _smooth_at(finer, np.argmax(own, axis=1), crossed)
    tops = np.maximum(_top(own, smooth), np.concatenate([-values.min(axis=0), values.max(axis=0)]))
    skip = 0 if problem.system.state_names else problem.n
    return -tops[skip:k], tops[k + skip :], norm


def crossings(problem: ShotFamily, z: Array) -> Array:
    """Scaled times in [0, 1) at which the orbit crosses switching surfaces."""
    if not problem.system.n_switches:
        return np.empty(0)
    period = Nodes.of(z, problem.n).period
    found = np.concatenate([f.crossings[:, 0] for f in flights(problem, z, np.empty(0))]) / period
    return np.asarray(np.unique(found[(found >= 0.0) & (found < 1.0)]))


def _smooth_at(times: Array, best: NDArray[np.int64], crossed: Array) -> NDArray[np.bool_]:
    """True where no surface is crossed between the neighbours of the best of each row's times."""
    rows = np.arange(len(times))
    middle = np.clip(best, 1, times.shape[1] - 2)
    low, high = times[rows, middle - 1], times[rows, middle + 1]
    if not len(crossed):
        return np.ones(len(times), dtype=bool)
    between = (crossed[None] >= low[:, None]) & (crossed[None] <= high[:, None])
    return np.asarray(~between.any(axis=1) & (low < high))


def _functions(problem: ShotFamily, z: Array, times: Array) -> Array:
    """States and observables at scaled times, (T, k); where nothing has a name, states and their norm."""
    system, u = problem.system, states(problem, z, times)
    if not system.observable_names:
        norm = np.sqrt(np.einsum("tn,tn->t", u, u) / problem.n)
        return u if system.state_names else np.column_stack([u, norm])
    p = problem.full_parameters(z)
    return np.hstack([u, np.asarray(system.observables(np.ascontiguousarray(u), p)).reshape(len(u), -1)])


def _top(values: Array, smooth: NDArray[np.bool_]) -> Array:
    """Largest value of every row of equally spaced samples, between them by a parabola where it is smooth there."""
    best = np.clip(np.argmax(values, axis=1), 1, values.shape[1] - 2)
    rows = np.arange(len(values))
    a, b, c = (values[rows, best + d] for d in (-1, 0, 1))
    bend = a - 2.0 * b + c
    shift = np.clip(0.5 * (a - c) / np.where(bend < 0.0, bend, -1.0), -1.0, 1.0)
    largest = np.maximum(np.maximum(a, b), c)
    return np.asarray(np.where(smooth & (bend < 0.0) & (np.abs(shift) < 1.0), b - 0.25 * (a - c) * shift, largest))


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
