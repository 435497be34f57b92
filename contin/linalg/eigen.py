"""Eigenvalues near zero of a large operator by shift-invert Arnoldi, as many as stability needs.

The leading eigenvalues are those that can have crossed, or be about to cross, the imaginary axis. By Bendixson's
theorem all eigenvalues with Re >= 0 lie in |Im| <= max row sum of |A - A^T|/2 and Re <= the largest Gershgorin bound of
(A + A^T)/2. The basis grows until every eigenvalue in the disc around that part of the plane has converged, or to a
largest size; where the operator is not known entry by entry, until the unstable ones and some stable ones have.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.kernels.long_rows import edges_of_parts
from contin.linalg.orthonormal import INDEPENDENT
from contin.linalg.vectors import norm

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

FEWEST = 4  # eigenvalues that are always computed
MARGIN = 1.3  # by which the radius exceeds what must be inside
CONVERGED = 1e-4  # relative error of an eigenvalue, for detection
SOLVED = 1e-6  # residual of a solve; that part of an eigenvalue is lost by it
LARGEST_BASIS = 160
MEMORY = 6e7  # numbers that a basis may have: at n = 1,000,000, 60 vectors


class Inverse(Protocol):
    """What Krylov spaces of an inverse are made of."""

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        """A^-1 right, or with a mass matrix the operator of `contin.linalg.pencil`."""

    def weigh(self, x: Vector) -> Vector:
        """A vector of the space that it works in: M x with a mass matrix, else x."""

    def magnitude(self, x: Vector) -> Vector:
        """As `Linear.magnitude`."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Leading eigenvalues, nearest to zero first, with eigenvectors (columns); and whether none is missing."""

    values: NDArray[np.complex128]
    vectors: NDArray[np.complex128]
    certain: bool


@dataclass(eq=False)
class Region:
    """The part of the plane that holds all unstable eigenvalues, for CSC matrices of one pattern."""

    _pattern: tuple[Vector, Vector] | None = None
    _partner: Vector | None = None  # position of the entry (j, i) of each entry (i, j), where all have one
    _starts: Vector | None = None
    _diagonal: Vector | None = None  # position of the diagonal's entry of each column, or -1

    def of(self, matrix: Any) -> tuple[float, float]:
        """(R, S): eigenvalues with Re >= 0 have Re <= R and |Im| <= S (Bendixson, Gershgorin)."""
        known = self._pattern
        pattern = (matrix.indptr, matrix.indices)
        if known is None or not all(np.array_equal(a, b) for a, b in zip(known, pattern, strict=True)):
            self._learn(matrix)
        if self._partner is None:
            return np.inf, np.inf
        right, up = edges_of_parts(np.ascontiguousarray(matrix.data), self._partner, self._starts, self._diagonal)
        return max(float(right), 0.0), float(up)

    @staticmethod
    def of_any(matrix: Any) -> tuple[float, float]:
        """The same of a matrix of any pattern, at the cost of its transpose."""
        turned = matrix.T.tocsc()
        symmetric, skew = 0.5 * (matrix + turned), 0.5 * abs(matrix - turned)
        diagonal = symmetric.diagonal()
        right = diagonal - np.abs(diagonal) + np.asarray(abs(symmetric).sum(axis=1)).ravel()
        return max(float(right.max()), 0.0), float(skew.sum(axis=1).max())

    def _learn(self, matrix: csc_matrix) -> None:
        from scipy.sparse import csc_matrix

        self._pattern = (matrix.indptr.copy(), matrix.indices.copy())
        self._partner = None
        numbered = csc_matrix((np.arange(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
        transposed = numbered.T.tocsc()
        same = np.array_equal(transposed.indices, matrix.indices) and np.array_equal(transposed.indptr, matrix.indptr)
        if same and np.all(np.diff(matrix.indptr) > 0):
            self._partner, self._starts = transposed.data.astype(np.int64), matrix.indptr.astype(np.int64)
            columns = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
            places = np.flatnonzero(columns == matrix.indices)
            self._diagonal = np.full(matrix.shape[0], -1, np.int64)
            self._diagonal[columns[places]] = places


def leading(
    linear: Inverse, n: int, start: Array, radius: float, known: float = 0.0, fewest: int = FEWEST
) -> Spectrum:
    """Eigenvalues of A with |l| <= radius, at least `fewest` and those up to 1.3 * known, from A^-1.

    start : (n,) vector to begin with; a sum of the eigenvectors at a point nearby saves solves.
    """
    most = int(min(n, LARGEST_BASIS, max(3 * fewest, MEMORY / n)))
    basis = np.empty((most + 1, n))
    hessenberg = np.zeros((most + 1, most))
    basis[0] = start / norm(start)
    wanted = max(radius, MARGIN * known)
    size = min(most, 2 * fewest)
    done, complete = 0, False
    while True:
        for k in range(done, size):
            w = linear.solve(basis[k], SOLVED)
            if not np.all(np.isfinite(w)):
                return Spectrum(np.full(0, 0j), np.empty((n, 0), complex), False)
            block = basis[: k + 1]
            for _ in range(2):
                h = np.einsum("ij,j->i", block, w)
                w -= np.einsum("i,ij->j", h, block)
                hessenberg[: k + 1, k] += h
            hessenberg[k + 1, k] = norm(w)
            if hessenberg[k + 1, k] <= 1e-14 * float(np.abs(hessenberg[: k + 1, k]).max(initial=0.0)):
                w = linear.weigh(np.random.default_rng(k).normal(size=n))  # an invariant subspace: a new direction
                whole = norm(w)
                w = w - (block @ w) @ block
                w -= (block @ w) @ block
                hessenberg[k + 1, k] = 0.0
                if k + 1 >= n or not norm(w) > INDEPENDENT * whole:
                    size, complete = k + 1, True
                    break
            basis[k + 1] = w / norm(w)
        done = size
        theta, ritz = np.linalg.eig(hessenberg[:size, :size])
        order = np.argsort(-np.abs(theta))
        theta, ritz = theta[order], ritz[:, order]
        good = np.abs(hessenberg[size, size - 1] * ritz[-1]) <= CONVERGED * np.abs(theta)
        complete = complete or size == n
        if complete:
            good[:] = True
        count = int(np.argmin(good)) if not good.all() else len(good)
        values = 1.0 / np.where(theta == 0.0, 1e-300, theta)
        all_found = complete and count == size
        reached = count > 0 and (np.abs(values[count - 1]) >= wanted or all_found)
        enough = count >= min(fewest, n) or all_found
        if (enough and reached) or size == most:
            keep = _without_half_pairs(values, count)
            vectors = basis[:size].T @ ritz[:, :keep]
            return Spectrum(values[:keep].astype(complex), vectors.astype(complex), bool(enough and reached))
        size = min(most, size + max(FEWEST, size // 3))


def _without_half_pairs(values: Vector, count: int) -> int:
    """A count that does not cut a conjugate pair in two."""
    if 0 < count < len(values) and values[count - 1].imag != 0.0:
        partner = np.isclose(values[:count], np.conj(values[count - 1]), rtol=1e-8).any()
        if not partner:
            return count - 1
    return count
