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
from functools import cache
from typing import Protocol

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.defining import BRANCH, FOLD, PAIR
from contin.machine.elementary import cos

NEWTON_BUDGET = 30
SETTLED = 1e-13  # a correction below this is rounding
STALLED = 1e-7  # a correction that no longer falls must at least be below this
PERTURBATION = 1e-12  # of the solution, to sample the rounding errors of the defining system
ALIKE = 4.0  # rounding errors of terms, in units of them
ROUNDED = 1e-9  # ... and where all terms are rounded anew, while the curvature is below rounding errors
SAMPLES = 6
LINEAR = 0.4  # ratio of corrections from which Newton converges linearly
FOLLOWED = 2  # corrections of the other unknowns
STEADY = 0.02  # ... where the ratio is the same twice
BESIDE = 1e-2  # of the unknowns, where the size of the Jacobian is measured too
FLAT = 1e-8  # singular values this small beside its size: a direction in which the system hardly changes
CLEAR = 20.0  # times the rounding errors: a change that is none of them


class Local(Protocol):
    """F near a point, in scaled unknowns y (n + 1,), the parameter last."""

    @property
    def n(self) -> int: ...

    @property
    def identity(self) -> Array:
        """The matrix I of F_u - lambda I, (n, n); diagonal, not 1 where equations are divided by their rates."""

    def linearise(self, y: Array) -> tuple[Array, Array]:
        """F(y) (n,) and J(y) (n, n + 1)."""

    def linearised(self, y: Array) -> tuple[Array, Array]:
        """The same at m places (m, n + 1): (m, n) and (m, n, n + 1)."""

    def hessian(self, y: Array, v: Vector) -> Vector:
        """The matrix D^2F(y)[v, .] (n, n + 1) for a direction v (n + 1,), real or complex."""

    def bordered(self, kind: int, b: Vector, c: Vector, shift: float = 0.0, unit: float = 1.0) -> Evaluated | None:
        """Defining equations as `contin.kernels.defining` has them (kind, borders); None where no kernel does."""


class Evaluated(Protocol):
    """What `System` needs, by one kernel call each."""

    def at(self, x: Array) -> tuple[Array, Array]: ...

    def values(self, x: Array) -> Array: ...

    def terms(self, x: Array) -> Array: ...

    def around(self, x: Array) -> tuple[Array, Array, Array]: ...


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution of a defining system: y, its residual (maximum norm, relative to the entries of its Jacobian) and the
    estimated error of y's last entry."""

    y: Array
    extra: Array  # further unknowns (the frequency)
    residual: float
    error: float
    noise: float  # of the residual: what it can be at a true solution
    sensitivity: float = 0.0  # of y's last entry to relative errors of the equations and their derivatives


@dataclass(frozen=True, eq=False)
class System:
    """Equations G(x) = 0.

    at : G(x) (k,), and its Jacobian.  values : G alone, (m, k), at m places (m, unknowns).  terms : sizes of the terms
    that G(x) is made of, (k,): an entry of the Jacobian may be a sum of terms that cancel, and err alike at all places.
    looked : G at rows x, (m, k), its Jacobians at the first two, (2, k, unknowns), and the terms at the first; all in
    one call, where there is one for it.
    """

    at: Callable[[Array], tuple[Array, Array]]
    values: Callable[[Array], Array]
    terms: Callable[[Array], Array] | None = None
    looked: Callable[[Array], tuple[Array, Array, Array]] | None = None

    @classmethod
    def compiled(cls, equations: Evaluated) -> System:
        """Of equations that a kernel evaluates."""
        return cls(equations.at, equations.values, equations.terms, equations.around)

    def around(self, x: Array) -> tuple[Array, Array, Array]:
        """`looked`, also where it takes several calls."""
        if self.looked is not None:
            return self.looked(x)
        (g, matrix), beside = self.at(x[0]), self.at(x[1])
        values = np.concatenate([g[None], beside[0][None], self.values(x[2:])])
        terms = np.zeros(len(g)) if self.terms is None else self.terms(x[0])
        return values, np.array([matrix, beside[1]]), terms


def newton(system: System, x: Array, position: int) -> Solved | None:
    """Gauss-Newton on G(x) = 0 (as many equations as unknowns, or more that are consistent) until rounding decides.

    The error of x[position] is estimated from the scatter of single Newton steps from solutions perturbed by 1e-12:
    that measures how the rounding errors of G, whatever they are, reach the answer. In directions in which the
    Jacobian nearly vanishes the error is how far G stays below its rounding errors.
    """
    reached = _converged(system, x, position)
    return None if reached is None else _estimated(system, reached[0], position, reached[1])


