"""Trajectories in the unstable manifold of a saddle that come near a second one (or back): guesses of connections."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError, NotFiniteError
from contin.lowering.system import compile_system
from contin.machine import elementary
from contin.model.expression import neg
from contin.problems.orbits.mesh.layout import Profile
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

LEAVING: Final = 1e-4  # distance from the saddle at which trajectories start, of that of the saddles; of loops of 1
AWAY: Final = 0.3  # ... that a loop must reach before its return counts (all in the states' sizes)
ANGLES: Final = 64  # directions in a plane of unstable directions
LONGEST: Final = 60.0  # times of the slowest unstable rate
SAMPLES: Final = 4000
INTERVALS: Final = 60
FARTHEST: Final = 0.9  # relative distance from the second saddle at which a connection is looked for
LATER: Final = 0.2  # by which a later approach must be nearer than an earlier one
MOST: Final = 4  # guesses


@dataclass(frozen=True, eq=False)
class Approach:
    """A trajectory from `start` that is at its nearest to the second saddle at `time`, `gap` of its extent from it.

    backwards : it starts at the second saddle, and runs back in time to the first one.
    """

    gap: float
    start: Array
    time: float
    rank: float  # of several the least is tried first
    backwards: bool = False


@dataclass(frozen=True, eq=False)
class Between:
    """Two saddles (the same for a loop) of a system at p, the states' sizes, and the periods of angles (or 0)."""

    system: CompiledSystem
    p: Array
    saddles: Array  # (2, n)
    sizes: Array
    periods: Array
    is_loop: bool

    def apart(self, u: Array, v: Array) -> Array:
        """The difference of states (rows of them), of angles but for whole turns."""
        return np.asarray(u - v - turns(self.periods, u - v))

    def backwards(self) -> Between:
        """The same with time running back: what left the first saddle leaves the second one."""
        model = self.system.model
        reverse = model.replace(
            equations=tuple(neg(e) for e in model.equations), events=(), symmetries=(), rotation={}, observables={}
        )
        return replace(self, system=compile_system(reverse), saddles=self.saddles[::-1])


def turns(periods: Array, difference: Array) -> Array:
    """The whole turns in a difference of states (rows of them)."""
    own = np.where(periods > 0.0, periods, 1.0)
    return np.asarray(np.where(periods > 0.0, np.round(difference / own) * periods, 0.0))


def approaches(between: Between) -> list[Approach]:
    """The trajectories that leave the first saddle and come nearest to the second one, at most `MOST`, best first.

    Raises NoSolutionError where there is none that comes nearer than a part of its extent.
    """
    (u0, u1), d, system, p = between.saddles, between.sizes, between.system, between.p
    n = system.n
    values, vectors = np.linalg.eig(np.asarray(system.jacobian(u0, p)[1][:, :n]) * d / d[:, None])
    growing = values.real > 0.0
    if not growing.any():
        raise NoSolutionError("the first equilibrium has no unstable direction: no orbit leaves it")
    extent = 1.0 if between.is_loop else float(np.linalg.norm(between.apart(u1, u0) / d))
    times = np.linspace(0.0, LONGEST / float(values.real[growing].min()), SAMPLES)
    found, nearest = [], np.inf
    for direction in _directions(vectors[:, growing]):
        start = u0 + LEAVING * extent * direction * d
        path = until_lost(system, start, p, times)
        gone = np.linalg.norm((path - u0) / d, axis=1)
        begin = _turning(gone, AWAY * extent) if between.is_loop else 0
        if begin is None:
            continue
        gaps = np.linalg.norm(between.apart(path, u1) / d, axis=1)
        for order, k in enumerate(_minima(gaps, begin)):
            reach = float(gone[: k + 1].max()) if between.is_loop else extent
            gap = float(gaps[k]) / reach
            nearest = min(nearest, gap)
            if gap < FARTHEST:
                found.append(Approach(gap, start, float(times[k]), gap + LATER * order))
    if not found:
        how = f"the nearest at {nearest:.2g} of its extent" if np.isfinite(nearest) else "they do not even turn back"
        raise NoSolutionError(
            "no connecting orbit nearby: no trajectory that leaves the first saddle comes towards the second one "
            f"({how}); change the parameters so that they come nearer, or give `samples` of an orbit"
        )
    return sorted(found, key=lambda one: one.rank)[:MOST]


