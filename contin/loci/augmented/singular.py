"""Folds and branch points of F(x, p) = 0 by minimally augmented equations, F_x sparse.

    [M b; C^T 0] [V; g] = [0; I],   [M b; C^T 0]^T [w; .] = [0; 1],   dg = -w^T (dF') V

M = F_x for folds, with one scalar g; M = [F_x F_s] for branch points in the parameter s, with two scalars and an
unfolding beta, F + beta b = 0. Since the derivative of F' V is symmetric, that of w^T F' along V is its gradient: a
central difference of the matrix along V. (Govaerts 2000, ch. 3-4.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.linalg.borders import below
from contin.linalg.csc import with_columns, with_rows
from contin.linalg.vectors import norm
from contin.loci.augmented.sparse import Factors

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

STEP: Final = 1e-4  # scaled, of the central difference of the matrix
ROUNDS: Final = 2  # of inverse iteration: M is singular but for the error of a mesh, and one leaves nothing else


class Linearised(Protocol):
    """F' = [F_x, F_p] (n, n + k) at a point."""

    def pulled(self, w: Array) -> Array:
        """w^T F' (n + k,) of the first rows, as many as w (n,) has entries."""


class Equations(Protocol):
    """F and its derivatives at y = (x, parameters)."""

    def at(self, y: Array) -> Linearised | None:
        """None where something is not finite."""


class Matrix(Protocol):
    """M (n, columns)."""

    @property
    def shape(self) -> tuple[int, int]: ...

    def bordered(self, columns: Array, rows: Array) -> csc_matrix:
        """[M columns; rows^T 0]"""


@dataclass(frozen=True, eq=False)
class Assembled:
    """F' or M as a sparse matrix."""

    matrix: csc_matrix

    @property
    def shape(self) -> tuple[int, int]:
        found: tuple[int, int] = self.matrix.shape
        return found

    def pulled(self, w: Array) -> Array:
        return np.asarray(self.matrix[: len(w)].T @ w)

    def bordered(self, columns: Array, rows: Array) -> csc_matrix:
        return with_rows(with_columns(self.matrix, columns), below(columns, rows))


@dataclass(frozen=True, eq=False)
class Borders:
    """b (n,) and C (columns of M, 1 or 2), for matrices in scaled unknowns."""

    left: Array
    right: Array


@dataclass(frozen=True, eq=False)
class Singular:
    """g, its gradient by y, and the null vectors, all in scaled unknowns."""

    values: Array
    gradient: Array
    right: Array
    left: Array
    factors: Factors  # of [M b; C^T 0]

    @property
    def form(self) -> Array | None:
        """(2, 2) of branch points: second derivatives of their scalar equation in the plane of the null vectors."""
        n, count = len(self.left), self.right.shape[1]
        if len(self.gradient) < 2 or len(self.right) == n:
            return None
        directions = np.zeros((self.gradient.shape[1], count))
        directions[:n], directions[-1] = self.right[:n], self.right[n]
        return np.asarray(self.gradient @ directions)


def null_vectors(matrix: Matrix, count: int) -> Borders:
    """Singular vectors (n,), (columns, count) of the smallest singular values of M, by bordered inverse iteration."""
    generator = np.random.default_rng(8)
    b, c = generator.normal(size=matrix.shape[0]), generator.normal(size=(matrix.shape[1], count))
    b, c = b / norm(b), np.linalg.qr(c)[0]
    for _ in range(ROUNDS):
        factors = Factors(matrix.bordered(b[:, None], c))
        if factors.is_singular:
            break
        n, columns = matrix.shape
        units = np.vstack([np.zeros((n, count)), np.eye(count)])
        v = np.column_stack([factors.solve(unit) for unit in units.T])[:columns]
        w = factors.solve_transposed(np.append(np.zeros(columns), 1.0))[:n]
        if not (np.all(np.isfinite(v)) and np.all(np.isfinite(w))):
            break
        b, c = w / norm(w), np.linalg.qr(v)[0]
    return Borders(b, c)


def singular(
    equations: Equations, y: Array, own: Matrix, borders: Borders, slopes: bool = True, length: float = STEP
) -> Singular | None:
    """The scalars of M (`own`) at y, scaled; without `slopes` their gradient is left empty; `length` of its steps.

    M has the first rows and columns of F' there, with the column of the last parameter where branch points are meant
    (or is like it, as for orbits that close with another sign).
    """
    count, n = borders.right.shape[1], own.shape[0]
    factors = Factors(own.bordered(borders.left[:, None], borders.right))
    if factors.is_singular:
        return None
    columns = own.shape[1]
    units = np.vstack([np.zeros((n, count)), np.eye(count)])
    solved = np.column_stack([factors.solve(unit) for unit in units.T])
    v, g = solved[:columns], solved[columns]
    w = factors.solve_transposed(np.append(np.zeros(columns), 1.0))[:n]
    gradient = np.empty((count if slopes else 0, len(y)))
    for k in range(len(gradient)):
        direction = np.zeros(len(y))
        direction[:n] = v[:n, k]
        if columns > n:
            direction[-1] = v[n, k]
        step = length / norm(direction)
        ahead, behind = (equations.at(y + side * step * direction) for side in (1.0, -1.0))
        if ahead is None or behind is None:
            return None
        gradient[k] = (behind.pulled(w) - ahead.pulled(w)) / (2.0 * step)
    return Singular(g, gradient, v, w, factors)
