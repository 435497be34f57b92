"""The linearised equations of an orbit: factors of one point, and solves with them as precise as each is needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.linalg.recycled import Recycled
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits.layout import Layout
from contin.problems.large_orbits.multipliers import Multipliers
from contin.problems.large_orbits.sweeps import Closed, Sweeps, Wanted

FORCED: Final = 0.1  # of the square of a correction: the part of the next one that GMRES may leave (Eisenstat and
# Walker 1996), so that corrections fall as Newton's do, ...
CHORD: Final = 0.01  # ... and of a correction by the matrix of another point, which does not fall as fast
TANGENT: Final = 1e-9  # error of tangents that a march steps along


@dataclass(frozen=True, eq=False)
class Jump:
    """The orbit begins `length` times `direction` (n,) away from where it ends; the length is an unknown behind T."""

    direction: Array
    length: float


@dataclass(eq=False)
class Solvers:
    """The factors of one point, and what solves with them, and with those of points nearby, have learnt."""

    z: Array
    h: Array  # lengths of the intervals
    sweeps: Sweeps
    jacobians: Sequence[csc_matrix]  # at all points
    forces: dict[tuple[int, ...], Array] = field(default_factory=dict)  # by dT and dp, by places of parameters, ...
    answers: dict[tuple[int, ...], Array] = field(default_factory=dict)  # ... and what they lead to
    recycled: dict[tuple[int, bool], Recycled] = field(default_factory=dict)  # by the number of conditions, and jumps
    leading: Multipliers | None = None

    def product(self, d: Vector) -> Vector:
        """J d at all points, (N, 3, n), real or complex."""
        rows = d.reshape(-1, d.shape[-1])
        return np.array([J @ row for J, row in zip(self.jacobians, rows, strict=True)]).reshape(d.shape)

    def copy(self) -> Solvers:
        """The same factors with what is known now: a gauge, which does not learn from what is asked beside a march."""
        return replace(self, recycled={k: known.copy() for k, known in self.recycled.items()})


@dataclass(frozen=True, eq=False)
class OrbitLinearisation:
    """Scaled residual, and [J; rows] in scaled unknowns: one row (the tangent), or more where parameters vary.

    rough : for a march, which needs points and tangents to its own tolerance.
    chord : the residual is that of another point.
    """

    residual: Array
    closed: Closed
    scale: Array
    layout: Layout
    again: bool = False
    rough: bool = False
    chord: bool = False
    sign: float = 1.0

    @cached_property
    def _null(self) -> Array:
        right = np.append(np.zeros(len(self.scale) - 1), 1.0)
        return self._solved(right, wanted=_tangents) if self.rough else self._solved(right, again=True)

    @property
    def log_determinant(self) -> float:
        """-log |M^-1 e|, with which the test for branch points is constant: multipliers tell them here."""
        length = norm(self._null)
        return -float(elementary.log(length)) if 0.0 < length < np.inf else 0.0

    @property
    def rows(self) -> int:
        """Conditions below the orbit's equations: the phase and those of the curve."""
        return len(self.closed.answers)

    def solve(self, right: Array) -> Array:
        """M x = right, in scaled unknowns."""
        if right[-1] == 1.0 and not right[:-1].any() and not self.again:
            return self._null
        return self._solved(right, self.again)

    def correction(self, right: Array, tolerance: float) -> Array:
        """The same for Newton's method, as far as the next correction does not undo it."""
        if not self.rough:
            return self._solved(right, self.again)
        return self._solved(right, wanted=_chords if self.chord else _corrections)

    def _solved(self, right: Array, again: bool = False, wanted: Wanted | None = None) -> Array:
        k = self.rows
        states = right[:-k] * self.scale[:-k]
        sides = self.closed_sides(states) if states.any() else (None, None)
        x, rest, _ = self.closed.solve(*sides, right[-k:], again, wanted)
        return np.concatenate([x, rest]) / self.scale

    def closed_sides(self, states: Array) -> tuple[Array | None, dict[int, Vector] | None]:
        """A right side of the orbit's equations as the sweeps take it."""
        stages, jumps = self.layout.sides(states, self.closed.sweeps.n)
        return stages, None if jumps is None else dict(jumps)

    def response(self, stages: Array) -> Array:
        """M x = a right side (N, 3, n) of the stages, in scaled unknowns."""
        x, rest, _ = self.closed.solve(stages, None, np.zeros(self.rows), self.again)
        return np.concatenate([x, rest]) / self.scale


def _corrections(length: float) -> float:
    return FORCED * length * min(length, 1.0)


def _chords(length: float) -> float:
    return CHORD * length


def _tangents(length: float) -> float:
    return TANGENT * length
