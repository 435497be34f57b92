"""Shooting: the unknowns are the states where segments start, and all between is the flow (Sanchez, Net,
Garcia-Archilla and Simo, J. Comput. Phys. 201 (2004) 13; Net and Sanchez, Int. J. Bifurcation Chaos 25 (2015)).

The steps of a segment are halves, quarters, ... of equal ones; which, is chosen by their errors where a march sets out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.factor import Factoriser
from contin.linalg.vectors import norm
from contin.problems.large_orbits.flow import Known, Stepper, flow, local_errors
from contin.problems.large_orbits.layout import Layout
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import STAGES, Trajectory
from contin.problems.large_orbits.sweeps import Jumps, Sweeps

TOLERANCE: Final = 1e-8  # of the error of one step, relative to the orbit's amplitude
ORDER: Final = 6  # of that error in the length
STEPS: Final = 16  # equal steps of a period that are halved, at least
ALIKE: Final = 0.05  # part of the amplitude by which orbits differ that have one mesh
STILL: Final = 1e-7  # amplitude, relative to the states, up to which an orbit says nothing about steps
ZERO: Final = 1e-8  # size of states, relative to the typical ones, that is the smallest
DEEPEST: Final = 16  # halvings
PASSES: Final = 8


@dataclass(frozen=True)
class Step:
    """The `place`-th of 2^level parts of an equal step."""

    equal: int
    level: int
    place: int

    def halves(self) -> tuple[Step, Step]:
        return Step(self.equal, self.level + 1, 2 * self.place), Step(self.equal, self.level + 1, 2 * self.place + 1)


@dataclass(frozen=True)
class Mesh:
    """Steps of a period, of `equal` ones."""

    equal: int
    steps: tuple[Step, ...]

    @classmethod
    def even(cls, equal: int) -> Mesh:
        return cls(equal, tuple(Step(j, 0, 0) for j in range(equal)))

    @property
    def lengths(self) -> Array:
        return np.array([math.ldexp(1.0, -step.level) for step in self.steps]) / self.equal

    def first_of(self, equal: int) -> int:
        """Place of the step with which an equal one begins."""
        return next(j for j, step in enumerate(self.steps) if step.equal == equal)

    def halved(self) -> Mesh:
        return Mesh(self.equal, tuple(half for step in self.steps for half in step.halves()))

    def refined(self, errors: Array) -> Mesh:
        """Steps with errors that are too large cut into 2, 4 or 8."""
        made: list[Step] = []
        for step, error in zip(self.steps, errors.tolist(), strict=True):
            parts = [step]
            while error > TOLERANCE and parts[0].level < min(step.level + 3, DEEPEST):
                parts = [half for part in parts for half in part.halves()]
                error = math.ldexp(error, -ORDER)
            made += parts
        return Mesh(self.equal, tuple(made))

    def coarsened(self, errors: Array) -> Mesh:
        """Halves joined whose step would not be too long by far."""
        made: list[tuple[Step, float]] = []
        for step, error in zip(self.steps, errors.tolist(), strict=True):
            if made and step.level > 0 and step.place % 2 == 1:
                other, before = made[-1]
                joined = math.ldexp(max(before, error), ORDER + 1)
                if (other.equal, other.level, other.place) == (step.equal, step.level, step.place - 1) and (
                    joined < 0.25 * TOLERANCE
                ):
                    made[-1] = Step(step.equal, step.level - 1, step.place // 2), joined
                    continue
            made.append((step, error))
        return Mesh(self.equal, tuple(step for step, _ in made))


@dataclass(eq=False)
class Course:
    """What is kept between calls: the mesh, and the last orbit with its solvers."""

    mesh: Mesh | None = None
    fixed: bool = False  # the mesh stays
    measured: tuple[Array, float] | None = None  # states of the orbit that the mesh was made for, and its reach
    last: tuple[Array, Array, float] | None = None  # states, parameters and period of ...
    known: Known | None = None  # ... this orbit
    factoriser: Factoriser = field(default_factory=Factoriser)


@dataclass(frozen=True, eq=False)
class FromStarts(Layout):
    """x (segments, n), where segments of equal length start."""

    segments: int = 1
    course: Course = field(default_factory=Course)

    def count(self, n: int) -> int:
        return self.segments * n

    @property
    def _mesh(self) -> Mesh:
        if self.course.mesh is None:
            each = -(-STEPS // self.segments)
            self.course.mesh = Mesh.even(each * self.segments).halved()  # joined again where their errors allow it
        return self.course.mesh

    @property
    def starts(self) -> list[int]:
        """Places of the steps with which segments start."""
        mesh = self._mesh
        return [mesh.first_of(s * (mesh.equal // self.segments)) for s in range(self.segments)]

    def vector(self, orbit: Trajectory) -> Array:
        if self.segments == 1:
            return np.array(orbit.beginnings[0])
        return orbit.at(np.arange(self.segments) / self.segments).ravel()

    def orbit(self, points: Points, p: Array, states: Array, period: float) -> Trajectory:
        course = self.course
        if course.mesh is None:
            self.prepare(points, p, states, period)
        lengths = self._mesh.lengths
        if course.last is None or not (
            np.array_equal(course.last[0], states) and np.array_equal(course.last[1], p) and course.last[2] == period
        ):
            found = self._flown(points, p, states, period, lengths)
            if found is None:
                n = states.size // self.segments
                nothing = np.full((len(lengths), STAGES, n), np.nan)
                return Trajectory(nothing, period, lengths, nothing[:, 0])
            course.last, course.known = (states.copy(), p.copy(), period), found
        assert course.known is not None
        return Trajectory(course.known.U, period, lengths, course.known.beginnings)

    def _flown(self, points: Points, p: Array, states: Array, period: float, lengths: Array) -> Known | None:
        x = states.reshape(self.segments, -1)
        if not (np.all(np.isfinite(states)) and np.isfinite(period)):
            return None
        stepper = Stepper(points, p, _size(points, states), self.course.factoriser)
        return flow(stepper, dict(zip(self.starts, x, strict=True)), period * lengths, self.course.known)

    def prepare(self, points: Points, p: Array, states: Array, period: float) -> None:
        course = self.course
        if course.fixed or (course.measured is not None and norm(states - course.measured[0]) < course.measured[1]):
            return
        stepper = Stepper(points, p, _size(points, states), course.factoriser)
        for _ in range(PASSES):
            mesh = self._mesh
            found = self._flown(points, p, states, period, mesh.lengths)
            if found is None:
                finer = mesh.halved()
                errors = np.full(len(mesh.steps), np.inf)
            else:
                amplitude = norm(np.ptp(found.beginnings, axis=0))
                if amplitude <= STILL * stepper.size:
                    return
                course.measured = states.copy(), ALIKE * amplitude
                errors = local_errors(stepper, found, period * mesh.lengths) / amplitude
                finer = mesh.refined(errors)
            if len(finer.steps) == len(mesh.steps):
                finer = mesh.coarsened(errors)
                if len(finer.steps) < len(mesh.steps):
                    self._use(finer)
                return
            self._use(finer)

    def _use(self, mesh: Mesh) -> None:
        self.course.mesh, self.course.last, self.course.known = mesh, None, None

    def remember(self, sweeps: Sweeps) -> None:
        known = self.course.known
        if known is not None and len(known.U) == len(sweeps.intervals):
            self.course.known = Known(known.U, known.beginnings, tuple(sweeps.intervals))

    def defects(self, points: Points, p: Array, states: Array, orbit: Trajectory) -> Array:
        ends = [orbit.U[j - 1, 2] for j in self.starts]
        return np.asarray(states - np.concatenate(ends))

    def jumped(self, points: Points, left: Array, jump: Array) -> Array:
        return np.append(left[: jump.size] - jump, left[jump.size :])

    def slopes(self, points: Points, p: Array, orbit: Trajectory) -> Array:
        with np.errstate(all="ignore"):
            return np.asarray(orbit.period * points.values(orbit.beginnings[self.starts], p).ravel())

    def turned(self, points: Points, p: Array, states: Array, change: Array, period: float) -> Array:
        found = points.jacobians(states.reshape(self.segments, -1), p)
        if found is None:
            return np.full(states.size, np.nan)
        rows = change.reshape(self.segments, -1)
        return np.asarray(period * np.concatenate([J @ row for J, row in zip(found, rows, strict=True)]))

    def weights(self, orbit: Trajectory) -> Array:
        return np.full(self.segments * orbit.U.shape[2], 1.0 / self.segments)

    def pick(self, d: Vector, beginning: Vector, jumps: Jumps | None) -> Vector:
        nodes = [beginning]
        for j in self.starts[1:]:
            nodes.append(d[j - 1, 2] + (0.0 if jumps is None else jumps.get(j, 0.0)))
        return np.concatenate(nodes)

    def sides(self, right: Array, n: int) -> tuple[Array | None, Jumps | None]:
        return None, dict(zip(self.starts, right.reshape(self.segments, n), strict=True))

    def carried(self, sweeps: Sweeps, states: Array, right: Callable[[], Array]) -> Array:
        forced = right()
        rows = states.reshape(self.segments, -1)
        ends = [*self.starts[1:], len(sweeps.intervals)]
        parts = []
        for row, begin, end in zip(rows, self.starts, ends, strict=True):
            parts.append(Sweeps(sweeps.intervals[begin:end], sweeps.n).along(row, forced[begin:end]))
        return np.concatenate(parts)

    def finer(self) -> tuple[Layout, Callable[[Trajectory], Array] | None]:
        return FromStarts(self.segments, Course(self._mesh.halved(), True)), None

    def doubled(self) -> Layout:
        return FromStarts(2 * self.segments)


def _size(points: Points, states: Array) -> float:
    """Of the states, about which corrections are rounding."""
    return max(norm(states), ZERO * norm(points.system.lines.sizes[: points.system.n]))
