"""Regions checked by a second method: their equilibria continued across them, by Newton at fixed parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.diagram.identity import wrapped
from contin.diagram.phase.plane import Face
from contin.diagram.phase.states import State, images_of
from contin.diagram.sizes import length, sizes_among
from contin.linalg.newton import Rules, newton, solution
from contin.linalg.polygons import clearance, inside

OTHERS: Final = 3  # points of a region to which its states are continued
TRIED: Final = 40  # points of a region among which they are chosen
ALONG: Final = 40  # points of a path that must be clear of the border
CLEAR: Final = 2e-3  # distance of a path from the border, as part of the box
FIRST, SHORTEST = 1.0 / 16.0, 1e-5  # steps along a path, as parts of it
NEWTON: Final = Rules(settled=1e-10, stalled=1e-10, budget=8)  # sizes are relative to the state's
FAR: Final = 0.1  # ... and the change of a state in one step
PREDICTED: Final = 0.2  # ... part of that change which the prediction may lack
DIFFERENCE: Final = 1e-6  # of the way, over which its slope is taken
NEAR: Final = 1e-6  # ... unless it is next to nothing
MARGIN: Final = 1e-9  # of the largest eigenvalue: what is this near to the axis is not unstable beyond doubt
ALIKE: Final = 1e-5  # relative distance of two states that are one


@dataclass(frozen=True)
class Check:
    """How many paths of equilibria were followed, and what became of those that did not arrive, or changed stability.

    led : trajectories from stable orbits that were led to other points.  places : where equilibria disagreed.
    """

    followed: int = 0
    disagreed: tuple[str, ...] = ()
    led: int = 0
    places: tuple[tuple[float, float], ...] = ()

    def __add__(self, other: Check) -> Check:
        return Check(
            self.followed + other.followed, self.disagreed + other.disagreed, self.led + other.led,
            self.places + other.places,
        )  # fmt: skip

    @property
    def words(self) -> str:
        """For the report."""
        parts = []
        if self.followed:
            parts.append(f"{self.followed} paths of equilibria by Newton at fixed parameters")
        if self.led:
            parts.append(f"{self.led} of stable orbits by trajectories with drifting parameters")
        return f"{', '.join(parts)}, across their regions: {len(self.disagreed)} disagreed"


@dataclass(frozen=True, eq=False)
class Plane:
    """The equilibria of a model at points of the unit square that stands for the box."""

    problem: Any
    names: tuple[str, str]
    low: Array
    width: Array

    def parameters(self, point: Array) -> Array:
        """All parameters at a point of the unit square."""
        p: Array = np.array(self.problem.base)
        own = list(self.problem.system.parameter_names)
        p[[own.index(name) for name in self.names]] = self.low + self.width * point
        return p

    def followed(self, u: Array, a: Array, b: Array, unstable: int = 0) -> Array | None:
        """The equilibrium u at a, continued along the straight way to b with as many unstable eigenvalues.

        None where it ends, or another number of them is unstable.
        """
        done, step = 0.0, FIRST
        typical = self._typical(u, a)
        while done < 1.0:
            ahead = min(done + step, 1.0)
            p = self.parameters(a + ahead * (b - a))
            guess = u + (ahead - done) * self._slope(u, a + done * (b - a), b - a)
            found = self._solved(guess, p, typical)
            sizes = np.maximum(np.abs(u), typical)
            if found is None or _is_elsewhere(found, guess, u, sizes) or not self._is_as_stable(found, p, unstable):
                step /= 2.0  # it may be another state that Newton came to
                if step < SHORTEST:
                    return None
                continue
            u, done = found, ahead
            step *= 1.5
        return u

    def _slope(self, u: Array, point: Array, way: Array) -> Array:
        """du/ds of the state along point + s way; 0 where the equations have none."""
        n, system = self.problem.n, self.problem.system
        here, ahead = self.parameters(point), self.parameters(point + DIFFERENCE * way)
        matrix = system.jacobian(u, here)[1][:, :n] - (np.eye(n) if self.problem.is_map else 0.0)
        change = (np.asarray(system.value(u, ahead)) - np.asarray(system.value(u, here))) / DIFFERENCE
        try:
            slope = np.linalg.solve(matrix, -change)
        except np.linalg.LinAlgError:
            return np.zeros(n)
        return slope if np.all(np.isfinite(slope)) else np.zeros(n)

    def _typical(self, u: Array, point: Array) -> Array:
        """Sizes of the states at u, where they may pass through zero: those of the metric of a branch from there."""
        k = list(self.problem.system.parameter_names).index(self.names[0])
        problem = replace(self.problem, base=self.parameters(point), active=k)
        bounds = float(self.low[0]), float(self.low[0] + self.width[0])
        scale = problem.initial_scale(np.append(u, problem.base[k]), bounds)
        return np.asarray(scale[:-1] / np.sqrt(self.problem.n))

    def _solved(self, u: Array, p: Array, typical: Array) -> Array | None:
        n, is_map = self.problem.n, self.problem.is_map

        def correct(u: Array) -> tuple[float, Array] | None:
            f, matrix = self.problem.system.jacobian(u, p)
            a, r = (matrix[:, :n] - np.eye(n), f - u) if is_map else (matrix[:, :n], f)
            step = solution(a, -r)
            if step is None:
                return None
            return float(np.max(np.abs(step) / np.maximum(np.abs(u + step), typical))), u + step

        found = newton(correct, u, NEWTON)  # None: no equilibrium there, which the check then tells
        return None if found is None else found.at

    def _is_as_stable(self, u: Array, p: Array, unstable: int) -> bool:
        """True where so many eigenvalues are unstable, but for those that are on the border to rounding."""
        values = np.linalg.eigvals(self.problem.system.jacobian(u, p)[1][:, : self.problem.n])
        slack = MARGIN * float(np.abs(values).max(initial=0.0))
        outside = np.abs(values) - 1.0 if self.problem.is_map else values.real
        return bool(np.sum(outside > slack) <= unstable <= np.sum(outside >= -slack))

    def same(self, u: Array, v: Array) -> bool:
        """True where v is u, or an image of it under a declared symmetry."""
        value = float(self.problem.base[self.problem.active])
        sizes, periods = sizes_among(self.problem, [u, v], value), np.asarray(self.problem.angle_periods)
        images = images_of(self.problem, np.append(v, value), sizes)
        return any(length(wrapped(u - w, periods), sizes) <= ALIKE for w in images)


def _is_elsewhere(found: Array, guess: Array, u: Array, sizes: Array) -> bool:
    """True where Newton's result is far from u, or went on from the guess further than the way from u explains."""
    moved, corrected = length(found - u, sizes), length(found - guess, sizes)
    return moved > FAR or (corrected > PREDICTED * moved and moved > NEAR)


