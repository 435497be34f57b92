"""Bordered systems [A B; C^T D] [x; y] = [f; g] by block elimination: A is factored, the dense borders never are.

One border row and column at a time, by the mixed elimination BEMW (Govaerts and Pryce 1993): as accurate as the
bordered matrix is well conditioned, even where A is singular. It needs solves with A^T; without them (matrix-free)
plain block elimination is used, which serves as a preconditioner.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np

from contin.abi import Vector
from contin.linalg.vectors import plus_combined, products

ROUNDING: Final = float(np.finfo(float).eps)


class Solver(Protocol):
    """Solves with a square matrix and with its transpose."""

    def solve(self, right: Vector) -> Vector: ...

    def solve_transposed(self, right: Vector) -> Vector: ...


class Bordered:
    """[A b; c^T d] from a solver of A; itself a solver, so that borders can be put around borders."""

    def __init__(self, inner: Solver, b: Vector, c: Vector, d: complex) -> None:
        self.inner, self.b, self.c, self.d = inner, b, c, d
        self.v = inner.solve(b)
        self.w = inner.solve_transposed(c)
        self.pivot = _pivot(d, c, self.v)
        self.pivot_transposed = _pivot(d, self.w, b)

    def solve(self, right: Vector) -> Vector:
        """Cost: one solve with A."""
        return self._mixed(right, self.inner.solve, self.b, self.c, self.v, self.w, self.pivot, self.pivot_transposed)

    def solve_transposed(self, right: Vector) -> Vector:
        transposed = self.inner.solve_transposed
        return self._mixed(right, transposed, self.c, self.b, self.w, self.v, self.pivot_transposed, self.pivot)

    def last_row(self) -> Vector:
        """That of the inverse."""
        return self.solve_transposed(np.append(np.zeros(len(self.b)), 1.0))

    def _mixed(
        self, right: Vector, solve: Callable[[Vector], Vector], b: Vector, c: Vector, v: Vector, w: Vector,
        pivot: complex, other: complex,
    ) -> Vector:  # fmt: skip
        f, g = right[:-1], right[-1]
        with np.errstate(invalid="ignore", over="ignore"):  # factors of a singular A: what comes out is not finite
            y = (g - dot(w, f)) / other
            x = solve(f - b * y)
            z = (g - self.d * y - dot(c, x)) / pivot
            return np.append(x - v * z, y + z)


def dot(a: Vector, b: Vector) -> Any:
    """sum a_i b_i, real or complex, without BLAS (see `contin.linalg.vectors`)."""
    return np.einsum("i,i->", a, b)


def _pivot(d: complex, c: Vector, v: Vector) -> complex:
    """d - c^T v; where nothing of it is left but rounding, as large as that, so that one can divide by it.

    Next to a singular A, v is as large as the inverse of rounding, and c^T v may vanish by chance.
    """
    pivot = d - dot(c, v)
    rounding = ROUNDING * (abs(d) + float(np.sum(np.abs(c) * np.abs(v))))
    return pivot if abs(pivot) > rounding else max(rounding, float(np.finfo(float).tiny))


def bordered(inner: Solver, columns: Vector, rows: Vector, corner: Vector) -> Solver:
    """[A B; C^T D] with B = columns (n, k), C = rows (n, k), D = corner (k, k); solves vectors of length n + k."""
    k = columns.shape[1]
    solver = inner
    for j in range(k):
        b = np.append(columns[:, j], corner[:j, j])
        c = np.append(rows[:, j], corner[j, :j])
        solver = Bordered(solver, b, c, corner[j, j])
    return solver


@dataclass(frozen=True, eq=False)
class Approximate:
    """A preconditioner of A as a solver; plain block elimination around it: see `approximate_bordered`."""

    apply: Callable[[Vector], Vector]

    def solve(self, right: Vector) -> Vector:
        return np.asarray(self.apply(right))


class ApproximateBordered:
    """Block elimination with an approximate A^-1 and without transposes: a preconditioner of the bordered matrix.

    solved : what A^-1 makes of the columns, or of others that are nearly the same; None: not known yet.
    """

    def __init__(
        self, inner: Approximate, columns: Vector, rows: Vector, corner: Vector, solved: Vector | None = None
    ) -> None:
        self.inner, self.rows = inner, rows
        if solved is None:
            solved = np.column_stack([inner.solve(columns[:, j]) for j in range(columns.shape[1])])
        self.columns = solved
        schur = corner - np.array([products(rows, c) for c in self.columns.T]).T
        self.schur = _inverse(schur) if np.all(np.isfinite(schur)) else np.eye(len(schur))

    def solve(self, right: Vector) -> Vector:
        n = len(self.rows)
        x = self.inner.solve(right[:n])
        y = self.schur @ (right[n:] - products(self.rows, x))
        out = np.empty(n + len(y), np.result_type(x, y))
        plus_combined(x, self.columns, -y, out)
        out[n:] = y
        return out


def _inverse(matrix: Vector) -> Vector:
    """The inverse, or what comes nearest to it, of a small matrix whose rows and columns may have any sizes.

    Next to a singular A one entry of a Schur complement may be larger than all others by the inverse of rounding.
    """
    rows = _sizes(np.abs(matrix).max(axis=1, initial=0.0))
    columns = _sizes(np.abs(matrix / rows[:, None]).max(axis=0, initial=0.0))
    return np.asarray(np.linalg.pinv(matrix / rows[:, None] / columns) / columns[:, None] / rows)


def _sizes(largest: Vector) -> Vector:
    return np.where(largest > 0.0, largest, 1.0)
