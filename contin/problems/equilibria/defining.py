"""Defining systems of special points, solved by Newton to full precision (minimally augmented, bordered).

A point z = (u, p) on F(z) = 0, J = [F_u F_p] (n, n + 1), is a fold, branch, Hopf, ... point where some matrix B(z)
loses rank. B is bordered to a regular matrix, [B b; c^* 0] [V; g] = [0; I]; then g(z) = 0 says that B is singular, V
spans its null space, and with the left solution w the derivative is dg = -w^* (dB) V (Griewank and Reddien 1984;
Govaerts 2000). Every function here takes a `Local` system in scaled unknowns, so that borders, tolerances and norms
have a meaning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.defining import BRANCH, FOLD, PAIR
from contin.problems.equilibria.solved_to_rounding import Evaluated, Solved, System, converged, newton


class Local(Protocol):
    """F near a point, in scaled unknowns y (n + 1,), the parameter last."""

    @property
    def n(self) -> int: ...

    @property
    def identity(self) -> Array:
        """The matrix I of F_u - lambda I, (n, n); diagonal, not 1 where equations are divided by their rates."""

    @property
    def grained(self) -> bool:
        """Values are rounded to some digits, or noisy."""

    def linearise(self, y: Array) -> tuple[Array, Array]:
        """F(y) (n,) and J(y) (n, n + 1)."""

    def linearised(self, y: Array) -> tuple[Array, Array]:
        """The same at m places (m, n + 1): (m, n) and (m, n, n + 1)."""

    def hessian(self, y: Array, v: Vector) -> Vector:
        """The matrix D^2F(y)[v, .] (n, n + 1) for a direction v (n + 1,), real or complex."""

    def bordered(self, kind: int, b: Vector, c: Vector, shift: float = 0.0, unit: float = 1.0) -> Evaluated | None:
        """Defining equations as `contin.kernels.defining` has them (kind, borders); None where no kernel does."""


def singular_basis(matrix: Vector, dimension: int) -> tuple[Vector, Vector]:
    """Orthonormal bases of the left and right spaces of the `dimension` smallest singular values.

    NaN, with which Newton's method ends, where the equations have no value.
    """
    rows, columns = matrix.shape[0], matrix.shape[1] - matrix.shape[0]
    if not np.isfinite(matrix).all():
        return np.full((rows, dimension), np.nan), np.full((rows + columns, dimension + columns), np.nan)
    left, _, right = np.linalg.svd(matrix)
    return left[:, rows - dimension :], right.conj().T[:, rows - dimension :]


def fold(local: Local, y: Array) -> Solved | None:
    """F = 0 and F_u singular: n + 1 equations for y."""
    n = local.n
    b, c = singular_basis(local.linearise(y)[1][:, :n], 1)

    return newton(_real_critical(local, b, c, 0.0), y, n)


def branch_point(local: Local, y: Array, corank: int = 1) -> Solved | None:
    """F = 0 and [F_u F_p] of rank n - corank: n + corank (corank + 1) equations, consistent at a true branch point."""
    n = local.n
    b, c = singular_basis(local.linearise(y)[1], corank)
    compiled = local.bordered(BRANCH, b, c) if corank == 1 else None
    if compiled is not None:
        return newton(System.compiled(compiled), y, n)

    def at(x: Array) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = solve_bordered(jacobian, b, c)
        rows = [jacobian]
        for k in range(corank + 1):
            rows.append(-(w.T @ local.hessian(x, v[:, k])))
        return np.concatenate([f, g.T.ravel()]), np.vstack(rows)

    def values(x: Array) -> Array:
        f, jacobians = local.linearised(x)
        g = _bordered_values(jacobians, b, c)
        return np.concatenate([f, g.swapaxes(1, 2).reshape(len(x), -1)], axis=1)

    def terms(x: Array) -> Array:
        jacobian = local.linearise(x)[1]
        v, w, _ = solve_bordered(jacobian, b, c)
        size = np.abs(jacobian)
        return np.concatenate([size @ np.abs(x), (np.abs(w).T @ size @ np.abs(v)).T.ravel()])

    return newton(System(at, values, terms, grained=local.grained), y, n)


def critical_pair(
    local: Local, y: Array, shift: Callable[[float], complex], rate: Callable[[float], complex], angle: float,
    corank: int = 1,
) -> Solved | None:  # fmt: skip
    """F = 0 and F_u - shift(w) I of corank k, w unknown: a Hopf point (shift = i w), a Neimark-Sacker point (e^(iw)
    - 1).

    n + 2 k^2 real equations for (y, w); `rate` is d shift / d w, `angle` the guess of w, and its unit.
    """
    unit = abs(angle) or 1.0
    solved = newton(_critical_pair(local, y, shift, rate, angle, corank), np.append(y, angle / unit), local.n)
    return None if solved is None else replace(solved, extra=unit * solved.extra)


def hopf_nearby(local: Local, y: Array, omega: float) -> tuple[Array, float] | None:
    """The point with eigenvalues +-i omega that Newton's method finds, and omega; without the work of its errors."""
    system = _critical_pair(local, y, lambda w: 1j * w, lambda w: 1j, omega, 1)
    reached = converged(system, np.append(y, 1.0), local.n)
    return None if reached is None else (reached[0][:-1], abs(omega * float(reached[0][-1])))


