"""The equations of a connecting orbit between saddles in two parameters.

    u' = T f(u, p, q) on [0, 1],   f(x0) = 0,  f(x1) = 0  (x1 = x0 for a homoclinic orbit)
    L_s(x0)^T (u(0) - x0) = 0      the orbit starts in the unstable eigenspace of x0
    L_u(x1)^T (u(1) - x1) = 0      and ends in the stable eigenspace of x1
    sum of weights * <u - reference, reference'> = 0

with L_s, L_u bases of the left stable and unstable subspaces (Beyn 1990; Champneys, Kuznetsov and Sandstede 1996). The
length T of the time interval is fixed: the error is of the order of the squared distances of the ends from the saddles.
Where x0 = x1 is a saddle-node, one eigenvalue is zero, there is one projection less, and the fold takes its place: the
orbit leaves along the centre-unstable directions and arrives along the centre-stable ones.
z = (u at the nodes, x0, [x1], T, h_1 .. h_N, q, p); T and the mesh are carried along, not solved for. Which of q and p
are unknowns is said by `slots`: with one projection less (n + 1 directions in which the orbit may leave and arrive)
connections persist, and q is not one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.homoclinic.connection_layout import ConnectionLayout
from contin.homoclinic.projections import linearised_projections
from contin.homoclinic.subspaces import left_subspace
from contin.kernels.collocation_basis import basis
from contin.machine import elementary
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.ends.saddle_node import borders
from contin.problems.orbits.mesh.layout import Profile


@dataclass(frozen=True, eq=False)
class ConnectionCurve(ConnectionLayout):
    """The unknowns of `ConnectionLayout` and their equations."""

    # -- layout -------------------------------------------------------------------------------------------------------

    # -- equations ----------------------------------------------------------------------------------------------------

    def settle(self, z: Array, sizes: Array) -> None:
        """Phase reference and bases at z."""
        first, last = self.equilibria(z)[0], self.equilibria(z)[-1]
        self.gauge.reference = z.copy()
        self.gauge.stable = left_subspace(self.scaled_matrix(first, z, sizes), self.stable_count, True)
        if self.reversor is None:
            self.gauge.unstable = left_subspace(self.scaled_matrix(last, z, sizes), self.unstable_count, False)
        if self.node:
            self.gauge.borders = borders(self.scaled_matrix(first, z, sizes))

    def linearise(self, z: Array, scale: Array, sizes: Array) -> tuple[Array, Any]:
        """Scaled equations (k,) and their sparse Jacobian (k, k + 1) by `unknowns`."""
        from scipy import sparse

        n, m = self.n, self.orbits.points
        profile, ends = self.profile(z), self.equilibria(z)
        count, nu, period = profile.intervals, profile.u.size, profile.period
        units = np.append(scale[: nu + self.saddles * n], scale[-2:])
        f, fu, slopes = self._at_gauss(profile, z)
        scheme = basis(m)
        nodes = np.arange(count)[:, None] * m + np.arange(m + 1)
        h = profile.h
        rates = np.einsum("cj,ijk->ick", scheme.slopes, profile.u[nodes])
        defect = (rates - (h * period)[:, None, None] * f) / sizes
        blocks = -np.einsum("i,cj,ickq->ickjq", h * period, scheme.values, fu)
        blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(n))
        blocks *= (sizes / sizes[:, None])[None, None, :, None, :]
        widths = scale[:nu].reshape(-1, n)[nodes] / sizes  # (N, m + 1, n): metric beside the sizes
        blocks *= widths[:, None, None, :, :]
        i, r, c = np.meshgrid(np.arange(count), np.arange(m * n), np.arange((m + 1) * n), indexing="ij")
        total = nu + self.saddles * n + 2
        top = sparse.coo_matrix(
            (blocks.ravel(), ((i * m * n + r).ravel(), (i * m * n + c).ravel())), shape=(count * m * n, total)
        )
        by_parameters = -(h * period)[:, None, None, None] * slopes / sizes[:, None]  # (N, m, n, 2): q, p
        columns = sparse.csr_matrix(by_parameters.reshape(-1, 2) * units[-2:])
        top = top.tocsr() + sparse.hstack([sparse.csr_matrix((count * m * n, total - 2)), columns]).tocsr()
        rest, dense = self._rest(z, profile, ends, sizes, units)
        jacobian = sparse.vstack([top, sparse.csr_matrix(dense)], format="csc")
        if len(self.slots) < 2:
            jacobian = jacobian[:, [*range(total - 2), *(total + slot for slot in self.slots)]]
        return np.concatenate([defect.ravel(), rest]), jacobian

    def _at_gauss(self, profile: Profile, z: Array) -> tuple[Array, Array, Array]:
        """f (N, m, n), f_u (N, m, n, n) and by (q, p) (N, m, n, 2) at the Gauss points."""
        n, m, count = self.n, profile.m, profile.intervals
        nodes = np.arange(count)[:, None] * m + np.arange(m + 1)
        states = np.einsum("cj,ijk->ick", basis(m).values, profile.u[nodes]).reshape(-1, n)
        p = self.full_parameters(z)
        system = self.orbits.system
        f, whole = system.jacobians(np.ascontiguousarray(states), np.tile(p, (len(states), 1)))
        jacobian = whole[:, :, [*range(n), n + self.second, n + self.first]]
        if self.aim is not None:
            jacobian[:, :, n] = 0.0
        shape = (count, m, n)
        return f.reshape(shape), jacobian[:, :, :n].reshape(*shape, n), jacobian[:, :, n:].reshape(*shape, 2)

    def _rest(self, z: Array, profile: Profile, ends: Array, sizes: Array, units: Array) -> tuple[Array, Array]:
        """Equilibria, projections and phase, with their dense rows."""
        n, nu = self.n, profile.u.size
        total = len(units)
        p = self.full_parameters(z)
        values, rows = [], []
        for k, u in enumerate(ends):
            f, whole = self.orbits.system.jacobian(u, p)
            row = np.zeros((n, total))
            row[:, nu + k * n : nu + (k + 1) * n] = whole[:, :n]
            row[:, -2:] = whole[:, [n + self.second, n + self.first]]
            if self.aim is not None:
                row[:, -2] = 0.0
            size = np.maximum(np.abs(row * units).max(axis=1), 1e-300)
            values.append(f / size)
            rows.append(row * units / size[:, None])
        found = linearised_projections(self, z, sizes, units[-2:])
        row = np.zeros((len(found.values), total))
        row[:, :n], row[:, nu - n : nu] = found.by_first, found.by_last
        row[:, nu : nu + self.saddles * n], row[:, -2:] = found.by_saddles, found.by_parameters
        values.append(found.values)
        rows.append(row * units)
        if self.reversor is not None:  # no phase: the half is isolated on the unstable manifold
            return np.concatenate(values), np.vstack(rows)
        phase = self._phase(z, sizes)
        gap = float(phase @ (z[:nu] - self.gauge.reference[:nu]))  # type: ignore[index]
        row = np.zeros((1, total))
        row[0, :nu] = phase * units[:nu]
        size = float(np.linalg.norm(row))
        values.append(np.array([gap / size]))
        rows.append(row / size)
        return np.concatenate(values), np.vstack(rows)

    def _phase(self, z: Array, sizes: Array) -> Array:
        """Weights of the phase condition at the nodes, (nu,)."""
        assert self.gauge.reference is not None
        old = self.profile(self.gauge.reference)
        scheme, m = basis(old.m), old.m
        nodes = np.arange(old.intervals)[:, None] * m + np.arange(m + 1)
        local = np.einsum("c,cj,cq,iqk->ijk", scheme.gauss_weights, scheme.values, scheme.slopes, old.u[nodes])
        row = np.zeros_like(old.u)
        np.add.at(row, nodes, local / elementary.square(sizes))
        return row.ravel()

    def at(self, z: Array) -> OrbitProblem:
        """The problem of periodic orbits with q at its value in z."""
        base = self.orbits.base.copy()
        base[self.second] = z[-2]
        return replace(self.orbits, base=base)
