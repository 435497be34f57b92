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
from contin.linalg.csc import with_columns, with_rows
from contin.linalg.vectors import norm
from contin.loci.augmented.sparse import Factors

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

STEP: Final = 1e-4  # scaled, of the central difference of the matrix
ROUNDS: Final = 3  # of inverse iteration


class Equations(Protocol):
    """F and its derivatives at y = (x, parameters)."""

    def at(self, y: Array) -> tuple[Array, csc_matrix] | None:
        """F (n,) and [F_x, F_p] (n, n + k); None where they are not finite."""


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

    @property
    def form(self) -> Array | None:
        """(2, 2) of branch points: second derivatives of their scalar equation in the plane of the null vectors."""
        n, count = len(self.left), self.right.shape[1]
        if len(self.gradient) < 2 or len(self.right) == n:
            return None
        directions = np.zeros((self.gradient.shape[1], count))
        directions[:n], directions[-1] = self.right[:n], self.right[n]
        return np.asarray(self.gradient @ directions)


def stacked(matrix: csc_matrix, columns: Array, rows: Array) -> csc_matrix:
    """[M columns; rows^T 0]"""
    below = np.hstack([rows.T, np.zeros((rows.shape[1], columns.shape[1]))])
    return with_rows(with_columns(matrix, columns), below)


def null_vectors(matrix: csc_matrix, count: int) -> Borders:
    """Singular vectors (n,), (columns, count) of the smallest singular values of M, by bordered inverse iteration."""
    generator = np.random.default_rng(8)
    b, c = generator.normal(size=matrix.shape[0]), generator.normal(size=(matrix.shape[1], count))
    b, c = b / norm(b), np.linalg.qr(c)[0]
    for _ in range(ROUNDS):
        factors = Factors(stacked(matrix, b[:, None], c))
        n, columns = matrix.shape
        units = np.vstack([np.zeros((n, count)), np.eye(count)])
        v = np.column_stack([factors.solve(unit) for unit in units.T])[:columns]
        w = factors.solve_transposed(np.append(np.zeros(columns), 1.0))[:n]
        if not (np.all(np.isfinite(v)) and np.all(np.isfinite(w))):
            break
        b, c = w / norm(w), np.linalg.qr(v)[0]
    return Borders(b, c)


def critical(matrix: csc_matrix, n: int, branching: bool) -> csc_matrix:
    """M of [F_x, F_p]: with the column of the last parameter where branch points are meant."""
    from scipy import sparse

    return sparse.hstack([matrix[:, :n], matrix[:, -1:]], format="csc") if branching else matrix[:, :n].tocsc()


def singular(
    equations: Equations, y: Array, matrix: csc_matrix, borders: Borders, slopes: bool = True,
    own: csc_matrix | None = None,
) -> Singular | None:  # fmt: skip
    """The scalars at y (scaled), where [F_x, F_p] is `matrix`; without `slopes` their gradient is left empty.

    own : M, where it is made of the first rows of F_x in another way, such as of orbits that close with another sign.
    """
    count = borders.right.shape[1]
    own = critical(matrix, matrix.shape[0], count == 2) if own is None else own
    n = own.shape[0]
    factors = Factors(stacked(own, borders.left[:, None], borders.right))
    if factors.sign == 0.0:
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
        step = STEP / norm(direction)
        ahead, behind = (equations.at(y + side * step * direction) for side in (1.0, -1.0))
        if ahead is None or behind is None:
            return None
        gradient[k] = -((ahead[1][:n] - behind[1][:n]).T @ w) / (2.0 * step)
    return Singular(g, gradient, v, w)
