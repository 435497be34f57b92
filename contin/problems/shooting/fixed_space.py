"""Orbits that symmetries keep point by point (oscillators in phase), kept in the fixed space of these symmetries.

Where u is fixed by the matrices of a group with the mean P, so is its trajectory, and the derivative of the flow takes
the fixed space P u = u, and by symmetry the space P v = 0 across it, to themselves. Beside orbits that cross several
switching surfaces together this holds for the mean of the derivatives on all sides, and not for one of them: which
side Newton's iterates are on would be decided by rounding. So their trajectories start in the fixed space, and what
leads out of it or into it is left out of the derivatives; the block across it still tells the multipliers of the
symmetry's breaking.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.symmetry import symmetry_names
from contin.problems.symmetry_group import moved

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

KEPT: Final = 1e-7  # distance from its image, relative to the orbit's largest state, up to which a point is kept
LINEAR: Final = 1e-12  # relative: a symmetry is a matrix to this
DOUBLINGS: Final = 14  # of the length of random words in the symmetries, whose mean tends to the group's
PURIFICATIONS: Final = 3
SIMPLE: Final = 1e-6  # distance of an eigenvalue of a symmetry from 1, up to which a direction is kept


@dataclass(frozen=True, eq=False)
class FixedSpace:
    """Matrices (n, n) of the symmetries that keep every point of an orbit, and the mean P of the group they make."""

    matrices: tuple[Array, ...]
    projector: Array

    def onto(self, u: Array) -> Array:
        """States (K, n) in the fixed space."""
        return np.asarray(u @ self.projector.T)

    def split(self, matrix: Array) -> Array:
        """A derivative (n, n), or several of them, without what leads from one of the two spaces into the other."""
        p = self.projector
        q = np.eye(len(p)) - p
        return np.asarray(p @ matrix @ p + q @ matrix @ q)


def fixed_space(problem: FamilyOfOrbits, u: Array, p: Array) -> FixedSpace | None:
    """Of the declared symmetries (and their products) that keep all states u (K, n); None where none does."""
    largest = float(np.abs(u).max())
    matrices = []
    for name in symmetry_names(problem):
        matrix = matrix_of(problem, name, u, p)
        if matrix is not None and float(np.abs(u @ matrix.T - u).max()) <= KEPT * largest:
            matrices.append(matrix)
    if not matrices:
        return None
    mean = (np.eye(problem.n) + sum(matrices)) / (1.0 + len(matrices))
    for _ in range(DOUBLINGS):
        mean = mean @ mean
    for _ in range(PURIFICATIONS):  # rounding has been multiplied, too: the nearest matrix with P P = P
        mean = 3.0 * mean @ mean - 2.0 * mean @ mean @ mean
    return FixedSpace(tuple(matrices), mean)


def matrix_of(problem: FamilyOfOrbits, name: str, u: Array, p: Array) -> Array | None:
    """A symmetry as a matrix, None where it is none: it shifts states or is not linear."""
    n = problem.n
    sizes = np.maximum(np.abs(u).max(axis=0), 1e-300)
    rows = np.vstack([np.zeros((1, n)), np.diag(sizes), u])
    rows = moved(problem.system, name, rows, p)
    matrix = (rows[1 : n + 1] - rows[0]).T / sizes
    wrong = np.abs(u @ matrix.T - rows[n + 1 :]).max(initial=0.0) + np.abs(rows[0]).max()
    return matrix if wrong <= LINEAR * sizes.max() else None


def kept_direction(fixed: FixedSpace, directions: Array, scale: Array, count: int) -> Array | None:
    """Of orthonormal scaled directions (k, N) of z, all lost by the group, one that a symmetry keeps alone, (N,).

    Where symmetry makes several multipliers critical together, families cross along such directions (the equivariant
    branching lemma, see `contin.problems.orbits.normal_forms.multiple_branch_point`).  count : of the segments.
    """
    n = len(fixed.projector)
    units = scale[:n]
    for matrix in fixed.matrices:
        inner = matrix * units / units[:, None]
        states = directions[:, : count * n].reshape(len(directions), count, n)
        moved = (states @ inner.T).reshape(len(directions), -1)
        action = directions[:, : count * n] @ moved.T
        values, vectors = np.linalg.eig(action.T)
        near = np.flatnonzero(np.abs(values - 1.0) < SIMPLE)
        if len(near) == 1:
            found = vectors[:, near[0]].real @ directions
            return np.asarray(found / np.linalg.norm(found))
    return None
