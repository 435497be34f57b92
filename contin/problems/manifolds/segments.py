"""Orbit segments on a manifold: two branches where it is a curve, a disc or a ring of them for a surface.

A segment begins at a distance DELTA from the equilibrium in the eigenspace (from the cycle along its Floquet direction)
and is as long as was asked for. On a surface the segments begin on a closed curve there; between two neighbours whose
distance at equal arclength exceeds the spacing another one is laid. Where rates differ much, orbits whose starts differ
by less than rounding part by the size of the whole surface: such a new one begins later, where its neighbours are still
close.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.errors import NotFiniteError
from contin.lowering.system import compile_system
from contin.machine import elementary
from contin.problems.manifolds.eigenspace import Eigenspace
from contin.simulate.flight import DONE, Flight, fly
from contin.simulate.section import Section
from contin.symbolic.passes.arclength import with_arclength

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.problems.orbits.rests_and_cycles import Cycle

DELTA: Final = 1e-5  # of the length: where segments begin
RTOL: Final = 1e-10
LINEAR, AWAY = 1e-4, 1e-2  # of a cycle's extent
LONGEST: Final = 200.0  # times of the slowest rate of the eigenspace
FIRST: Final = 16  # segments of a disc
MOST: Final = 400
CLOSEST: Final = 1e-6  # of angles, between which orbits are laid from a place where they are farther apart
LINK: Final = 1e-5  # ... of the length


@dataclass(frozen=True, eq=False)
class Segment:
    """Part of an orbit: arclengths s, times t (negative on a stable manifold) and states u, (K,), (K,), (K, n).

    angle : where it begins on the circle; for a curve 0 or pi. whole : False where it ends before its length.
    """

    angle: float
    s: Array
    t: Array
    u: Array
    whole: bool


class Source(Protocol):
    """What a manifold belongs to: where its segments begin, by an angle in [0, 2 pi), and its slowest rate."""

    @property
    def rate(self) -> float: ...

    @property
    def wait(self) -> float:
        """Time that orbits take before their length counts."""

    def start(self, angle: float, distance: float) -> Array: ...


@dataclass(frozen=True, eq=False)
class FromRest:
    """An equilibrium u0 with the eigenspace of its manifold."""

    u0: Array
    space: Eigenspace

    wait = 0.0

    @property
    def rate(self) -> float:
        return float(np.min(np.abs(self.space.values.real)))

    def start(self, angle: float, distance: float) -> Array:
        if self.space.dimension == 1:
            direction = np.array([1.0 if abs(angle) < 1.0 else -1.0])
        else:
            direction = np.array([elementary.cos(angle), elementary.sin(angle)])
        return np.asarray(self.u0 + distance * (self.space.basis @ direction))


@dataclass(frozen=True, eq=False)
class FromCycle:
    """A cycle, beside which a closed curve runs along the Floquet direction of one multiplier.

    With a negative one the curve closes after two turns, and its two senses are one. Orbits begin at LINEAR of the
    cycle's extent from it, and their lengths count from about AWAY of it on: a weak multiplier takes many
    turns.
    """

    cycle: Cycle
    multiplier: float
    sense: float

    @property
    def rate(self) -> float:
        return abs(float(elementary.log(abs(self.multiplier)))) / self.cycle.period

    @property
    def wait(self) -> float:
        return float(elementary.log(AWAY / LINEAR)) / self.rate

    @property
    def turns(self) -> int:
        return 1 if self.multiplier > 0.0 else 2

    def start(self, angle: float, distance: float) -> Array:
        phase = self.turns * angle / (2.0 * np.pi)
        here = np.array([phase % 1.0])
        sense = self.sense if phase < 1.0 else -self.sense
        v = self.cycle.direction(self.multiplier, here)[0]
        extent = float(np.linalg.norm(np.ptp(self.cycle.states, axis=0)))
        return np.asarray(self.cycle.profile.at(here)[0] + sense * LINEAR * extent * v / np.linalg.norm(v))


@dataclass(frozen=True, eq=False)
class Grower:
    """Segments on a manifold at p, `backward` in time for a stable one."""

    system: CompiledSystem
    p: Array
    source: Source
    length: float
    samples: int
    backward: bool

    @property
    def lengths(self) -> Array:
        """Arclengths at which segments are sampled."""
        return np.linspace(DELTA * self.length, self.length, self.samples)

    def segment(self, angle: float) -> Segment:
        """The orbit that begins at an angle of the circle in the eigenspace."""
        start = self.source.start(angle, DELTA * self.length)
        if self.source.wait:
            start = self._waited(start, angle)
        s, t, u, whole = self._flown(start, self.lengths, angle)
        return Segment(angle, s, t, u, whole)

    @cached_property
    def flow(self) -> CompiledSystem:
        """The flow, in the sense of time in which the manifold grows, with the arclength as a last state."""
        return compile_system(with_arclength(self.system.computable, self.backward), regular=True)

    def _flight(self, y: Array, duration: float, atol: float, angle: float, **wanted: Any) -> Flight:
        """Of states with their arclength, (n + 1,)."""
        found = fly(self.flow, y, self.p, duration, rtol=RTOL, atol=atol, **wanted)
        if found.outcome != DONE or not np.all(np.isfinite(found.end)):
            raise NotFiniteError(
                f"manifold: the orbit at angle {angle:.6g} leaves the equations' domain, or is too stiff; ask for a "
                f"shorter length ({found.why})"
            )
        return found

    def _waited(self, start: Array, angle: float) -> Array:
        atol = 1e-5 * RTOL * self.length
        return self._flight(np.append(start, 0.0), self.source.wait, atol, angle).end[:-1]

    def between(self, a: Segment, b: Segment) -> Segment:
        """An orbit between two whose starts are too near for rounding: it begins where they are `LINK` near.

        There it is laid halfway, which is wrong by the square of their distance times the surface's curvature.
        """
        near = np.linalg.norm(a.u - b.u, axis=1) <= LINK * self.length
        j = max(int(np.argmin(near)) - 1, 0) if not near.all() else len(near) - 1
        middle, clock = 0.5 * (a.u[: j + 1] + b.u[: j + 1]), 0.5 * (a.t[: j + 1] + b.t[: j + 1])
        s, t, u, whole = self._flown(middle[-1], self.lengths[j:], a.angle)
        return Segment(
            a.angle, np.concatenate([self.lengths[:j], s]), np.concatenate([clock[:-1], clock[-1] + t]),
            np.concatenate([middle[:-1], u]), whole,
        )  # fmt: skip

    def _flown(self, start: Array, s: Array, angle: float) -> tuple[Array, Array, Array, bool]:
        """The orbit from a state at arclength s[0] on, at the lengths s; spread evenly where it ends before them."""
        y, longest, atol = np.append(start, s[0]), LONGEST / self.source.rate, 1e-3 * RTOL * self.length
        reached = Section(np.eye(len(y))[-1], float(s[-1]))
        steps: list[float] = []
        found = self._flight(y, longest, atol, angle, section=reached, events=1, steps=steps)
        whole = len(found.events) == 1
        end = float(found.events[0, 0]) if whole else found.end_time
        s = s if whole else np.linspace(s[0], found.end[-1], len(s))

        def at(times: Array) -> Array:
            return self._flight(y, longest, atol, angle, section=reached, events=1, times=times).samples

        inside = np.array([0.0, *steps])
        fine = np.unique(np.concatenate([inside[inside < end], np.linspace(0.0, end, 8 * self.samples)[:-1]]))
        t = np.interp(s, np.append(at(fine)[:, -1], s[-1]), np.append(fine, end))
        for _ in range(3):  # Newton's method for the time at which the length is s
            here = at(t[:-1])
            speed = np.linalg.norm(self.system.values(here[:, :-1], self.p), axis=1)
            t[:-1] = np.clip(t[:-1] + (s[:-1] - here[:, -1]) / np.maximum(speed, 1e-300), 0.0, end)
            t = np.maximum.accumulate(t)
        u = np.vstack([at(t[:-1]), found.events[0, 1:] if whole else found.end])[:, :-1]
        return s, -t if self.backward else t, u, whole


def curve(grower: Grower) -> list[Segment]:
    """Both branches of a one-dimensional manifold."""
    return [grower.segment(np.pi), grower.segment(0.0)]


def disc(grower: Grower, spacing: float) -> tuple[list[Segment], float]:
    """Segments of a two-dimensional manifold in their order round it, and the widest gap left between two."""
    ring = [grower.segment(2.0 * np.pi * k / FIRST) for k in range(FIRST)]
    apart = 0.0
    gaps = [_gap(one, ring[(k + 1) % FIRST]) for k, one in enumerate(ring)]
    while len(ring) < MOST:
        k = int(np.argmax(gaps))
        if gaps[k] <= spacing:
            break
        left, right = ring[k], ring[(k + 1) % len(ring)]
        turn = (right.angle - left.angle) % (2.0 * np.pi)
        if turn <= CLOSEST and not (left.whole and right.whole):  # one of them comes to rest, the other goes on
            apart, gaps[k] = max(apart, gaps[k]), 0.0
            continue
        if turn > CLOSEST:
            middle = grower.segment((left.angle + 0.5 * turn) % (2.0 * np.pi))
        else:
            middle = grower.between(left, right)
        ring.insert(k + 1, middle)
        gaps[k : k + 1] = [_gap(left, middle), _gap(middle, right)]
    return ring, max(apart, *gaps)


def _gap(a: Segment, b: Segment) -> float:
    """The largest distance of two segments at equal parts of their lengths."""
    return float(np.max(np.linalg.norm(a.u - b.u, axis=1)))
