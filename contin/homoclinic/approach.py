"""Trajectories that leave an equilibrium or a cycle and come near another one: guesses of connecting orbits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NoSolutionError
from contin.homoclinic.from_table import Path
from contin.homoclinic.guesses import until_lost
from contin.homoclinic.units_of_ends import units_between
from contin.machine import elementary
from contin.problems.orbits.rests_and_cycles import Cycle, Rest
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

    from contin.lowering.system import CompiledSystem

LEAVING: Final = 1e-4  # of the extent, at which trajectories start
ANGLES: Final = 64
TURNS: Final = 40.0
PHASES: Final = 48
PERIODS: Final = 25.0  # of a cycle, and ...
RATES: Final = 30.0  # times of the slowest unstable rate, that trajectories take
PER_TURN: Final = 40  # samples in the time of the shorter period
AWAY: Final = 0.3  # of the extent, that an orbit that returns must have reached
FARTHEST: Final = 0.5
EARLY: Final = 30  # approaches of one trajectory that are looked at
LATER: Final = 0.1
MOST: Final = 5
CLOSE: Final = 1e-3  # of the extent: nearer it is not looked for by trajectories
SHRUNK: Final = 0.4
NARROWEST: Final = 1e-4  # of the spacing of starts
ALIKE: Final = 1e-8  # of the way from start to finish: starts as near are one
CUT: Final = 1e-2  # of the extent: samples nearer to an equilibrium are left away
WAIT: Final = 1.5  # turns that a better start may arrive later


@dataclass(frozen=True, eq=False)
class Approach:
    """From `start` to `finish` in `time`; the phases of the cycles at both ends (0 for equilibria)."""

    system: CompiledSystem
    p: Array
    start: Array
    finish: Array
    time: float
    phases: tuple[float, float]
    gap: float  # of the extent
    rank: float
    departure: Departure | None = None
    samples: Path | None = None

    def path(self, s: Array) -> Array:
        """States at scaled times."""
        if self.samples is not None:
            return self.samples.at(s)
        if self.time <= 0.0:
            return np.tile(self.start, (len(s), 1))
        return np.asarray(integrate(self.system, self.start, self.p, self.time * (1 + 1e-12), times=s * self.time).u)


def approaches(system: CompiledSystem, p: Array, first: Rest | Cycle, last: Rest | Cycle) -> list[Approach]:
    """The nearest ones, at most `MOST`; NoSolutionError where there is none."""
    seen = _Seen.of(system, p, first, last)
    found = [one for departure in _departures(first, seen.sizes) for one in seen.from_(departure)]
    if not found:
        raise NoSolutionError(
            "no trajectory that leaves the first end comes near the second one: change the parameters so that they do"
        )
    best = _apart(sorted(found, key=lambda one: one.rank), seen.sizes)
    nearest = _apart(sorted(map(seen.nearer, best), key=lambda one: one.rank), seen.sizes)
    return [_in_phase(one, first, last, seen.sizes) for one in nearest]


def of_samples(system: CompiledSystem, p: Array, first: Rest | Cycle, last: Rest | Cycle, path: Path) -> Approach:
    """Samples of an orbit from the one end to the other, whose own ends are somewhere near them."""
    path = path.checked(system.n)
    sizes = units_between(first, last, path.states)
    path = _without_rests(path, first, last, sizes)
    gaps, phases = [], []
    for end, state in ((first, path.states[0]), (last, path.states[-1])):
        near = end.u[None] if isinstance(end, Rest) else end.states
        apart = np.linalg.norm((near - state) / sizes, axis=1)
        gaps.append(float(apart.min()) / sqrt(system.n))
        phases.append(float(end.times[int(np.argmin(apart))]) if isinstance(end, Cycle) else 0.0)
    for words, gap in zip(("begins", "ends"), gaps, strict=True):
        if gap > FARTHEST:
            raise NoSolutionError(
                f"the orbit given {words} at {gap:.2g} of its extent from its end: samples must lead from the first "
                "end to the second one"
            )
    start, finish, time = path.states[0], path.states[-1], float(path.times[-1] - path.times[0])
    one = Approach(system, p, start, finish, time, (phases[0], phases[1]), max(gaps), 0.0, samples=path)
    return _in_phase(one, first, last, sizes)


@dataclass(frozen=True, eq=False)
class Departure:
    """Starts that a number tells apart, `neighbours` of which are `spacing` away; None: there are two starts only."""

    starts: Callable[[float], tuple[Array, float]]
    place: float
    spacing: float | None

    def at(self, place: float) -> Departure:
        return replace(self, place=place)


@dataclass(frozen=True, eq=False)
class _Seen:
    """Both ends as trajectories are compared with them."""

    system: CompiledSystem
    p: Array
    last: Rest | Cycle
    sizes: Array
    tree: cKDTree
    home: cKDTree  # of an orbit that returns to its own end the same one
    own: float  # extent of the second end, or of both
    times: Array
    turn: float  # time of one turn beside the second end

    @classmethod
    def of(cls, system: CompiledSystem, p: Array, first: Rest | Cycle, last: Rest | Cycle) -> _Seen:
        ends = [end.u[None] if isinstance(end, Rest) else end.states for end in (first, last)]
        sizes = units_between(first, last)
        from scipy.spatial import cKDTree

        target = ends[1] / sizes
        own = float(np.linalg.norm(np.ptp(target, axis=0))) or float(
            np.linalg.norm(np.ptp(np.vstack(ends) / sizes, axis=0))
        )
        longest = _longest(first, last)
        shortest = min(end.period for end in (first, last) if isinstance(end, Cycle))
        times = np.linspace(0.0, longest, int(PER_TURN * longest / shortest) + 2)
        turn = last.period if isinstance(last, Cycle) else shortest
        tree = cKDTree(target)
        home = tree if np.array_equal(ends[0], ends[1]) else cKDTree(ends[0] / sizes)
        return cls(system, p, last, sizes, tree, home, own, times, turn)

    def from_(self, departure: Departure, until: float = np.inf) -> list[Approach]:
        """Approaches of one trajectory, of whose extent the gap is a part; late ones have a higher rank."""
        start, phase = departure.starts(departure.place)
        path = until_lost(self.system, start, self.p, self.times[self.times <= until])
        gaps, places = self.tree.query(path / self.sizes)
        gone = np.maximum.accumulate(gaps if self.home is self.tree else self.home.query(path / self.sizes)[0])
        extent = np.maximum(self.own, gone)
        inside = np.arange(1, len(gaps) - 1)
        minima = inside[(gaps[inside] <= gaps[inside - 1]) & (gaps[inside] < gaps[inside + 1])]
        chosen = minima[(gone[minima] > AWAY * self.own) & (gaps[minima] < FARTHEST * gone[minima])][:EARLY]
        found = []
        for order, k in enumerate(chosen):
            arrived = float(self.last.times[places[k]]) if isinstance(self.last, Cycle) else 0.0
            gap, time = float(gaps[k] / extent[k]), float(self.times[k])
            phases, rank = (phase, arrived), gap + LATER * order
            found.append(Approach(self.system, self.p, start, path[k], time, phases, gap, rank, departure))
        return found

    def nearer(self, one: Approach) -> Approach:
        """The approach of a neighbouring start that comes nearest at about the same time: by golden section."""
        if one.departure is None or one.departure.spacing is None:
            return one
        width, best = one.departure.spacing, one
        while width > NARROWEST * one.departure.spacing:
            for sense in (1.0, -1.0):
                assert best.departure is not None
                beside = best.departure.at(best.departure.place + sense * width)
                late = [a for a in self.from_(beside, best.time + WAIT * self.turn) if a.time > one.time - self.turn]
                nearest = min(late, key=lambda a: a.gap, default=None)
                if nearest is not None and nearest.gap < best.gap:
                    best = replace(nearest, rank=nearest.gap + one.rank - one.gap)
                    break
            else:
                width *= SHRUNK
            if best.gap < CLOSE:
                break
        return best


def _in_phase(one: Approach, first: Rest | Cycle, last: Rest | Cycle, sizes: Array) -> Approach:
    """With phases at which the offsets are normal to the cycles."""
    leaving = first.nearest(one.start, one.phases[0], sizes) if isinstance(first, Cycle) else 0.0
    arriving = last.nearest(one.finish, one.phases[1], sizes) if isinstance(last, Cycle) else 0.0
    return replace(one, phases=(leaving, arriving))


def _apart(found: list[Approach], sizes: Array) -> list[Approach]:
    """The best ones, at most `MOST`; of those that leave alike the best."""
    kept: list[Approach] = []
    for one in found:
        if not any(_alike(one, other, sizes) for other in kept):
            kept.append(one)
        if len(kept) == MOST:
            break
    return kept


def _alike(one: Approach, other: Approach, sizes: Array) -> bool:
    """True of two that leave alike and take as long."""
    apart, way = (float(np.max(np.abs(one.start - state) / sizes)) for state in (other.start, one.finish))
    return apart <= ALIKE * way and abs(one.time - other.time) < 0.1 * one.time


def _longest(first: Rest | Cycle, last: Rest | Cycle) -> float:
    """Time that trajectories are followed."""
    total = sum(PERIODS * end.period for end in (first, last) if isinstance(end, Cycle))
    if isinstance(first, Cycle):
        total += 1.5 * float(elementary.log(1.0 / _leaving(first))) / _rate(first) * first.period
    if isinstance(first, Rest):
        rates = np.linalg.eigvals(first.matrix).real
        total += RATES / float(rates[rates > 0.0].min())
    return float(total)


def _rate(cycle: Cycle) -> float:
    """At which orbits leave a cycle, a period."""
    return min((abs(float(elementary.log(abs(m)))) for m in cycle.outside(True)), default=1.0)


def _leaving(cycle: Cycle) -> float:
    """Distance at which orbits leave it: LEAVING, and farther where that takes more than `TURNS` periods."""
    return max(LEAVING, float(elementary.exp(-TURNS * _rate(cycle))))


def _without_rests(path: Path, first: Rest | Cycle, last: Rest | Cycle, sizes: Array) -> Path:
    """Samples without those so near to an equilibrium that their digits tell no direction."""
    begins, ends = 0, len(path.times)
    if isinstance(first, Rest):
        away = np.linalg.norm((path.states - first.u) / sizes, axis=1) > CUT
        begins = int(np.argmax(away))
    if isinstance(last, Rest):
        away = np.linalg.norm((path.states - last.u) / sizes, axis=1) > CUT
        ends -= int(np.argmax(away[::-1]))
    return Path(path.times[begins:ends], path.states[begins:ends]).checked(path.states.shape[1])


def _departures(first: Rest | Cycle, sizes: Array) -> Iterator[Departure]:
    """Starts in the unstable directions, with the phase of a cycle."""
    if isinstance(first, Rest):
        basis = first.basis(True, sizes)
        if basis.shape[1] > 2:
            raise InputError(f"an equilibrium with {basis.shape[1]} unstable directions: one or two are searched")
        length = LEAVING / float(np.max(np.abs(basis) / sizes[:, None]))
        count = 2 if basis.shape[1] == 1 else ANGLES

        def around(place: float) -> tuple[Array, float]:
            angle = 2.0 * np.pi * place
            parts = np.array([float(elementary.cos(angle)), float(elementary.sin(angle))])[: basis.shape[1]]
            return first.u + length * (basis @ parts), 0.0

        for k in range(count):
            yield Departure(around, k / count, None if count == 2 else 1.0 / count)
        return
    multipliers = first.outside(True)
    if len(multipliers) != 1:
        raise InputError(
            f"a cycle with {len(multipliers)} unstable multipliers: only orbits that leave along one are searched"
        )
    phases = np.arange(PHASES) / PHASES
    length = _leaving(first) / float(np.max(np.abs(first.direction(multipliers[0], phases)) / sizes))

    def beside(sense: float) -> Callable[[float], tuple[Array, float]]:
        """At one distance in the mode: every orbit of the manifold passes it once a turn of the phase."""

        def at(place: float) -> tuple[Array, float]:
            phase = np.array([place % 1.0])
            w = first.direction(multipliers[0], phase)[0]
            return first.profile.at(phase)[0] + sense * length * w, float(phase[0])

        return at

    for sense in (1.0, -1.0):
        for k in range(PHASES):
            yield Departure(beside(sense), k / PHASES, 1.0 / PHASES)
