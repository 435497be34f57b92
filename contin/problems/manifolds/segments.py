"""Orbit segments on a manifold of an equilibrium: its two branches where it is a curve, a disc of them for a surface.

A segment begins at a distance DELTA from the equilibrium in the eigenspace and is as long as was asked for. On a
surface the segments begin on a circle there; between two neighbours whose distance at equal arclength exceeds the
spacing another one is laid. Where rates differ much, orbits whose starts differ by less than rounding part by the size
of the whole surface: such a new one begins later, where its neighbours are still close.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.integrate import solve_ivp

from contin.abi import Array
from contin.errors import NotFiniteError
from contin.machine import elementary
from contin.problems.manifolds.eigenspace import Eigenspace

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

DELTA: Final = 1e-5  # of the length: where segments begin
RTOL: Final = 1e-10
LONGEST: Final = 200.0  # times of the slowest rate of the eigenspace
FIRST: Final = 16  # segments of a disc
MOST: Final = 400
CLOSEST: Final = 1e-6  # of angles, between which orbits are laid from a place where they are farther apart
LINK: Final = 1e-5  # ... of the length


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of an orbit: arclengths s, times t (negative on a stable manifold) and states u, (K,), (K,), (K, n).

    angle : where it begins on the circle; for a curve 0 or pi. whole : False where it ends before its length.
    """

    angle: float
    s: Array
    t: Array
    u: Array
    whole: bool


@dataclass(frozen=True, eq=False)
class Grower:
    """Segments on the manifold of the equilibrium u0 at p, `backward` in time for a stable one."""

    system: CompiledSystem
    u0: Array
    p: Array
    space: Eigenspace
    length: float
    samples: int
    backward: bool

    @property
    def lengths(self) -> Array:
        """Arclengths at which segments are sampled."""
        return np.linspace(DELTA * self.length, self.length, self.samples)

    def segment(self, angle: float) -> Segment:
        """The orbit that begins at an angle of the circle in the eigenspace."""
        start = self.u0 + DELTA * self.length * (self.space.basis @ self._direction(angle))
        s, t, u, whole = self._flown(start, self.lengths, angle)
        return Segment(angle, s, t, u, whole)

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
        sign = -1.0 if self.backward else 1.0

        def rate(_: float, y: Array) -> Array:
            f = sign * np.asarray(self.system.value(y[:-1], self.p))
            return np.append(f, np.linalg.norm(f))

        def reached(_: float, y: Array) -> float:
            return float(y[-1] - s[-1])

        reached.terminal = True  # type: ignore[attr-defined]
        slowest = float(np.min(np.abs(self.space.values.real)))
        found = solve_ivp(
            rate, (0.0, LONGEST / slowest), np.append(start, s[0]), method="DOP853", rtol=RTOL,
            atol=1e-3 * RTOL * self.length, events=reached, dense_output=True,
        )  # fmt: skip
        if found.status < 0 or not np.all(np.isfinite(found.y)):
            raise NotFiniteError(
                f"manifold: the orbit at angle {angle:.6g} leaves the equations' domain, or is too stiff; ask for a "
                "shorter length"
            )
        last, whole = float(found.y[-1, -1]), found.status == 1
        s = s if whole else np.linspace(s[0], last, len(s))
        fine = np.unique(np.concatenate([found.t, np.linspace(0.0, found.t[-1], 8 * self.samples)]))
        t = np.interp(s, found.sol(fine)[-1], fine)
        for _ in range(3):  # Newton's method for the time at which the length is s
            here = found.sol(t)
            speed = np.linalg.norm(self.system.values(here[:-1].T.copy(), self.p), axis=1)
            t = np.clip(t + (s - here[-1]) / np.maximum(speed, 1e-300), 0.0, found.t[-1])
        return s, sign * t, found.sol(t)[:-1].T.copy(), whole

    def _direction(self, angle: float) -> Array:
        if self.space.dimension == 1:
            return np.array([1.0 if abs(angle) < 1.0 else -1.0])
        return np.array([elementary.cos(angle), elementary.sin(angle)])


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
