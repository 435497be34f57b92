"""Singular sparse matrices with borders that make them regular, and the two families that cross at a branch point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.vectors import norm

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import SuperLU

NEAR: Final = 0.1  # sine of the angle between two spaces up to which one serves as border for the other
LIKE: Final = (
    0.5  # ... where it was that of a matrix nearby: the borders are regular, by a factor 0.87 less than at best
)
NARROW: Final = 32  # rows: blocks of 12 states at 4 points, where both orders take as long


def factors(matrix: csc_matrix) -> SuperLU:
    """LU factors of a sparse matrix with the blocks of mesh intervals along its diagonal and a few dense borders.

    Blocks of few states are full: no order fills them less than the one along the orbit, and none need be looked for
    (factors in half the time at n = 3, solutions too). In wide blocks most states do not act on each other: minimum
    degree on A + A^T leaves the borders to the end and fills in proportion to the intervals. The usual order, by
    columns (of A^T A, in which one dense row couples all), takes some ten times as long at 400 intervals.
    Raises LinAlgError where the matrix is exactly singular, or not finite.
    """
    from scipy.sparse.linalg import splu

    if not np.all(np.isfinite(matrix.data)):
        raise np.linalg.LinAlgError("a matrix is not finite")
    try:
        return splu(matrix, permc_spec="NATURAL" if _is_narrow(matrix) else "MMD_AT_PLUS_A")
    except RuntimeError as error:  # SuperLU
        raise np.linalg.LinAlgError("a matrix is exactly singular") from error


def _is_narrow(matrix: csc_matrix) -> bool:
    """True where half of the columns begin at most `NARROW` rows above the diagonal."""
    begins = matrix.indptr[:-1][matrix.indptr[1:] > matrix.indptr[:-1]]
    above = np.arange(len(begins)) - matrix.indices[begins]
    return bool(np.count_nonzero(above <= NARROW) >= 0.5 * len(above)) and bool(matrix.has_sorted_indices)


class Solves(Protocol):
    """Factors, as SuperLU's: `trans` is "N" or "H"."""

    def solve(self, rhs: Vector, trans: str = "N") -> Vector: ...


@dataclass(frozen=True, eq=False)
class Moved:
    """M1 = M0 + P Q^* by Woodbury's formula, M0 = [B b; c^* 0], P = [db 0; 0 1], Q^* = [0 1; dc^* 0]; real."""

    inner: Solves
    p: Vector
    q: Vector
    z: Vector  # M0^-1 P
    z_adjoint: Vector  # M0^-* Q

    @classmethod
    def of(cls, inner: Solves, db: Vector, dc: Vector) -> Moved:
        (rows, corank), (columns, kernel) = db.shape, dc.shape
        p = np.zeros((rows + kernel, corank + kernel))
        p[:rows, :corank], p[rows:, corank:] = db, np.eye(kernel)
        q = np.zeros((columns + corank, corank + kernel))
        q[columns:, :corank], q[:columns, corank:] = np.eye(corank), dc
        return cls(inner, p, q, inner.solve(p), inner.solve(q, "H"))

    def solve(self, rhs: Vector, trans: str = "N") -> Vector:
        z, q = (self.z, self.q) if trans == "N" else (self.z_adjoint, self.p)
        y = self.inner.solve(rhs, trans)
        small = np.eye(q.shape[1]) + q.T @ z
        return np.asarray(y - z @ np.linalg.solve(small, q.T @ y))


Borders = tuple[Vector, Vector]  # b (rows, corank) and c (columns, kernel), orthonormal


