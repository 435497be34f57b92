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
from contin.linalg.vectors import inner, mixed, norm

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

FEWEST = 4  # eigenvalues that are always computed
MARGIN = 1.3  # by which the radius exceeds what must be inside
CONVERGED = 1e-4  # relative error of an eigenvalue, for detection
SOLVED = 1e-6  # residual of a solve; that part of an eigenvalue is lost by it
LARGEST_BASIS = 160
INDEPENDENT = 1e-8  # part of a vector outside of others from which it is not one of their combinations
ORTHONORMAL = 1e-14  # by which products of rows that are may differ from 0 and 1
OBLIQUE = 1e-3  # smallest eigenvalue of the cosines between rows that are turned all at once
TURNS = 3
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


def outside(w: Array, basis: Array) -> Array:
    """What is left of rows w (n,) or (k, n) outside of the span of orthonormal rows; projected twice."""
    rows = np.array(w, ndmin=2, order="C")
    for _ in range(2):
        mixed(-inner(rows, basis), basis, added_to=rows)
    return rows.reshape(w.shape)


def orthonormal(vectors: Array, basis: Array | None = None) -> Array:
    """Orthonormal rows that span the same, outside a basis; what depends on the others is left out.

    Rows that are far from depending on each other are turned all at once, others one by one.
    """
    rows = np.ascontiguousarray(vectors)
    if not len(rows):
        return rows.copy()
    whole = np.einsum("ij,ij->i", rows, rows)
    if basis is not None and len(basis):
        rows = outside(rows, basis)
    turned = _turned(rows, whole)
    return _one_by_one(vectors, basis) if turned is None else turned


def _turned(rows: Array, whole: Array) -> Array | None:
    """By Cholesky factors of their products, until these are those of orthonormal rows; None where rows depend on each
    other, or where little is left of them beside their squared lengths `whole` before."""
    if not np.all((whole > 0.0) & (whole < np.inf)):
        return None
    left = inner(rows, rows)
    for _ in range(TURNS):
        square = np.diagonal(left)
        if not np.all(square > INDEPENDENT * INDEPENDENT * whole):
            return None
        if float(np.abs(left - np.eye(len(left))).max()) <= ORTHONORMAL:
            return rows
        unit = 1.0 / np.sqrt(square)
        cosines = left * unit * unit[:, None]
        if not float(np.linalg.eigvalsh(cosines)[0]) > OBLIQUE:
            return None
        rows = mixed(np.linalg.inv(np.linalg.cholesky(cosines)) * unit, rows)
        whole, left = np.ones(len(rows)), inner(rows, rows)
    return rows


def _one_by_one(vectors: Array, basis: Array | None) -> Array:
    """Gram-Schmidt, twice, on rows that lie one after the other in memory."""
    given = 0 if basis is None else len(basis)
    rows = np.empty((given + len(vectors), vectors.shape[1]))
    if basis is not None:
        rows[:given] = basis
    count = given
    for vector in vectors:
        size = norm(vector)
        if not size > 0.0:
            continue
        w = outside(vector / size, rows[:count]) if count else vector / size
        left = norm(w)
        if left > INDEPENDENT:
            rows[count] = w / left
            count += 1
    return rows[given:count].copy()


def _without_half_pairs(values: Vector, count: int) -> int:
    """A count that does not cut a conjugate pair in two."""
    if 0 < count < len(values) and values[count - 1].imag != 0.0:
        partner = np.isclose(values[:count], np.conj(values[count - 1]), rtol=1e-8).any()
        if not partner:
            return count - 1
    return count
