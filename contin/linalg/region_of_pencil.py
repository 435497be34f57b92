"""Where the unstable eigenvalues of a pencil can be: Bendixson's theorem in the inner product of the mass matrix.

Let M be symmetric and positive on the states that have mass, V, and the rows of the others, P, be those of constraints
D v = 0 whose multipliers enter as G p with G = +-D^T, as in incompressible flow. An eigenvector then has v^H G p = 0,
and l = v^H F v / v^H M v with F the block of A at V: its real and imaginary part lie in the fields of values of the
symmetric and the antisymmetric part of F, in units of M. Rows of P that hold one state at 0 (a boundary value, a
pressure that is fixed) take it out of the pencil. Where A is not of that form nothing is known.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.linalg.eigen import Region

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

ROUNDED: Final = 1e-12  # relative, up to which two matrices are the same
SAFE: Final = 0.9  # part of the smallest eigenvalue of M that is counted on: Lanczos' method approaches it from above
LARGEST_DENSE: Final = 400
UNKNOWN: Final = (float("inf"), float("inf"))


class RegionOfPencil:
    """`Region` for matrices A beside one M."""

    def __init__(self, mass: csc_matrix) -> None:
        self.mass = mass
        weights = abs(mass)
        self.moving = np.asarray(weights.sum(axis=1)).ravel() + np.asarray(weights.sum(axis=0)).ravel() > 0.0

    @cached_property
    def _units(self) -> tuple[Any, float] | None:
        """1 / sqrt(diagonal) at V, and a lower bound of M's eigenvalues in these units; None where M is not such."""
        own = self.mass[self.moving][:, self.moving]
        diagonal = own.diagonal()
        if not _same(own, own.T) or not np.all(diagonal > 0.0):
            return None
        from scipy.sparse import diags

        scale = diags(1.0 / np.sqrt(diagonal))
        smallest = _smallest_eigenvalue((scale @ own @ scale).tocsc())
        return (scale, SAFE * smallest) if smallest > ROUNDED else None

    def of(self, matrix: csc_matrix) -> tuple[float, float]:
        """(R, S): eigenvalues with Re >= 0 have Re <= R and |Im| <= S; infinite where nothing is known."""
        if self._units is None:
            return UNKNOWN
        scale, smallest = self._units
        rows, still = matrix[self.moving], ~self.moving & ~_held(matrix, ~self.moving)
        if still.any():
            forces, constraints = rows[:, still], matrix[still][:, self.moving]
            inner = matrix[still][:, still]
            if inner.nnz and abs(inner).max() > 0.0:
                return UNKNOWN
            if not (_same(forces, constraints.T) or _same(forces, -constraints.T)):
                return UNKNOWN
        right, up = Region.of_any((scale @ rows[:, self.moving] @ scale).tocsc())
        return right / smallest, up / smallest


def _held(matrix: csc_matrix, still: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of the equations without mass have no entry but that on their diagonal."""
    entries = matrix.tocoo()
    counted = entries.data != 0.0
    others = counted & (entries.row != entries.col)
    elsewhere = np.bincount(entries.row[others], minlength=matrix.shape[0])
    return np.asarray(still & (elsewhere == 0) & (matrix.diagonal() != 0.0))


def _same(a: Any, b: Any) -> bool:
    size = abs(a).max() if a.nnz else 0.0
    return bool((abs(a - b).max() if (a - b).nnz else 0.0) <= ROUNDED * size)


def _smallest_eigenvalue(matrix: csc_matrix) -> float:
    """Of a symmetric matrix with a diagonal of ones; Gershgorin's bound where that is positive."""
    bound = 2.0 - float(np.asarray(abs(matrix).sum(axis=1)).max())
    if bound > 0.0:
        return bound
    if matrix.shape[0] <= LARGEST_DENSE:
        return float(np.linalg.eigvalsh(matrix.toarray())[0])
    from scipy.sparse.linalg import ArpackError, eigsh

    try:
        start = np.random.default_rng(3).normal(size=matrix.shape[0])
        return float(eigsh(matrix, 1, which="SA", v0=start, tol=1e-2, return_eigenvectors=False)[0])
    except ArpackError:  # no bound then
        return 0.0