@dataclass(frozen=True, eq=False)
class Bordered:
    """B (rows, columns) with borders b (rows, corank) and c (columns, kernel), factorised:

    [B b; c^* 0] [V; g] = [0; I] where B is singular if g is.
    """

    columns: int
    rows: int
    b: Vector
    c: Vector
    factors: Solves

    @classmethod
    def of(cls, matrix: csc_matrix, kernel: int, like: Borders | None = None, once: bool = False) -> Bordered:
        """Borders that span nearly the null spaces, by inverse iteration (two or three factors).

        It begins with those of a matrix nearby, `like` (one factor where they serve), or with random ones. `once`:
        one factor, with which other borders are solved for too; that loses some two digits.
        """
        rows, columns = matrix.shape
        corank = kernel - (columns - rows)
        if like is not None and (like[0].shape, like[1].shape) == ((rows, corank), (columns, kernel)):
            bordered = cls.with_borders(matrix, *like)
        else:
            generator = np.random.default_rng(7)
            b, c = generator.normal(size=(rows, corank)), generator.normal(size=(columns, kernel))
            bordered = cls.with_borders(matrix, _orthonormal(b), _orthonormal(c))
        near = NEAR if like is None else LIKE
        for _ in range(2):
            v, _, w = bordered.solve()
            b, c = _orthonormal(w), _orthonormal(v)
            if _is_near(b, bordered.b, near) and _is_near(c, bordered.c, near):
                break
            bordered = bordered.with_others(b, c) if once else cls.with_borders(matrix, b, c)
        return bordered

    @classmethod
    def with_borders(cls, matrix: csc_matrix, b: Vector, c: Vector) -> Bordered:
        return cls(matrix.shape[1], matrix.shape[0], b, c, factors(_with_borders(matrix, b, c)))

    def with_others(self, b: Vector, c: Vector) -> Bordered:
        """The same matrix with other borders, from the factors that there are: see `Moved`."""
        return Bordered(self.columns, self.rows, b, c, Moved.of(self.factors, b - self.b, c - self.c))

    def solve(self) -> tuple[Vector, Vector, Vector]:
        """Right vectors V (columns, kernel), g (corank, kernel), left vectors W (rows, corank)."""
        kernel, corank = self.c.shape[1], self.b.shape[1]
        right = np.zeros((self.rows + kernel, kernel), self.c.dtype)
        right[self.rows :] = np.eye(kernel)
        solution = self.factors.solve(right)
        if corank == 0:
            return solution, np.zeros((0, kernel)), np.zeros((self.rows, 0))
        left = np.zeros((self.columns + corank, corank), self.b.dtype)
        left[self.columns :] = np.eye(corank)
        adjoint = self.factors.solve(left, "H")
        return solution[: self.columns], solution[self.columns :], adjoint[: self.rows]


def _with_borders(matrix: csc_matrix, b: Vector, c: Vector) -> csc_matrix:
    """[matrix b; c^* 0], its columns put together from theirs."""
    from scipy import sparse

    (rows, columns), (kernel, corank) = matrix.shape, (c.shape[1], b.shape[1])
    ends = matrix.indptr + kernel * np.arange(columns + 1)
    below = (ends[1:, None] - kernel + np.arange(kernel)).ravel()  # where the entries of c^* go
    values = np.empty(ends[-1], np.result_type(matrix, b, c))
    indices = np.empty(ends[-1], matrix.indices.dtype)
    above = np.ones(values.size, bool)
    above[below] = False
    values[above], indices[above] = matrix.data, matrix.indices
    values[below], indices[below] = c.conj().ravel(), np.tile(rows + np.arange(kernel), columns)
    whole = (
        np.concatenate([values, b.T.ravel()]),
        np.concatenate([indices, np.tile(np.arange(rows), corank)]),
        np.concatenate([ends, ends[-1] + rows * np.arange(1, corank + 1)]),
    )
    return sparse.csc_matrix(whole, shape=(rows + kernel, columns + corank))


def _orthonormal(columns: Vector) -> Vector:
    """The first factor of QR; of one column with the sign that LAPACK gives it."""
    count = columns.shape[1]
    if count != 1:
        return np.asarray(np.linalg.qr(columns)[0]) if count else columns
    length = norm(columns[:, 0])
    return columns / (-length if columns[0, 0].real >= 0.0 else length) if length > 0.0 else np.linalg.qr(columns)[0]


def _is_near(new: Vector, old: Vector, near: float) -> bool:
    """True where the orthonormal columns `new` lie in the span of those of `old` to the sine `near`."""
    return bool(np.linalg.norm(new - old @ (old.conj().T @ new)) < near)


def crossing(hessian: Callable[[Array], Any], kernel: Array, left: Array) -> list[Array]:
    """Unit tangents (scaled x) of the two families that cross at a branch point: roots of left . D^2F[t, t] = 0.

    hessian : a direction v -> the matrix D^2F[v, .].
    """
    second = [hessian(kernel[:, k]) for k in range(2)]
    c = np.array([[float(left @ (second[i] @ kernel[:, j])) for j in range(2)] for i in range(2)])
    values, vectors = np.linalg.eigh(0.5 * (c + c.T))
    if values[0] * values[1] >= 0.0:
        return []
    ratio = np.sqrt(-values[0] / values[1])
    tangents = []
    for sign in (1.0, -1.0):
        t = kernel @ (vectors[:, 0] + sign * ratio * vectors[:, 1])
        tangents.append(t / np.linalg.norm(t))
    return tangents