def _converged(system: System, x: Array, position: int) -> tuple[Array, float] | None:
    """The solution without its errors, and what x[position] still lacks.

    Where Newton converges linearly (a degenerate solution) its geometric series is summed.
    """
    before, ratio_before, lacking, step = np.inf, 0.0, 0.0, np.zeros_like(x)
    for _ in range(NEWTON_BUDGET):
        g, matrix = system.at(x)
        if not (np.isfinite(g).all() and np.isfinite(matrix).all()):
            return None
        solution = _least_squares(matrix, -g)
        if solution is None:
            return None
        step = solution
        size = float(np.linalg.norm(step))
        ratio = size / before if before > 0.0 else 0.0
        if ratio >= 0.95 and size < STALLED:
            lacking = abs(float(step[position]))
            break
        if size > 1e3 or (ratio >= 1.0 and before < STALLED):
            return None
        if LINEAR < ratio < 0.95 and abs(ratio - ratio_before) < STEADY:  # a solution of multiplicity 1/(1 - ratio)
            step, ratio = step / (1.0 - ratio), 0.0
        x = x + step
        if size < SETTLED:
            break
        before, ratio_before = size, ratio
    else:
        if not size < STALLED:
            return None
        lacking = 10.0 * abs(float(step[position]))
    return x, lacking


def _estimated(system: System, x: Array, position: int, lacking: float) -> Solved | None:
    """The solution with its residual, and the errors of both."""
    steps, farther, places = _shifted(x.size)
    sampled, (matrix, beside), terms = system.around(x + places)
    if not np.isfinite(matrix).all():
        return None
    g, entries = sampled[0], np.abs(matrix)
    beside = np.where(np.isfinite(beside), np.abs(beside), 0.0)  # at a degenerate point all of the matrix may vanish
    sizes = np.maximum(entries, beside).max(axis=1)
    largest, biggest, epsilon = float(entries.max()), float(np.abs(x).max()), float(np.finfo(float).eps)
    left, singular, right = np.linalg.svd(matrix, full_matrices=False)
    flat = singular <= FLAT * max(float(singular[0]), float(sizes.max()))
    some = bool(flat.any())
    inverses = np.where(flat, 0.0, 1.0 / np.where(flat, 1.0, singular)) if some else 1.0 / singular
    row = (right.T[position] * inverses) @ left.T  # without the flat directions, see `_reach`
    weights, steep = np.abs(row), right[~flat] if some else right
    close, ahead, behind = sampled[2 : 2 + SAMPLES], sampled[2 + SAMPLES : -SAMPLES], sampled[-SAMPLES:]
    estimates = (steps @ steep.T) @ steep[:, position] - close @ row
    linear = farther @ matrix.T
    near = np.abs(close - g - steps @ matrix.T).max(axis=0)  # rounding errors: of short steps
    curved = np.abs(ahead - g - linear).max(axis=0)  # ... of longer ones with what is curved
    odd = np.abs(0.5 * (ahead - behind) - linear).max(axis=0)  # ... and without
    noise = max(epsilon * largest * biggest, float(near.max()), float(curved.max()))
    rounded = float(weights @ odd)  # of 1 + small, say, the steps of 1e-12 see nothing at all
    alike = ALIKE * epsilon * terms
    error = 2.0 * max(float(np.abs(estimates).max()), rounded) + lacking + float(weights @ alike)
    if some:
        rounded_x = epsilon * biggest * sizes  # what the unknowns' own rounding makes of it
        limits = np.maximum(CLEAR * np.maximum.reduce([near, odd, rounded_x, alike]), np.abs(g))
        error += _along(system, x, position, g, right[flat], limits)
        whole = (right.T[position] / np.maximum(singular, 1e-300)) @ left.T
        felt = float(np.abs(whole) @ alike)  # how the terms' errors reach the answer; no other estimate shows them
        if felt > error:
            limits = np.maximum(limits, alike.max())
            error = max(error, min(felt, _along(system, x, position, g, right[flat], limits)))
    size = largest or 1.0  # in units of time, of which residuals must not depend
    residual = float(np.abs(g).max()) / size
    sensitivity = float(weights @ sizes) * max(1.0, biggest)
    return Solved(x[: position + 1], x[position + 1 :], residual, error, noise / size, sensitivity)


def _along(system: System, x: Array, position: int, g: Array, directions: Array, limits: Array) -> float:
    """The part of x[position] in how far G stays within its rounding errors along directions, together."""
    parts = [(abs(float(d[position])), d) for d in directions]
    return float(sum(part * _reach(system, x, position, g, d, limits) for part, d in parts if part > 0.0))


def _reach(system: System, x: Array, position: int, g: Array, direction: Array, limits: Array) -> float:
    """How far G stays within its rounding errors along a direction in which it hardly changes.

    The other unknowns follow: where branches touch, G is small along a curve.
    """
    distance = PERTURBATION
    others = np.delete(np.arange(x.size), position)

    def leaves(at: Array) -> bool:
        for _ in range(FOLLOWED):
            value, matrix = system.at(at)
            if bool(np.all(np.abs(value - g) <= limits)):
                return False
            step = _least_squares(matrix[:, others], g - value) if np.all(np.isfinite(matrix)) else None
            if step is None or not np.linalg.norm(step) < distance:
                return True
            at[others] += step
        return bool(np.any(np.abs(system.values(at[None])[0] - g) > limits))

    while distance < 0.1:
        if all(leaves(x + sign * distance * direction) for sign in (1.0, -1.0)):
            break
        distance *= 3.0
    return distance


