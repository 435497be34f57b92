"""Preconditioned GMRES, for matrix-free Jacobians and for large matrices whose latest factors are a few points old."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contin.abi import Vector
from contin.linalg.vectors import inner, mixed, norm
from contin.machine import elementary

Operator = Callable[[Vector], Vector]
Learn = Callable[[Vector, Vector, Vector], None]  # of D (k, n), V (k + 1, n), H (k + 1, k) with apply(D^T) = V^T H

TOLERANCE = 1e-11  # of the residual, relative to the right-hand side; Newton steps and tangents need less
COARSE = 1e-7
RESTART = 60
FIRST_BASIS = 12  # vectors allocated at first
RESTARTS = 8
SINGULAR = 1e-13  # ratio of a triangle's diagonal entries, and of singular values, that rounding makes
GAINED = 1e-3  # part of the residual of a guess to which it is reduced, so that solutions nearby differ as they should


@dataclass(frozen=True, eq=False)
class Accuracy:
    """When a solution is good enough by its own error, whatever the units of the equations.

    The error is estimated by the preconditioner, about A^-1: it is at most the residual's norm times the longest that a
    unit vector of the Krylov space becomes. size : the norm of solutions.  wanted : the error of a solution that
    is small enough.
    """

    size: Callable[[Vector], float]
    wanted: Callable[[Vector], float]


def gmres(
    apply: Operator, precondition: Operator, right: Vector, tolerance: float = TOLERANCE, guess: Vector | None = None,
    accuracy: Accuracy | None = None, learn: Learn | None = None,
) -> tuple[Vector, int, float]:  # fmt: skip
    """x with apply(x) = right, by flexible GMRES (Saad 1993); returns x, iterations, relative residual.

    The search stops at `tolerance`, where the `accuracy` is met (the residual returned is then at most `tolerance`), or
    where the residual does not fall any more. A `guess` is improved even where it meets the tolerance, by `GAINED`: the
    difference from it is what matters to whoever has one. `learn` is told the relation of every cycle.
    """
    size = norm(right)
    if size == 0.0:
        return np.zeros_like(right), 0, 0.0
    x = np.zeros_like(right) if guess is None else guess
    used = 0
    before = np.inf
    for turn in range(RESTARTS):
        residual = right if turn == 0 and guess is None else right - apply(x)
        beta = norm(residual)
        if turn == 0 and guess is not None:
            tolerance = min(tolerance, max(GAINED * beta / size, TOLERANCE))
        if not np.isfinite(beta):
            return x, used, np.inf
        if beta <= tolerance * size or beta > 0.5 * before:
            return x, used, beta / size
        before = beta
        check = None if accuracy is None else _Check(accuracy, x)
        update, steps, left = _cycle(apply, precondition, residual / beta, beta, tolerance * size, check, learn)
        x = x + update
        used += steps
        if check is not None and check.met:
            return x, used, min(left / size, tolerance)
        if left <= tolerance * size:
            return x, used, left / size
    return x, used, norm(right - apply(x)) / size


class _Check:
    """Whether base + an update meets an accuracy."""

    def __init__(self, accuracy: Accuracy, base: Vector) -> None:
        self.accuracy, self.base = accuracy, base
        self.longest = 0.0  # that a unit vector becomes
        self.met = False

    def __call__(self, y: Vector, directions: Vector, left: float) -> bool:
        self.longest = max(self.longest, self.accuracy.size(directions[-1]))
        solution = self.base + np.einsum("i,ij->j", y, directions)
        self.met = left * self.longest <= self.accuracy.wanted(solution)
        return self.met


def _cycle(
    apply: Operator, precondition: Operator, v: Vector, beta: float, goal: float, check: _Check | None,
    learn: Learn | None,
) -> tuple[Vector, int, float]:  # fmt: skip
    """One cycle of at most RESTART steps: the update of x, the number of steps, the norm of the residual left."""
    kind = v.dtype
    basis, directions = np.empty((FIRST_BASIS, len(v)), kind), np.empty((FIRST_BASIS, len(v)), kind)
    basis[0] = v
    smallest = _SmallestResidual(beta, kind)
    steps, left = 0, beta
    for k in range(RESTART):
        directions[k] = precondition(basis[k])
        w = np.array(apply(directions[k]), kind)
        column = np.zeros(k + 2, kind)
        column[: k + 1] = _orthogonalised(w, basis[: k + 1])
        length = norm(w)
        column[k + 1] = length
        if not np.all(np.isfinite(column)):  # LAPACK would print that
            return np.zeros_like(v), k + 1, np.inf
        steps = k + 1
        left = smallest.with_column(column)
        if k + 1 == len(basis):
            basis = np.concatenate([basis, np.empty_like(basis)])
            directions = np.concatenate([directions, np.empty_like(directions)])
        np.divide(w, length if length > 0.0 else 1.0, out=basis[k + 1])
        met = check is not None and check(smallest.solution(), directions[: k + 1], left)
        if met or left <= goal or length <= 1e-14 * beta:
            break
    if learn is not None:
        learn(directions[:steps], basis[: steps + 1], smallest.hessenberg[: steps + 1, :steps])
    y, left = smallest.solution(), smallest.residual()
    return np.einsum("i,ij->j", y, directions[:steps]), steps, left


def _orthogonalised(w: Vector, basis: Vector) -> Vector:
    """The parts of w along orthonormal rows, which are taken away from it in place; twice."""
    parts = np.zeros(len(basis), basis.dtype)
    for _ in range(2):
        if basis.dtype == float:
            h = inner(w[None], basis)
            mixed(-h, basis, added_to=w[None])
        else:
            h = np.einsum("ij,j->i", basis.conj(), w)[None]
            w -= np.einsum("i,ij->j", h[0], basis)
        parts += h[0]
    return parts


class _SmallestResidual:
    """y of the smallest |beta e_1 - H y| for a Hessenberg matrix H that grows by columns: its QR factors by rotations.

    Where H is singular to rounding, y is the shortest one, by singular values.
    """

    def __init__(self, beta: float, kind: np.dtype[Any]) -> None:
        self.hessenberg, self.triangle = np.zeros((RESTART + 1, RESTART), kind), np.zeros((RESTART, RESTART), kind)
        self.right = np.zeros(RESTART + 1, kind)
        self.beta = self.right[0] = beta
        self.rotations: list[tuple[complex, complex]] = []
        self.sizes: list[float] = []  # of the triangle's diagonal

    def with_column(self, column: Vector) -> float:
        """The residual's norm with one more column, (k + 2,), the last entry of which is >= 0."""
        k = len(self.rotations)
        self.hessenberg[: k + 2, k] = column
        entries = column.tolist()
        for i, (a, b) in enumerate(self.rotations):
            upper, lower = entries[i], entries[i + 1]
            entries[i], entries[i + 1] = a.conjugate() * upper + b * lower, a * lower - b * upper
        upper, below = entries[k], entries[k + 1].real
        size = float(elementary.hypot(abs(upper), below))
        a, b = (upper / size, below / size) if size > 0.0 else (1.0, 0.0)
        self.rotations.append((a, b))
        self.sizes.append(size)
        self.triangle[:k, k], self.triangle[k, k] = entries[:k], size
        here = self.right[k]
        self.right[k], self.right[k + 1] = np.conj(a) * here, -b * here
        return self.residual() if self._is_singular() else abs(complex(self.right[k + 1]))

    def _is_singular(self) -> bool:
        return min(self.sizes) <= SINGULAR * max(self.sizes)

    def residual(self) -> float:
        """|beta e_1 - H y| of the solution as it is, with its rounding errors."""
        k = len(self.rotations)
        left = -(self.hessenberg[: k + 1, :k] @ self.solution())
        left[0] += self.beta
        return norm(left)

    def solution(self) -> Vector:
        """y (k,)."""
        k = len(self.rotations)
        triangle, right = self.triangle[:k, :k], self.right[:k]
        if self._is_singular():
            return np.asarray(np.linalg.lstsq(triangle, right, rcond=SINGULAR)[0])
        y = right.copy()
        for i in range(k - 1, -1, -1):
            y[i] /= triangle[i, i]
            y[:i] -= triangle[:i, i] * y[i]
        return y
