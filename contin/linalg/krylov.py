"""Preconditioned GMRES, for matrix-free Jacobians and for large matrices whose latest factors are a few points old."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from contin.abi import Vector
from contin.linalg.smallest_residual import RESTART, SmallestResidual
from contin.linalg.vectors import added_and_multiplied, combination, inner, norm

Operator = Callable[[Vector], Vector]
Learn = Callable[[Vector, Vector, Vector], None]  # of D (k, n), V (k + 1, n), H (k + 1, k) with apply(D^T) = V^T H

TOLERANCE = 1e-11  # of the residual, relative to the right-hand side; Newton steps and tangents need less
COARSE = 1e-7
FIRST_BASIS = 12  # vectors allocated at first
RESTARTS = 8
REST = 0.1  # part of a vector that is left outside of others from which it is orthogonal to them at once
GAINED = 1e-3  # part of the residual of a guess to which it is reduced, so that solutions nearby differ as they should


@dataclass(frozen=True, eq=False)
class Accuracy:
    """When a solution is good enough by its own error, whatever the units of the equations.

    The error is estimated by the preconditioner, about A^-1: it is at most the residual's norm times the longest that a
    unit vector of the Krylov space becomes. size : the norm of solutions.  wanted : the error of a solution that
    is small enough.  most : at most that for all solutions of a size, so that few of them must be looked at.
    """

    size: Callable[[Vector], float]
    wanted: Callable[[Vector], float]
    most: Callable[[float], float] | None = None


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
        self.sizes: list[float] = []
        self.size_of_base = -1.0  # not known yet
        self.met = False

    def __call__(self, y: Vector, directions: list[Vector], left: float) -> bool:
        self.sizes.append(self.accuracy.size(directions[-1]))
        self.longest = max(self.longest, self.sizes[-1])
        error = left * self.longest
        if self.accuracy.most is not None and error > self.accuracy.most(self._at_most(y)):
            return False
        solution = self.base + combination(y, directions)
        self.met = error <= self.accuracy.wanted(solution)
        return self.met

    def _at_most(self, y: Vector) -> float:
        """The size of base + sum y_i directions_i, by the triangle inequality."""
        if self.size_of_base < 0.0:
            self.size_of_base = self.accuracy.size(self.base)
        return self.size_of_base + float(np.abs(y) @ np.array(self.sizes))


def _cycle(
    apply: Operator, precondition: Operator, v: Vector, beta: float, goal: float, check: _Check | None,
    learn: Learn | None,
) -> tuple[Vector, int, float]:  # fmt: skip
    """One cycle of at most RESTART steps: the update of x, the number of steps, the norm of the residual left."""
    kind = v.dtype
    basis = np.empty((FIRST_BASIS, len(v)), kind)
    directions: list[Vector] = []
    basis[0] = v
    smallest = SmallestResidual(beta, kind)
    steps, left = 0, beta
    for k in range(RESTART):
        if k + 1 == len(basis):
            basis = np.concatenate([basis, np.empty_like(basis)])
        directions.append(_own(precondition(basis[k]), kind, basis))
        w = _own(apply(directions[k]), kind, basis, directions[k])
        column = np.zeros(k + 2, kind)
        column[: k + 1], length = _orthogonalised(w, basis[: k + 1])
        column[k + 1] = length
        if not np.all(np.isfinite(column)):  # LAPACK would print that
            return np.zeros_like(v), k + 1, np.inf
        steps = k + 1
        left = smallest.with_column(column)
        np.divide(w, length if length > 0.0 else 1.0, out=basis[k + 1])
        met = check is not None and check(smallest.solution(), directions, left)
        if met or left <= goal or length <= 1e-14 * beta:
            break
    if learn is not None:
        learn(np.array(directions), basis[: steps + 1], smallest.hessenberg[: steps + 1, :steps])
    y, left = smallest.solution(), smallest.residual()
    return combination(y, directions), steps, left


def _own(x: Vector, kind: np.dtype[Any], *others: Vector) -> Vector:
    """x as an array of this type that may be written into: what was given may be one of the others."""
    return np.array(x, kind) if any(np.may_share_memory(x, other) for other in others) else np.asarray(x, kind)


def _orthogonalised(w: Vector, basis: Vector) -> tuple[Vector, float]:
    """The parts of w along orthonormal rows, which are taken away from it in place, twice; how long the rest is.

    Once is enough where so much is left that the rest is orthogonal to them to all digits but one.
    """
    if basis.dtype == float:
        first = inner(w[None], basis)[0]
        *second, left = added_and_multiplied(-first, basis, w)
        if left > REST * REST * float(first @ first):
            return first, math.sqrt(left)
        more = np.array(second)
        return first + more, math.sqrt(added_and_multiplied(-more, basis, w)[-1])
    parts = np.zeros(len(basis), basis.dtype)
    for _ in range(2):
        h = np.einsum("ij,j->i", basis.conj(), w)
        w -= np.einsum("i,ij->j", h, basis)
        parts += h
    return parts, norm(w)
