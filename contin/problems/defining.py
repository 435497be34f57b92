"""Defining systems of special points, solved by Newton to full precision (minimally augmented, bordered).

A point z = (u, p) on F(z) = 0, J = [F_u F_p] (n, n + 1), is a fold, branch, Hopf, ... point where some matrix B(z)
loses rank. B is bordered to a regular matrix, [B b; c^* 0] [V; g] = [0; I]; then g(z) = 0 says that B is singular, V
spans its null space, and with the left solution w the derivative is dg = -w^* (dB) V (Griewank and Reddien 1984;
Govaerts 2000). Every function here takes a `Local` system in scaled unknowns, so that borders, tolerances and norms
have a meaning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

NEWTON_BUDGET = 15
SETTLED = 1e-13  # a correction below this is rounding
STALLED = 1e-7  # a correction that no longer falls must at least be below this
PERTURBATION = 1e-12  # of the solution, to sample the rounding errors of the defining system
SAMPLES = 6


class Local(Protocol):
    """F near a point, in scaled unknowns y (n + 1,), the parameter last."""

    @property
    def n(self) -> int: ...

    def linearise(self, y: Array) -> tuple[Array, Array]:
        """F(y) (n,) and J(y) (n, n + 1)."""

    def hessian(self, y: Array, v: NDArray[Any]) -> NDArray[Any]:
        """The matrix D^2F(y)[v, .] (n, n + 1) for a direction v (n + 1,), real or complex."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution of a defining system: y, its residual (maximum norm, relative to the entries of its Jacobian) and the
    estimated error of y's last entry."""

    y: Array
    extra: Array  # further unknowns (the frequency)
    residual: float
    error: float
    noise: float  # of the residual: what it can be at a true solution


class System(Protocol):
    """Equations G(x) = 0."""

    def __call__(self, x: Array, slopes: bool = True) -> tuple[Array, Array]:
        """G(x), and its Jacobian where `slopes` are asked for (else an empty matrix)."""


NO_SLOPES = np.empty((0, 0))


def newton(system: System, x: Array, position: int) -> Solved | None:
    """Gauss-Newton on G(x) = 0 (as many equations as unknowns, or more that are consistent) until rounding decides.

    The error of x[position] is estimated from the scatter of single Newton steps from solutions perturbed by 1e-12:
    that measures how the rounding errors of G, whatever they are, reach the answer. Where Newton converges linearly (a
    degenerate solution), what its geometric series still lacks is added.
    """
    before, lacking = np.inf, 0.0
    matrix = np.empty((0, 0))
    for _ in range(NEWTON_BUDGET):
        g, matrix = system(x)
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(matrix))):
            return None
        step = _least_squares(matrix, -g)
        if step is None:
            return None
        size = float(np.linalg.norm(step))
        if size >= 0.5 * before and size < STALLED:
            ratio = min(size / before, 0.9)
            lacking = 2.0 * abs(float(step[position])) * ratio / (1.0 - ratio) if size > 1e3 * SETTLED else 0.0
            break
        if size > 1e3 or (size >= before and before < STALLED):
            return None
        x = x + step
        if size < SETTLED:
            break
        before = size
    else:
        return None
    g, matrix = system(x)
    generator = np.random.default_rng(12345)
    inverse = np.linalg.pinv(matrix) if matrix.shape[0] != matrix.shape[1] else _inverse(matrix)
    if inverse is None:
        return None
    row = inverse[position]
    estimates, noise = [], 1e-14 * float(np.max(np.abs(matrix)))
    for _ in range(SAMPLES):
        shift = PERTURBATION * generator.uniform(-1.0, 1.0, x.size)
        value, _ = system(x + shift, slopes=False)
        estimates.append(shift[position] - float(row @ value))
        noise = max(noise, float(np.max(np.abs(value - g - matrix @ shift))))
    scatter = float(np.max(np.abs(estimates)))
    size = float(np.max(np.abs(matrix))) or 1.0  # in units of time, of which residuals must not depend
    residual = float(np.max(np.abs(g))) / size
    return Solved(x[: position + 1], x[position + 1 :], residual, 2.0 * scatter + lacking, noise / size)


def _least_squares(matrix: Array, right: Array) -> Array | None:
    try:
        if matrix.shape[0] == matrix.shape[1]:
            return np.asarray(np.linalg.solve(matrix, right))
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
    except np.linalg.LinAlgError:
        return None


def _inverse(matrix: Array) -> Array | None:
    try:
        return np.asarray(np.linalg.inv(matrix))
    except np.linalg.LinAlgError:
        return None