@cache
def shifts(size: int) -> Array:
    """Perturbations of unknowns, (`SAMPLES`, size)."""
    return np.asarray(PERTURBATION * np.random.default_rng(12345).uniform(-1.0, 1.0, (SAMPLES, size)))


@cache
def _shifted(size: int) -> tuple[Array, Array, Array]:
    """Short steps and longer ones, (`SAMPLES`, size): so near, terms with cancelling parts may not change at all.

    And all places about a solution, less it: itself, one beside it, and those after the short steps and after the
    longer ones, both ways.
    """
    steps = shifts(size)
    farther = ROUNDED / PERTURBATION * steps
    return steps, farther, np.concatenate([np.zeros((1, size)), [BESIDE * generic(size)], steps, farther, -farther])


@cache
def generic(size: int) -> Array:
    """A direction in which nothing is special, (size,)."""
    return np.asarray(cos(1.0 + np.arange(size)))


def _least_squares(matrix: Array, right: Array) -> Array | None:
    try:
        if matrix.shape[0] == matrix.shape[1]:
            return np.asarray(np.linalg.solve(matrix, right))
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-15)[0])
    except np.linalg.LinAlgError:  # Newton ends: not verified, in words
        return None


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
        v, w, g = _bordered(jacobian, b, c)
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
        v, w, _ = _bordered(jacobian, b, c)
        size = np.abs(jacobian)
        return np.concatenate([size @ np.abs(x), (np.abs(w).T @ size @ np.abs(v)).T.ravel()])

    return newton(System(at, values, terms), y, n)


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
    reached = _converged(system, np.append(y, 1.0), local.n)
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
        v, w, g = _bordered(jacobian[:, :n] - shift(unit * x[-1]) * identity, b, c)
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
        v, w, _ = _bordered(jacobian[:, :n] - value * identity, b, c)
        sizes = np.abs(w).T @ (np.abs(jacobian[:, :n]) + abs(value) * np.abs(identity)) @ np.abs(v)
        both = [part for column in sizes.T for part in (column, column)]  # real and imaginary parts
        return np.concatenate([np.abs(jacobian) @ np.abs(x[: n + 1]), *both])

    return System(at, values, terms)


def eigenvalue_at(local: Local, y: Array, value: float) -> Solved | None:
    """F = 0 and F_u - value I singular (value = -2 where F_u = G_u - I: a period doubling of the map G)."""
    n = local.n
    identity = local.identity
    b, c = singular_basis(local.linearise(y)[1][:, :n] - value * identity, 1)

    return newton(_real_critical(local, b, c, value), y, n)


def _real_critical(local: Local, b: Array, c: Array, value: float) -> System:
    """F = 0 and F_u - value I bordered by b, c, of corank 1."""
    n = local.n
    compiled = local.bordered(FOLD, b, c, value)
    if compiled is not None:
        return System.compiled(compiled)
    shift = value * local.identity

    def at(x: Array) -> tuple[Array, Array]:
        f, jacobian = local.linearise(x)
        v, w, g = _bordered(jacobian[:, :n] - shift, b, c)
        direction, matrix, residual = np.zeros(n + 1), np.empty((n + 1, n + 1)), np.empty(n + 1)
        direction[:n] = v[:, 0]
        matrix[:n], matrix[n] = jacobian, -(w.T @ local.hessian(x, direction))
        residual[:n], residual[n] = f, g[0, 0]
        return residual, matrix

    def values(x: Array) -> Array:
        f, jacobians = local.linearised(x)
        return np.concatenate([f, _bordered_values(jacobians[:, :, :n] - shift, b, c)[:, :, 0]], axis=1)

    def terms(x: Array) -> Array:
        jacobian = local.linearise(x)[1]
        v, w, _ = _bordered(jacobian[:, :n] - shift, b, c)
        size = np.abs(jacobian)
        return np.append(size @ np.abs(x), np.abs(w[:, 0]) @ size[:, :n] @ np.abs(v[:, 0]))

    return System(at, values, terms)


def _bordered_values(matrices: Vector, b: Vector, c: Vector) -> Vector:
    """The blocks g of `_bordered` for matrices (m, rows, columns)."""
    count, rows, columns = matrices.shape
    kernel = c.shape[1]
    bordered = np.zeros((count, rows + kernel, rows + kernel), np.result_type(matrices, b, c))
    bordered[:, :rows, :columns] = matrices
    bordered[:, :rows, columns:] = b
    bordered[:, rows:, :columns] = c.conj().T
    try:
        return np.asarray(np.linalg.inv(bordered)[:, columns:, rows:])
    except np.linalg.LinAlgError:  # one of them is singular: NaN for that one
        return np.array([_bordered(matrix, b, c)[2] for matrix in matrices])


def _bordered(
    matrix: Vector, b: Vector, c: Vector
) -> tuple[Vector, Vector, Vector]:
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
