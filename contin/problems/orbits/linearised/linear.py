"""The collocation equations of an orbit as sparse matrices, in scaled unknowns; used to verify special points.

Unknowns x = (u at the nodes, T, p), all divided by the metric; rows divided by the states' sizes. `hessian` is the
derivative of (Jacobian times a vector) by x. The variational equation v' = T f_u v with v(1) = rho v(0) has its own
matrix, which is singular where rho is a multiplier.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.kernels.collocation import LANES, evaluate, forcing_period, new_points, residual, set_phase
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.linearised.bordered import Bordered, crossing
from contin.problems.orbits.linearised.pattern import block_places, matrix_places
from contin.problems.orbits.mesh.layout import Profile, in_intervals

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.problems.orbits.orbit_equations import OrbitEquations

SINGULAR = 1e-7  # a second null vector this exact (relative residual) makes a point a branch point


@dataclass(frozen=True, eq=False)
class OrbitLinear:
    """Equations and derivatives at z; the phase condition refers to `reference` (a vector like z on the same mesh)."""

    problem: OrbitEquations
    z: Array
    scale: Array
    reference: Array

    @cached_property
    def profile(self) -> Profile:
        return self.problem.profile(self.z)

    @cached_property
    def sizes(self) -> Array:
        return np.asarray(self.problem.sizes(self.z, self.scale))

    @property
    def nu(self) -> int:
        """Number of node values."""
        return int(self.profile.u.size)

    @cached_property
    def unknowns(self) -> NDArray[np.intp]:
        """Positions of x in z."""
        return np.append(np.arange(self.nu + 1), self.z.size - 1)

    @cached_property
    def units(self) -> Array:
        """Scale of x."""
        return self.scale[self.unknowns]

    @cached_property
    def field(self) -> Array:
        """f(u) at the nodes, (nodes, n)."""
        parameters = self.problem.full_parameters(self.z)
        return np.asarray(self.problem.system.values(self.profile.u, parameters))

    @cached_property
    def _points(self) -> Any:
        problem, profile = self.problem, self.profile
        w = new_points(profile.n, profile.m, profile.intervals, problem.full_parameters(self.z))  # type: ignore[no-untyped-call]
        set_phase(problem.equations, w, self.reference, self.sizes)
        evaluate(problem.equations, w, self.z, True)
        return w

    @cached_property
    def residual(self) -> Array:
        """Scaled equations, (nu + 1,): collocation (interval, point, state), periodicity, phase."""
        profile = self.profile
        n, m, count = profile.n, profile.m, profile.intervals
        right, jump, border = np.zeros((m * n, count)), np.empty(n), np.zeros(2)
        residual(self.problem.equations, self._points, self.z, right, jump, border)
        local = -right.T.reshape(count, m, n) / self.sizes
        return np.concatenate([local.ravel(), -jump / self.sizes, [-border[0] / self._phase_size]])

    @cached_property
    def _phase_size(self) -> float:
        if not self.problem.autonomous:
            return float(self.scale[self.nu])
        return max(float(np.linalg.norm(self._phase_row * self.units[: self.nu])), 1e-300)

    @cached_property
    def _phase_row(self) -> Array:
        profile = self.profile
        row = np.zeros(profile.u.shape)
        phase = np.einsum("cj,cki->jik", basis(profile.m).values, self._points.phase)  # (m + 1, N, n)
        for j in range(profile.m + 1):
            row[j : j + (profile.intervals - 1) * profile.m + 1 : profile.m] += phase[j]
        return row.ravel()

    @cached_property
    def jacobian(self) -> csc_matrix:
        """(nu + 1, nu + 2) sparse, scaled."""
        profile, w = self.profile, self._points
        h, period = profile.h, profile.period
        fu = self.state_derivatives
        f, fp, ft = (np.moveaxis(a, -1, 0) for a in (w.f, w.fp, w.ft))  # (N, m, n)
        by_period = f + (0.0 if self.problem.autonomous else period * self._times[:, :, None] * ft)
        local = self._local(fu, -h * period, True)
        column_t = -h[:, None, None] * by_period
        column_p = -(h * period)[:, None, None] * fp
        return self._assemble(local, [column_t, column_p], True)

    @property
    def by_parameter(self) -> Array:
        """The last column of the Jacobian, of the varying parameter in its own unit, (nu + 1,)."""
        profile = self.profile
        fp = np.moveaxis(self._points.fp, -1, 0)
        column = (-(profile.h * profile.period)[:, None, None] * fp / self.sizes).ravel()
        phase = 0.0 if self.problem.autonomous else -self._forcing[1] / self._phase_size
        return np.concatenate([column, np.zeros(profile.n), [phase]])

    @property
    def last_column(self) -> Array:
        """The last column of `jacobian`, the same bits, (nu + 1,)."""
        profile = self.profile
        fp = np.moveaxis(self._points.fp, -1, 0)
        entries = (-(profile.h * profile.period)[:, None, None] * fp).reshape(-1, profile.n)
        unit, row = float(self.units[-1]), 1.0 / self.sizes
        phase = 0.0 if self.problem.autonomous else 1.0 / self._phase_size * -self._forcing[1] * unit
        return np.concatenate([(row * entries * unit).ravel(), np.zeros(profile.n), [phase]])

    @property
    def state_derivatives(self) -> Array:
        """f_u at the Gauss points, (N, m, n, n)."""
        fu = self._points.fu
        return np.asarray(fu if self.profile.n > LANES else np.moveaxis(fu, -1, 0))

    @cached_property
    def _times(self) -> Array:
        """Scaled times of the Gauss points, (N, m)."""
        profile = self.profile
        return profile.mesh[:-1, None] + profile.h[:, None] * basis(profile.m).gauss

    def _local(self, matrices: Vector, factor: Array, with_slopes: bool) -> Vector:
        """Blocks (N, m, n, m + 1, n): slopes x identity + factor values x matrices."""
        scheme = basis(self.profile.m)
        blocks = np.einsum("i,cj,ickq->ickjq", factor, scheme.values, matrices)
        if with_slopes:
            blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(self.profile.n))
        return np.asarray(blocks)

    def _assemble(self, local: Vector, columns: Sequence[Array], phase: bool, rho: complex = 1.0) -> csc_matrix:
        """Scaled sparse matrix; without columns of T and p a square (nu, nu) one for the variational equation."""
        from scipy import sparse

        profile, autonomous = self.profile, self.problem.autonomous
        n = profile.n
        places = matrix_places(n, profile.m, profile.intervals, bool(columns), phase, autonomous)
        values = [local.ravel(), *(c.ravel() for c in columns), np.ones(n), np.full(n, -rho)]
        row_units = np.tile(1.0 / self.sizes, places.shape[0] // n + 1)[: places.shape[0]]
        if phase:
            values.append(self._phase_row if autonomous else np.array([1.0, -self._forcing[1]]))
            row_units[-1] = 1.0 / self._phase_size
        scaled = row_units[places.row] * np.concatenate(values) * self.units[places.column]
        inside = (scaled[places.order], places.indices.copy(), places.starts.copy())
        matrix = sparse.csc_matrix(inside, shape=places.shape)
        matrix.eliminate_zeros()
        return matrix

    @property
    def _forcing(self) -> tuple[float, float]:
        period, derivative = forcing_period(self.problem.equations, self._points, self.z)
        return float(period), float(derivative)

    def hessian(self, v: Vector, variational: bool = False) -> csc_matrix:
        """d (J v) / d x for v (nu + 2,) scaled, (nu + 1, nu + 2) sparse.

        Variational: of the matrix of v' = T f_u v, (nu, nu + 2).
        """
        profile, w = self.profile, self._points
        n, m, count = profile.n, profile.m, profile.intervals
        h, period = profile.h, profile.period
        scheme = basis(m)
        raw = v[: self.nu] * self.units[: self.nu]
        by_period = 0.0 if variational else v[self.nu] * self.units[self.nu]
        by_parameter = 0.0 if variational else v[self.nu + 1] * self.units[self.nu + 1]
        at = in_intervals(scheme.values, raw.reshape(-1, n))
        states = np.moveaxis(w.at, -1, 0)
        direction = np.zeros((count, m, n + self.problem.system.p_size), v.dtype)
        direction[:, :, :n] = at
        direction[:, :, n + self.problem.active] = by_parameter
        if not self.problem.autonomous:
            direction[:, :, -1] = by_period * self._times
        second = self._second_derivatives(states, direction)  # (N, m, n, n + p_size)
        first = self._first_derivatives()
        along = np.einsum("icka,ica->ick", first, direction)
        combined = period * second + by_period * first
        local = self._local(combined[:, :, :, :n], -h, False)
        timing = 0.0 if self.problem.autonomous else self._times[:, :, None] * combined[:, :, :, -1]
        column_t = -h[:, None, None] * (along + timing)
        column_p = -h[:, None, None] * combined[:, :, :, n + self.problem.active]
        if variational:
            return self._assemble_second(local, column_t, column_p, self.nu)
        return self._assemble_second(local, column_t, column_p, self.nu + 1, self._bend_of_period * by_parameter)

    @property
    def _bend_of_period(self) -> float:
        """The second derivative of the last row by the parameter: of T - T(p), where the orbit is forced."""
        forcing = self.problem.forcing
        if forcing is None:
            return 0.0
        bend = self.problem.multiple * forcing.second_derivative(self._points.p, self.problem.active)
        return -bend / self._phase_size

    def _assemble_second(
        self, local: Vector, column_t: Vector, column_p: Vector, height: int, corner: float | complex = 0.0
    ) -> csc_matrix:
        """The blocks with two columns beside them, scaled, and below no entry but one, by the parameter."""
        from scipy import sparse

        n, m, count = self.profile.n, self.profile.m, self.profile.intervals
        places = block_places(n, m, count)
        nodes = np.arange(count)[:, None] * m + np.arange(m + 1)
        scaled = local / self.sizes[:, None, None]
        scaled *= self.units[: self.nu].reshape(-1, n)[nodes][:, None, None]
        beside = [
            (c / self.sizes).ravel() * unit for c, unit in zip((column_t, column_p), self.units[-2:], strict=True)
        ]
        long, filled = len(beside[0]), int(places.starts[-1])
        everywhere = np.arange(long, dtype=places.indices.dtype)
        below = int(corner != 0.0)
        inside = (
            np.concatenate([scaled.ravel()[places.order], *beside, np.full(below, corner * self.units[-1])]),
            np.concatenate([places.indices, everywhere, everywhere, np.full(below, height - 1)]),
            np.append(places.starts, [filled + long, filled + 2 * long + below]).astype(places.starts.dtype),
        )
        return sparse.csc_matrix(inside, shape=(height, self.nu + 2))

    def _first_derivatives(self) -> Array:
        """f_z at the Gauss points, (N, m, n, n + p_size); only the columns of u, the active parameter and t."""
        w, n = self._points, self.profile.n
        first = np.zeros((self.profile.intervals, self.profile.m, n, n + self.problem.system.p_size))
        first[:, :, :, :n] = self.state_derivatives
        first[:, :, :, n + self.problem.active] = np.moveaxis(w.fp, -1, 0)
        if not self.problem.autonomous:
            first[:, :, :, -1] = np.moveaxis(w.ft, -1, 0)
        return first

    def _second_derivatives(self, states: Array, direction: Vector) -> Vector:
        """D^2 f[direction, .] at the Gauss points, (N, m, n, n + p_size)."""
        profile, size = self.profile, direction.shape[2]
        p = np.tile(self.problem.full_parameters(self.z), (states.shape[0] * states.shape[1], 1))
        if not self.problem.autonomous:
            p[:, -1] = profile.period * self._times.ravel()
        found = self.problem.system.gradients(states.reshape(-1, profile.n), p, direction.reshape(-1, size))
        return np.asarray(found).reshape(*direction.shape[:2], profile.n, size)

    def variational(self, rho: complex) -> csc_matrix:
        """Scaled (nu, nu) matrix of v' = T f_u v, v(1) = rho v(0)."""
        local = self._variational
        if isinstance(rho, complex):
            local = local.astype(complex)
        return self._assemble(local, [], False, rho)

    @cached_property
    def _variational(self) -> Array:
        return np.asarray(self._local(self.state_derivatives, -self.profile.h * self.profile.period, True))


def branch_tangents(problem: OrbitEquations, z: Array, scale: Array) -> list[Array]:
    """Unit tangents (scaled, like z) of the families through z: one, or at a branch point two."""
    linear = OrbitLinear(problem, z, scale, z)
    jacobian = linear.jacobian
    right, g, left = Bordered.of(jacobian, 2).solve()
    v = np.linalg.qr(right)[0]
    if float(np.linalg.norm(jacobian @ v)) < SINGULAR * float(abs(jacobian).max()):
        tangents = crossing(linear.hessian, v, left[:, 0])
        if tangents:
            return [embed(linear, t) for t in tangents]
    if not np.any(g):
        return [embed(linear, Bordered.of(jacobian, 1).solve()[0][:, 0])]
    return [embed(linear, right @ np.array([g[0, 1], -g[0, 0]]))]  # jacobian @ right = -b g


def embed(linear: OrbitLinear, x: Array) -> Array:
    """A direction in x as one in z (the mesh does not move), of unit length."""
    out = np.zeros(linear.z.size)
    out[linear.unknowns] = x
    return out / float(np.linalg.norm(out))
