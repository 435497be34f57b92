"""The reduced equation at a point where F_u is singular, from bordered solves alone (no transposes).

Near z0 the curves F(z) = 0 are the zeros of a scalar function mu(a1, a2): F(z) + mu b = 0, c_i . (z - z0) = a_i. With
K = [J b; C^T 0], which is regular, z and mu and all their derivatives in a are solutions of K x = r:

    K (z_i, mu_i) = (0, e_i),   K (z_ij, mu_ij) = (-D^2F[z_i, z_j], 0),
    K (z_aaa, mu_aaa) = (-D^3F[z_a, z_a, z_a] - 3 D^2F[z_a, z_aa], 0).

A branch point is where mu = mu_1 = mu_2 = 0; its branches leave along the zeros of the quadratic form mu_ij
(Lyapunov and Schmidt; Govaerts 2000, ch. 6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import NotFiniteError
from contin.linalg.linear import Solution
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.tolerances import STALLED

if TYPE_CHECKING:
    from contin.problems.sparse.equations import SparseEquations

STEPS: Final = 12
EPSILON: Final = float(np.finfo(float).eps)
ALONG: Final = 1e-6  # what is left of a tangent along null vectors
SINGULAR: Final = 1e8  # length of solutions with borders of length 1 from which K is singular


def border_rows(nulls: Array, tangent: Array, scale: Array) -> Array:
    """C (n + 1, k + 1), raw: null vectors (n + 1, k), orthonormal and scaled, and the part of `tangent` across them.

    Where the branch leaves along them, the direction of the parameter.
    """
    other = tangent - nulls @ (nulls.T @ tangent)
    if norm(other) < ALONG:
        other = np.append(np.zeros(len(tangent) - 1), 1.0)
    return np.column_stack([nulls, other / norm(other)]) / scale[:, None]


@dataclass(frozen=True, eq=False)
class Crossing:
    """A branch point z, what is left there of mu and of its gradient (2,), and the Hessian (2, 2) next to it."""

    z: Array
    mu: float
    gradient: Array
    hessian: Array


@dataclass(frozen=True, eq=False)
class Reduced:
    """The reduction around z0 (raw unknowns (n + 1,)) with border rows C (n + 1, 2), raw, and column b (n,).

    scale : (n + 1,), in whose units z is measured and the rows C have length 1.
    """

    problem: SparseEquations
    rows: Array
    column: Array
    scale: Array

    def solver(self, z: Array) -> Solution:
        """K at z, its unknowns in the order (state, mu, parameter); NotFiniteError where F_u is not finite."""
        linear = self.problem.linear(z) if np.all(np.isfinite(z)) else None
        if linear is None:
            raise NotFiniteError("the Jacobian is not finite near this point")
        columns = np.column_stack([self.column, self.problem.parameter_slope(z)])
        corner = np.column_stack([np.zeros(2), self.rows[-1]])
        solution: Solution = linear.bordered(columns, self.rows[:-1], corner)
        return solution

    def solve(self, solver: Solution, f: Array, g: Array) -> tuple[Array, float]:
        """(z part (n + 1,), mu part) of K^-1 (f, g)."""
        x = np.real(solver.solve(np.concatenate([f, g])))
        return np.append(x[:-2], x[-1]), float(x[-2])

    def first(self, z: Array) -> tuple[Solution, Array, Array]:
        """The solver at z, z_i as rows (2, n + 1), and the gradient mu_i (2,)."""
        solver = self.solver(z)
        zero = np.zeros(len(self.column))
        pairs = [self._refined(z, solver, *self.solve(solver, zero, e), e) for e in np.eye(2)]
        return solver, np.array([v for v, _ in pairs]), np.array([m for _, m in pairs])

    def _refined(self, z: Array, solver: Solution, v: Array, m: float, e: Array) -> tuple[Array, float]:
        """The solution of K (v, m) = (0, e) corrected by its residual.

        Where F_u is nearly singular, elimination of the borders with its factors leaves some 100 rounding errors, the
        same ones from everywhere: no scatter of Newton's method shows them.
        """
        linear = self.problem.linear(z)
        if linear is None:
            return v, m
        left = linear.apply(v[:-1]) + v[-1] * self.problem.parameter_slope(z) + m * self.column
        dv, dm = self.solve(solver, -left, e - self.rows.T @ v)
        return v + dv, m + dm

    def second(self, z: Array, solver: Solution, along: Array) -> Array:
        """The Hessian mu_ij (2, 2)."""
        hessian = np.empty((2, 2))
        for i in range(2):
            for j in range(i + 1):
                value = self.solve(solver, -self.problem.form(z, along[i], along[j]), np.zeros(2))[1]
                hessian[i, j] = hessian[j, i] = value
        return hessian

    def branch_point(self, z: Array, hessian: Array | None = None) -> Crossing | None:
        """Newton on F + mu b = 0, mu_1 = mu_2 = 0 from z next to the curve.

        hessian : mu_ij of a point nearby, which is kept then: convergence is linear, with the distance to it as rate.
        """
        try:
            return self._newton(z, hessian)
        except NotFiniteError:  # not verified, in words
            return None

    def _newton(self, z: Array, known: Array | None) -> Crossing | None:
        """One factorisation of K an iteration: it corrects z and mu, and gives the gradient and its derivatives.

        The gradient is that before the correction onto the curve, of second order in the step before: so is the whole.
        """
        origin, a, mu = z, np.zeros(2), 0.0
        before = np.inf
        for k in range(STEPS):
            solver, along, gradient = self.first(z)
            hessian = self.second(z, solver, along) if known is None else known
            left = self.problem.residual(z) + mu * self.column
            moved, added = self.solve(solver, -left, a - self.rows.T @ (z - origin))
            if not (np.all(np.isfinite(hessian)) and np.all(np.isfinite(moved))):
                return None
            step = np.linalg.lstsq(hessian, -gradient, rcond=None)[0]
            size = float(elementary.hypot(norm(step), norm(moved / self.scale)))
            if not np.isfinite(size):
                return None
            if k > 1:  # (the second correction follows that onto the curve, which may be smaller)
                if size >= 0.5 * before and size < STALLED:
                    break
                if size > 2.0 * before:
                    return None
            z, mu, a = z + moved + step @ along, mu + added + float(gradient @ step), a + step
            if k > 0 and size * (size / before) < EPSILON:  # what is left falls as much again: rounding
                break
            before = size
        return Crossing(z, mu, gradient, hessian)

    def crossing(self, z: Array) -> list[tuple[Array, Array]]:
        """Tangents z' and second derivatives z'' (raw) of the branches that cross at the branch point z.

        None where its kernel has more dimensions than one: K is singular there.
        """
        solver, along, _ = self.first(z)
        if not norm((along / self.scale).ravel()) < SINGULAR:
            return []
        form = self.second(z, solver, along)
        values, vectors = np.linalg.eigh(form)
        if not values[0] * values[1] < 0.0:
            return []
        ratio = np.sqrt(-values[0] / values[1])
        return [self._curve(z, solver, along, form, vectors[:, 0] + s * ratio * vectors[:, 1]) for s in (1.0, -1.0)]

    def _curve(self, z: Array, solver: Solution, along: Array, form: Array, a: Array) -> tuple[Array, Array]:
        """z(s) = z + s z' + s^2 z''/2 of the branch with reduced direction a; its second order lies across a."""
        across = np.array([-a[1], a[0]])
        direction = a @ along
        bent, _ = self.solve(solver, -self.problem.form(z, direction, direction), np.zeros(2))
        third = -self.problem.form(z, direction, direction, direction) - 3.0 * self.problem.form(z, direction, bent)
        cubic = self.solve(solver, third, np.zeros(2))[1]
        slope = 3.0 * float(a @ form @ across)
        return direction, bent - (cubic / slope) * (across @ along) if slope != 0.0 else bent
