"""Guesses of symmetric connecting orbits: halves that lead from a saddle to the fixed space of a reversor."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.homoclinic.from_table import FARTHEST, Path, laid
from contin.homoclinic.guesses import (
    AWAY,
    LEAVING,
    LONGEST,
    MOST,
    SAMPLES,
    Approach,
    Between,
    until_lost,
)
from contin.homoclinic.starting_ring import ANGLES, Ring
from contin.problems.orbits.mesh.layout import Profile
from contin.simulate.natural import natural_metric
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.homoclinic.reversor import Reversor

REFINEMENTS: Final = 9
ORDERS: Final = 3  # meetings with the first row of the fixed space that neighbours are to have alike
MEETINGS: Final = 40  # ... that are looked at: a weak pulse turns many times before it is larger than the linear part
ALIKE: Final = 0.25  # of the time to the next one, within which meetings of neighbours are one
MET: Final = 1e-6  # distance from the fixed space, below which a trajectory meets it
LOST: Final = 1e6  # misses of trajectories that have no value
APART: Final = 0.2  # radians and part of the time, nearer than which two guesses are one
PART: Final = 0.1  # of its extent, that a half must be away from the saddle where it ends
CUT: Final = 1e-3  # of the extent, nearer than which samples at the saddle are left away
LATER: Final = 0.05  # by which a later crossing must be nearer to the fixed space than an earlier one


def crossings(between: Between, reversor: Reversor) -> list[Approach]:
    """Trajectories that leave the saddle and meet the fixed space, or come near it, at most `MOST`, best first."""
    search = _Search.of(between, reversor)
    flights = [search.flight(angle) for angle in search.ring.angles]
    if search.ring.is_circle:
        flights = search.refined(flights)
        found = search.brackets(flights) or search.nearest(flights)
    else:
        found = search.nearest(flights)
    if not found:
        raise NoSolutionError(
            "no symmetric connecting orbit nearby: no trajectory that leaves the saddle comes towards the fixed space "
            "of the reversor; give `samples` of an orbit"
        )
    found.sort(key=lambda one: one[1].rank)
    aimed = [_aimed(between, reversor, search.ring, *one) for one in _apart(found)[:MOST]]
    return sorted(aimed, key=lambda one: one.rank + float(one.gap > MET))


@dataclass(frozen=True, eq=False)
class _Flight:
    """A trajectory away from the saddle: times at which the first row of the fixed space is met, the other rows there.

    `gone`, `gaps` : distance from the saddle and from the fixed space at all times.
    """

    angle: float
    start: Array
    times: Array  # (k,)
    others: Array  # (k, m - 1)
    gone: Array
    gaps: Array


@dataclass(frozen=True, eq=False)
class _Search:
    between: Between
    reversor: Reversor
    ring: Ring
    times: Array

    @classmethod
    def of(cls, between: Between, reversor: Reversor) -> _Search:
        d, system = between.sizes, between.system
        matrix = np.asarray(system.jacobian(between.saddles[0], between.p)[1][:, : system.n]) * d / d[:, None]
        values, vectors = np.linalg.eig(matrix)
        growing = values.real > 1e-6 * np.abs(values).max()
        times = np.linspace(0.0, LONGEST / float(values.real[growing].min()), SAMPLES)
        return cls(between, reversor, Ring.of(values[growing], vectors[:, growing]), times)

    def flight(self, angle: float) -> _Flight:
        one = self.between
        start = one.saddles[0] + LEAVING * self.ring.offset(angle) * one.sizes
        path = until_lost(one.system, start, one.p, self.times)
        gone = np.linalg.norm((path - one.saddles[0]) / one.sizes, axis=1)
        missed = self.reversor.missed(path, one.sizes)
        first = missed[:, 0]
        away = np.maximum.accumulate(gone) > AWAY
        k = np.flatnonzero((first[:-1] * first[1:] < 0.0) & away[:-1])
        part = first[k] / (first[k] - first[k + 1])
        others = missed[k, 1:] + part[:, None] * (missed[k + 1, 1:] - missed[k, 1:])
        times = self.times[k] + part * (self.times[1] - self.times[0])
        return _Flight(angle, start, times, others, gone, np.linalg.norm(missed, axis=1))

    def refined(self, flights: list[_Flight]) -> list[_Flight]:
        """With further ones between neighbours of which one meets the first row, or meets it once more."""
        for _ in range(REFINEMENTS):
            added = [
                self.flight(0.5 * (a.angle + b.angle))
                for a, b in pairwise(flights)
                if min(len(a.times), len(b.times)) < ORDERS and len(a.times) != len(b.times)
            ]
            if not added or len(flights) > 2 * ANGLES:
                break
            flights = sorted([*flights, *added], key=lambda one: one.angle)
        return flights

    def brackets(self, flights: list[_Flight]) -> list[tuple[float, Approach]]:
        """Between two neighbours whose meetings with the first row lie on different sides of the second one."""
        found = []
        for a, b in pairwise(flights):
            for k, j in _alike(a.times[:MEETINGS], b.times[:MEETINGS]):
                x, y = a.others[k], b.others[j]
                if x.size and x[0] * y[0] < 0.0:
                    nearer, order = (a, k) if np.linalg.norm(x) < np.linalg.norm(y) else (b, j)
                    gap = float(np.linalg.norm(nearer.others[order]))
                    rank = min(k, j) + min(gap, 1.0)
                    found.append((nearer.angle, Approach(gap, nearer.start, float(nearer.times[order]), rank)))
        return found

    def nearest(self, flights: list[_Flight]) -> list[tuple[float, Approach]]:
        """Where the distance from the fixed space is least, of the extent reached."""
        found = []
        for one in flights:
            gaps, inside = one.gaps, np.arange(1, len(one.gaps) - 1)
            minima = inside[(gaps[inside] <= gaps[inside - 1]) & (gaps[inside] < gaps[inside + 1])]
            for order, k in enumerate(minima[one.gone[minima] > AWAY]):
                gap = float(gaps[k]) / float(one.gone[: k + 1].max())
                found.append((one.angle, Approach(gap, one.start, float(self.times[k]), gap + LATER * order)))
        return found


def _alike(one: Array, other: Array) -> list[tuple[int, int]]:
    """Places of meetings at nearly the same time: one flight may have had one more before."""
    if not (one.size and other.size):
        return []
    nearest = np.argmin(np.abs(one[:, None] - other), axis=1)
    gap = np.diff(one, append=2.0 * one[-1] - (one[-2] if one.size > 1 else 0.0))
    near = np.abs(one - other[nearest]) < ALIKE * gap
    return [(k, int(nearest[k])) for k in np.flatnonzero(near).tolist()]


def _apart(found: list[tuple[float, Approach]]) -> list[tuple[float, Approach]]:
    """The best ones, each of another direction than those before."""
    kept: list[tuple[float, Approach]] = []
    for angle, one in found:
        if all(abs(angle - other) > APART or abs(one.time - two.time) > APART * one.time for other, two in kept):
            kept.append((angle, one))
    return kept


def _aimed(between: Between, reversor: Reversor, ring: Ring, angle: float, approach: Approach) -> Approach:
    """The same with direction and time changed so that it comes nearer to the fixed space, as far as it does."""
    from scipy.optimize import least_squares

    u0, d = between.saddles[0], between.sizes
    first = np.append(angle if ring.is_circle else [], approach.time)

    def start(x: Array) -> Array:
        return np.asarray(u0 + LEAVING * ring.offset(float(x[0]) if ring.is_circle else angle) * d)

    def missed(x: Array) -> Array:
        time = float(np.clip(x[-1], 0.5 * approach.time, 2.0 * approach.time))
        try:
            end = integrate(between.system, start(x), between.p, time, times=np.array([0.0, time])).u[-1]
        except NotFiniteError:  # a step too far: a shorter one is tried
            return np.full(len(reversor.rows), LOST)
        return np.clip(reversor.missed(end, d), -LOST, LOST)

    scales = np.append([2.0 * np.pi / ANGLES] * ring.is_circle, 0.02 * approach.time)
    better = least_squares(missed, first, x_scale=scales, max_nfev=60)
    gap = float(np.linalg.norm(better.fun))
    if gap >= approach.gap or not 0.5 < better.x[-1] / approach.time < 2.0:
        return approach
    return Approach(gap, start(better.x), float(better.x[-1]), approach.rank)


def half_of(path: Path, between: Between, reversor: Reversor, parameter: float) -> Profile:
    """Samples from the saddle up to the fixed space of the reversor: the whole orbit is cut in its middle.

    The place of the cut is where the samples come nearest to the fixed space, away from the saddle.
    """
    t, u = np.asarray(path.times, dtype=float), np.asarray(path.states, dtype=float)
    if t.ndim != 1 or u.shape != (len(t), between.system.n) or len(t) < 8 or not np.all(np.diff(t) > 0.0):
        raise InputError(
            f"samples of a connecting orbit: at least 8 growing times and as many states of "
            f"{between.system.n} components; got shapes {t.shape} and {u.shape}"
        )
    sizes = np.maximum(between.sizes, natural_metric(between.system, u[len(u) // 2], between.p).states)
    extent = float(np.max(np.ptp(u, axis=0) / sizes))
    if extent == 0.0 or not np.all(np.isfinite(u)):
        raise InputError("samples of a connecting orbit must be finite, and not all the same")
    away = np.max(np.abs(u - between.saddles[0]) / sizes, axis=1) / extent
    if away[0] > FARTHEST:
        raise NoSolutionError(
            f"the orbit given begins at {away[0]:.2g} of its extent from its saddle: samples must lead from the saddle "
            "to the fixed space of the reversor, or beyond"
        )
    gaps = np.where(away > PART, np.linalg.norm(reversor.missed(u, sizes), axis=1) / extent, np.inf)
    last = int(np.argmin(gaps))
    if gaps[last] > FARTHEST:
        raise NoSolutionError(f"the samples come no nearer to the fixed space of the reversor than {gaps[last]:.2g}")
    first = max(int(np.flatnonzero(away > min(CUT, 0.5 * away[last]))[0]) - 1, 0)
    return laid(t[first : last + 1], u[first : last + 1], sizes, parameter)