def approaches_from_either(between: Between, leaving: int, arriving: int) -> list[Approach]:
    """Those from the saddle whose manifold (of dimension `leaving`, or `arriving`) has fewer directions, first.

    Of a manifold of many dimensions the directions cannot all be tried, and those of nearly all lead elsewhere.
    """
    if between.is_loop or arriving >= leaving or not between.system.model.equations:
        return approaches(between)
    found = [replace(one, backwards=True) for one in approaches(between.backwards())]
    with suppress(NoSolutionError):  # there are guesses already
        found += approaches(between)
    return found


def trajectory(between: Between, approach: Approach, parameter: float) -> Profile:
    """The trajectory up to its approach, on equal intervals."""
    if approach.backwards:
        back = trajectory(between.backwards(), replace(approach, backwards=False), parameter)
        return replace(back, u=np.ascontiguousarray(back.u[::-1]))
    time = approach.time
    h = np.full(INTERVALS, 1.0 / INTERVALS)
    empty = Profile(4, np.empty((4 * INTERVALS + 1, between.system.n)), time, h, parameter)
    whole = integrate(between.system, approach.start, between.p, time * (1.0 + 1e-12), times=empty.times * time)
    return Profile(4, whole.u, time, h, parameter)


def _minima(gaps: Array, begin: int) -> list[int]:
    """Places of the local minima from `begin` on, the ends included where the distance falls towards them."""
    inside = np.arange(max(begin, 1), len(gaps) - 1)
    found = inside[(gaps[inside] <= gaps[inside - 1]) & (gaps[inside] < gaps[inside + 1])]
    last = len(gaps) - 1
    if last > max(begin, 1) and gaps[last] < gaps[last - 1]:
        return [*found.tolist(), last]
    return [int(k) for k in found]


def _turning(gone: Array, away: float) -> int | None:
    """Where the distance from a saddle first falls again, having exceeded `away`; None where it never does."""
    falls = np.flatnonzero((gone[:-1] > away) & (gone[1:] < gone[:-1]))
    return int(falls[0]) if falls.size else None


def _directions(vectors: Array) -> list[Array]:
    """Unit vectors in the unstable eigenspace: both senses of a line, a circle in a plane."""
    left, values, _ = np.linalg.svd(np.hstack([vectors.real, vectors.imag]), full_matrices=False)
    basis = left[:, : max(1, int(np.sum(values > 1e-9 * values[0])))]
    if basis.shape[1] == 1:
        return [basis[:, 0], -basis[:, 0]]
    angles = 2.0 * np.pi * np.arange(ANGLES) / ANGLES
    return [elementary.cos(a) * basis[:, 0] + elementary.sin(a) * basis[:, 1] for a in angles]


def until_lost(system: CompiledSystem, u: Array, p: Array, times: Array) -> Array:
    """States at the times, as far as the trajectory has a value (but for a thirtieth of its time)."""

    def path(count: int) -> Array | None:
        try:
            return np.asarray(integrate(system, u, p, float(times[count - 1]), times=times[:count], budget=100_000).u)
        except NotFiniteError:  # lost by then: a shorter time is tried
            return None

    lost = len(times)
    found = path(lost)
    if found is not None:
        return found
    kept, best = 10, u[None]
    while lost > kept + 1 + kept // 30:
        middle = int(np.sqrt(kept * lost)) if lost > 2 * kept else (kept + lost) // 2
        found = path(middle)
        if found is None:
            lost = middle
        else:
            kept, best = middle, found
    return best
