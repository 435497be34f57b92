"""The bordered shooting equations at a point, dense, and the tangents of the families through it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary
from contin.problems.shooting.fixed_space import FixedSpace, kept_direction
from contin.problems.shooting.layout import moving
from contin.problems.shooting.segments import Segments

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

BROKEN = 1e-3  # part of a direction of a null space that the symmetries of the orbits keep, where they keep none of it
SINGULAR = 1e-6  # a second singular value this small (relative) makes a point a branch point


@dataclass(frozen=True, eq=False)
class BorderedShooting:
    """M = [J; t^T] in scaled unknowns; the components of z that do not move get no correction."""

    residual_moving: Array
    matrix: Array
    positions: NDArray[np.intp]
    size: int
    fixed: FixedSpace | None = None  # of the orbits: steps and tangents stay there
    units: Array | None = None  # of the states (n,)

    @classmethod
    def of(cls, segments: Segments, tangent: Array, scale: Array) -> BorderedShooting:
        residual, jacobian = segments.scaled(scale)
        positions = moving(len(scale), segments.problem.n)
        problem = segments.problem
        matrix = np.vstack([jacobian, tangent[positions]])
        return cls(residual, matrix, positions, len(scale), problem.fixed, scale[: problem.n])

    @property
    def residual(self) -> Array:
        """(N - 1,): the equations, then zeros for what does not move."""
        return np.concatenate([self.residual_moving, np.zeros(self.size - 1 - len(self.residual_moving))])

    @cached_property
    def _factors(self) -> tuple[Array, Array]:
        from scipy.linalg import lapack

        lu, pivots, _ = lapack.dgetrf(self.matrix)
        return lu, pivots

    @cached_property
    def sign(self) -> float:
        lu, pivots = self._factors
        diagonal = np.diag(lu)
        if not np.all(np.isfinite(diagonal)) or np.any(diagonal == 0.0):
            return 0.0
        swaps = int(np.count_nonzero(pivots != np.arange(len(pivots))))
        return float(np.prod(np.sign(diagonal))) * (-1.0 if swaps % 2 else 1.0)

    @property
    def log_determinant(self) -> float:
        return float(np.sum(elementary.log(np.abs(np.diag(self._factors[0])))))

    def solve(self, right: Array) -> Array:
        from scipy.linalg import lapack

        m = len(self.residual_moving)
        lu, pivots = self._factors
        x = lapack.dgetrs(lu, pivots, np.append(right[:m], right[-1]))[0]
        return embedded(self._kept(x), self.positions, self.size)

    def _kept(self, x: Array) -> Array:
        if self.fixed is None or self.units is None:
            return x
        states = x[: len(x) - 2].reshape(-1, len(self.units)) * self.units
        return np.concatenate([(self.fixed.onto(states) / self.units).ravel(), x[-2:]])


def embedded(x: Array, positions: NDArray[np.intp], size: int) -> Array:
    """A direction of the moving unknowns as one of z."""
    out = np.zeros(size)
    out[positions] = x
    return out


def null_space(problem: ShotFamily, z: Array, scale: Array) -> tuple[Segments, Array, Array] | None:
    """Segments at z, singular values of the scaled Jacobian (descending) and right singular vectors (rows)."""
    segments = Segments.of(problem, z)
    if segments is None:
        return None
    _, jacobian = segments.scaled(scale)
    _, values, vectors = np.linalg.svd(jacobian)
    return segments, values, vectors


def family_tangents(problem: ShotFamily, z: Array, scale: Array) -> Sequence[Array]:
    """Unit tangents (scaled, like z) of the families through z: one, or at a branch point two directions of its plane.

    At a branch point the second is normal to the first; which directions really are tangents is found out by
    `contin.problems.shooting.crossing`.
    """
    found = null_space(problem, z, scale)
    positions = moving(len(z), problem.n)
    if found is None:
        fallback = np.zeros(len(z))
        fallback[-1] = 1.0
        return [fallback]
    _, values, vectors = found
    if len(values) < 2 or values[-1] > SINGULAR * values[0]:
        return [embedded(vectors[-1], positions, len(z))]
    if problem.fixed is not None:
        count = 1 + int(np.count_nonzero(values <= SINGULAR * values[0]))
        kept = _broken(problem, vectors[-count:], scale)
        if kept is not None:
            return [embedded(v, positions, len(z)) for v in kept]
    return [embedded(v, positions, len(z)) for v in _steepest_first(vectors[-2:])]


def _broken(problem: Any, null: Array, scale: Array) -> list[Array] | None:
    """Of a null space (rows): the family's own direction, which the orbits' symmetries keep, and one that breaks them.

    None where more of them are kept than one.
    """
    count, size, units = problem.count, problem.count * problem.n, scale[: problem.n]
    states = null[:, :size].reshape(len(null), count, problem.n) * units
    kept = np.hstack([(problem.fixed.onto(states) / units).reshape(len(null), -1), null[:, size:]])
    values, turn = np.linalg.eigh(kept @ null.T)
    if not (values[-1] > 1.0 - BROKEN and np.all(np.abs(values[:-1]) < BROKEN)):
        return None
    own, across = turn[:, -1] @ null, turn[:, :-1].T @ null
    if len(across) == 1:
        return [own, across[0]]
    alone = kept_direction(problem.fixed, across, scale, count)
    return None if alone is None else [own, alone]


def _steepest_first(plane: Array) -> list[Array]:
    """An orthonormal basis of the plane: the direction with the largest parameter part, then the one without any."""
    rates = plane[:, -1]
    size = float(elementary.hypot(*rates))
    if size < 1e-12:
        return [plane[0], plane[1]]
    along = (rates @ plane) / size
    across = (rates[1] * plane[0] - rates[0] * plane[1]) / size
    return [along / np.linalg.norm(along), across / np.linalg.norm(across)]