def stable_equilibria(states: Sequence[State], rests: Sequence[State]) -> list[Array]:
    """Those that can be continued: not orbits, nor rest where the equations have no derivatives."""
    return [s.vector for s in states if not s.is_orbit and s.unstable == 0 and s not in rests]


def equilibria_of(states: Sequence[State], rests: Sequence[State]) -> list[tuple[Array, int]]:
    """Those that can be continued, with their numbers of unstable eigenvalues."""
    return [(s.vector, s.unstable) for s in states if not s.is_orbit and s not in rests]


def checked(plane: Plane, face: Face, point: Array, equilibria: Sequence[tuple[Array, int]], name: str) -> Check:
    """The equilibria at the region's point, continued to others inside along straight ways.

    equilibria : each with its number of unstable eigenvalues.
    """
    followed, disagreed = 0, []
    places: dict[tuple[float, float], None] = {}
    for other in others(face, point) if equilibria else []:
        for u, unstable in equilibria:
            followed += 1
            if plane.followed(u, point, other, unstable) is None:
                where = ", ".join(f"{value:.4g}" for value in u)
                kind = "the stable" if unstable == 0 else "the unstable"
                change = f"is not there, or its stability is another, at {place_of(plane, other)}"
                disagreed.append(f"region {name}: {kind} equilibrium ({where}) at its point {change}")
                first, second = (plane.low + plane.width * other).tolist()
                places[first, second] = None
    return Check(followed, tuple(disagreed), places=tuple(places))


def alike(plane: Plane, a: Array, b: Array, here: Sequence[Array], there: Sequence[Array]) -> bool:
    """True where the stable equilibria at a, continued to b, are those at b."""
    ends = [plane.followed(u, a, b) for u in here]
    return all(end is not None and any(plane.same(end, v) for v in there) for end in ends)


def others(face: Face, point: Array) -> list[Array]:
    """Points inside, far from the given one and from each other, that a straight way inside leads to."""
    rings = [face.outline, *face.holes]
    low, high = face.outline.min(axis=0), face.outline.max(axis=0)
    candidates = np.random.default_rng(11).uniform(low, high, (TRIED * 4, 2))
    candidates = candidates[inside(candidates, rings)][:TRIED]
    t = np.linspace(0.0, 1.0, ALONG)[:, None]
    reached = []
    for other in candidates:
        way = point + t * (other - point)
        if not _crosses(point, other, rings) and float(clearance(way, rings).min()) > CLEAR:
            reached.append(other)
    chosen: list[Array] = []
    while reached and len(chosen) < OTHERS:
        gaps = [min(float(np.abs(c - o).max()) for o in [point, *chosen]) for c in reached]
        chosen.append(reached.pop(int(np.argmax(gaps))))
    return chosen


def _crosses(a: Array, b: Array, rings: Sequence[Array]) -> bool:
    """True where the straight way from a to b crosses the border: the tip of a cusp is thin."""

    def side(first: Array, second: Array, points: Array) -> Array:
        way, offset = second - first, points - first
        return np.asarray(np.sign(way[..., 0] * offset[..., 1] - way[..., 1] * offset[..., 0]))

    for ring in rings:
        c, d = ring, np.roll(ring, -1, axis=0)
        if np.any((side(a, b, c) * side(a, b, d) <= 0.0) & (side(c, d, a) * side(c, d, b) <= 0.0)):
            return True
    return False


def place_of(plane: Plane, point: Array) -> str:
    """In words."""
    values: Mapping[str, float] = dict(zip(plane.names, (plane.low + plane.width * point).tolist(), strict=True))
    return ", ".join(f"{name} = {value:.6g}" for name, value in values.items())