def singular_basis(matrix: NDArray[Any], dimension: int) -> tuple[NDArray[Any], NDArray[Any]]:
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

    def system(x: Array, slopes: bool = True) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = _bordered(jacobian[:, :n], b, c)
        return np.append(f, g[0, 0]), _with_gradient(local, x, jacobian, v, w) if slopes else NO_SLOPES

    return newton(system, y, n)


def branch_point(local: Local, y: Array, corank: int = 1) -> Solved | None:
    """F = 0 and [F_u F_p] of rank n - corank: n + corank (corank + 1) equations, consistent at a true branch point."""
    n = local.n
    b, c = singular_basis(local.linearise(y)[1], corank)

    def system(x: Array, slopes: bool = True) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = _bordered(jacobian, b, c)
        if not slopes:
            return np.concatenate([f, g.T.ravel()]), NO_SLOPES
        rows = [jacobian]
        for k in range(corank + 1):
            rows.append(-(w.T @ local.hessian(x, v[:, k])))
        return np.concatenate([f, g.T.ravel()]), np.vstack(rows)

    return newton(system, y, n)


def critical_pair(
    local: Local, y: Array, shift: Callable[[float], complex], rate: Callable[[float], complex], angle: float,
    corank: int = 1,
) -> Solved | None:  # fmt: skip
    """F = 0 and F_u - shift(w) I of corank k, w unknown: a Hopf point (shift = i w), a Neimark-Sacker point (e^(iw)
    - 1).

    n + 2 k^2 real equations for (y, w); `rate` is d shift / d w, `angle` the guess of w, and its unit.
    """
    n = local.n
    identity = np.eye(n)
    b, c = singular_basis(local.linearise(y)[1][:, :n] - shift(angle) * identity, corank)
    unit = abs(angle) or 1.0

    def system(x: Array, slopes: bool = True) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x[: n + 1])
        v, w, g = _bordered(jacobian[:, :n] - shift(unit * x[-1]) * identity, b, c)
        residual = np.concatenate([f, *(part for column in g.T for part in (column.real, column.imag))])
        if not slopes:
            return residual, NO_SLOPES
        adjoint = w.conj().T
        blocks = [np.hstack([jacobian, np.zeros((n, 1))])]
        for k in range(corank):
            gradient = -(adjoint @ local.hessian(x[: n + 1], np.append(v[:, k], 0.0)))
            complete = np.hstack([gradient, unit * rate(unit * x[-1]) * (adjoint @ v[:, [k]])])
            blocks += [complete.real, complete.imag]
        return residual, np.vstack(blocks)

    solved = newton(system, np.append(y, angle / unit), n)
    return None if solved is None else replace(solved, extra=unit * solved.extra)


def eigenvalue_at(local: Local, y: Array, value: float) -> Solved | None:
    """F = 0 and F_u - value I singular (value = -2 where F_u = G_u - I: a period doubling of the map G)."""
    n = local.n
    identity = np.eye(n)
    b, c = singular_basis(local.linearise(y)[1][:, :n] - value * identity, 1)

    def system(x: Array, slopes: bool = True) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = _bordered(jacobian[:, :n] - value * identity, b, c)
        return np.append(f, g[0, 0]), _with_gradient(local, x, jacobian, v, w) if slopes else NO_SLOPES

    return newton(system, y, n)


def _bordered(
    matrix: NDArray[Any], b: NDArray[Any], c: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Solve [B b; c^* 0] [V; g] = [0; I] and [B b; c^* 0]^* [w; .] = [0; I]; returns V, w, g."""
    rows, columns = matrix.shape
    kernel = c.shape[1]
    bordered = np.zeros((rows + kernel, rows + kernel), np.result_type(matrix, b, c))
    bordered[:rows, :columns] = matrix
    bordered[:rows, columns:] = b
    bordered[rows:, :columns] = c.conj().T
    try:
        inverse = np.linalg.inv(bordered)
    except np.linalg.LinAlgError:
        inverse = np.full_like(bordered, np.nan)
    return inverse[:columns, rows:], inverse[columns:, :rows].conj().T, inverse[columns:, rows:]


def _with_gradient(local: Local, x: Array, jacobian: Array, v: Array, w: Array) -> Array:
    """[J; dg] for a real matrix F_u - value I of corank 1."""
    return np.vstack([jacobian, -(w.T @ local.hessian(x, np.append(v[:, 0], 0.0)))])