def _critical_pair(
    local: Local, y: Array, shift: Callable[[float], complex], rate: Callable[[float], complex], angle: float,
    corank: int,
) -> System:  # fmt: skip
    n = local.n
    identity = local.identity
    b, c = singular_basis(local.linearise(y)[1][:, :n] - shift(angle) * identity, corank)
    unit = abs(angle) or 1.0
    compiled = local.bordered(PAIR, b, c, unit=unit) if corank == 1 else None
    if compiled is not None:
        return System.compiled(compiled)

    def at(x: Array) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x[: n + 1])
        v, w, g = solve_bordered(jacobian[:, :n] - shift(unit * x[-1]) * identity, b, c)
        residual = np.concatenate([f, *(part for column in g.T for part in (column.real, column.imag))])
        adjoint = w.conj().T
        matrix = np.zeros((n + 2 * corank * corank, n + 2))
        matrix[:n, : n + 1] = jacobian
        direction, rows = np.zeros(n + 1, complex), np.empty((corank, n + 2), complex)
        for k in range(corank):
            direction[:n] = v[:, k]
            rows[:, : n + 1] = -(adjoint @ local.hessian(x[: n + 1], direction))
            rows[:, n + 1 :] = unit * rate(unit * x[-1]) * (adjoint @ identity @ v[:, [k]])
            first = n + 2 * corank * k
            matrix[first : first + corank], matrix[first + corank : first + 2 * corank] = rows.real, rows.imag
        return residual, matrix

    def values(x: Array) -> Array:
        f, jacobians = local.linearised(x[:, : n + 1])
        shifts = np.array([shift(unit * w) for w in x[:, -1].tolist()])
        g = _bordered_values(jacobians[:, :, :n] - shifts[:, None, None] * identity, b, c).swapaxes(1, 2)
        return np.concatenate([f, np.stack([g.real, g.imag], axis=2).reshape(len(x), -1)], axis=1)

    def terms(x: Array) -> Array:
        jacobian, value = local.linearise(x[: n + 1])[1], shift(unit * x[-1])
        v, w, _ = solve_bordered(jacobian[:, :n] - value * identity, b, c)
        sizes = np.abs(w).T @ (np.abs(jacobian[:, :n]) + abs(value) * np.abs(identity)) @ np.abs(v)
        both = [part for column in sizes.T for part in (column, column)]  # real and imaginary parts
        return np.concatenate([np.abs(jacobian) @ np.abs(x[: n + 1]), *both])

    return System(at, values, terms, grained=local.grained)


def eigenvalue_at(local: Local, y: Array, value: float, corank: int = 1) -> Solved | None:
    """F = 0 and F_u - value I of corank k (value = -2 where F_u = G_u - I: a period doubling of the map G).

    n + k^2 equations for y, consistent where k such eigenvalues with as many vectors are at one place.
    """
    n = local.n
    identity = local.identity
    b, c = singular_basis(local.linearise(y)[1][:, :n] - value * identity, corank)

    return newton(_real_critical(local, b, c, value), y, n)


def _real_critical(local: Local, b: Array, c: Array, value: float) -> System:
    """F = 0 and F_u - value I bordered by b, c, (n, k), of corank k."""
    n, k = local.n, c.shape[1]
    compiled = local.bordered(FOLD, b, c, value) if k == 1 else None
    if compiled is not None:
        return System.compiled(compiled)
    shift = value * local.identity

    def at(x: Array) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = solve_bordered(jacobian[:, :n] - shift, b, c)
        rows = [-(w.T @ local.hessian(x, np.append(column, 0.0))) for column in v.T]
        return np.concatenate([f, g.T.ravel()]), np.vstack([jacobian, *rows])

    def values(x: Array) -> Array:
        f, jacobians = local.linearised(x)
        g = _bordered_values(jacobians[:, :, :n] - shift, b, c)
        return np.concatenate([f, g.swapaxes(1, 2).reshape(len(x), -1)], axis=1)

    def terms(x: Array) -> Array:
        jacobian = local.linearise(x)[1]
        v, w, _ = solve_bordered(jacobian[:, :n] - shift, b, c)
        size = np.abs(jacobian)
        return np.append(size @ np.abs(x), (np.abs(w).T @ size[:, :n] @ np.abs(v)).T.ravel())

    return System(at, values, terms, grained=local.grained)


def _bordered_values(matrices: Vector, b: Vector, c: Vector) -> Vector:
    """The blocks g of `solve_bordered` for matrices (m, rows, columns)."""
    count, rows, columns = matrices.shape
    kernel = c.shape[1]
    bordered = np.zeros((count, rows + kernel, rows + kernel), np.result_type(matrices, b, c))
    bordered[:, :rows, :columns] = matrices
    bordered[:, :rows, columns:] = b
    bordered[:, rows:, :columns] = c.conj().T
    try:
        return np.asarray(np.linalg.inv(bordered)[:, columns:, rows:])
    except np.linalg.LinAlgError:  # one of them is singular: NaN for that one
        return np.array([solve_bordered(matrix, b, c)[2] for matrix in matrices])


def solve_bordered(matrix: Vector, b: Vector, c: Vector) -> tuple[Vector, Vector, Vector]:
    """Solve [B b; c^* 0] [V; g] = [0; I] and [B b; c^* 0]^* [w; .] = [0; I]; returns V, w, g."""
    rows, columns = matrix.shape
    kernel = c.shape[1]
    bordered = np.zeros((rows + kernel, rows + kernel), np.result_type(matrix, b, c))
    bordered[:rows, :columns] = matrix
    bordered[:rows, columns:] = b
    bordered[rows:, :columns] = c.conj().T
    try:
        inverse = np.linalg.inv(bordered)
    except np.linalg.LinAlgError:  # with NaN Newton ends: not verified, in words
        inverse = np.full_like(bordered, np.nan)
    return inverse[:columns, rows:], inverse[columns:, :rows].conj().T, inverse[columns:, rows:]
