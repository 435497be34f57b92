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
from typing import Any, Self

import numpy as np

from contin.abi import Array
from contin.homoclinic.connection_layout import ConnectionLayout, Gauge
from contin.homoclinic.projections import linearised_projections
from contin.homoclinic.subspaces import left_subspace
from contin.kernels.collocation_basis import basis
from contin.linalg.csc import with_columns, with_rows
from contin.machine import elementary
from contin.problems.orbits.ends.saddle_node import borders
from contin.problems.orbits.linearised.pattern import block_places
from contin.problems.orbits.mesh.layout import Profile, in_intervals


@dataclass(frozen=True, eq=False)
class ConnectionCurve(ConnectionLayout):
    """The unknowns of `ConnectionLayout` and their equations."""

    # -- layout -------------------------------------------------------------------------------------------------------

    # -- equations ----------------------------------------------------------------------------------------------------

    def settled(self, z: Array, sizes: Array) -> Self:
        """The curve with phase reference and bases at z."""
        at_first, at_last = (self.scaled_matrix(self.equilibria(z)[end], z, sizes) for end in (0, -1))
        gauge = Gauge(
            z.copy(),
            left_subspace(at_first, self.stable_count, True),
            left_subspace(at_last, self.unstable_count, False) if self.reversor is None else None,
            borders(at_first) if self.node else None,
            dict(self.chosen.vectors),
        )
        return replace(self, gauge=gauge)

    def linearise(self, z: Array, scale: Array, sizes: Array) -> tuple[Array, Any]:
        """Scaled equations (k,) and their sparse Jacobian (k, k + 1) by `unknowns`."""
        from scipy import sparse

        n, m = self.n, self.orbits.points
        profile = self.profile(z)
        count, nu, period = profile.intervals, profile.u.size, profile.period
        units = self._units(z, scale)
        states, p = self._gauss_states(profile, z)
        f, whole = self.orbits.system.jacobians(states, p)
        fu = whole[:, :, :n].reshape(count, m, n, n)
        slopes = self._by_parameters(whole).reshape(count, m, n, 2)
        scheme = basis(m)
        nodes = np.arange(count)[:, None] * m + np.arange(m + 1)
        h = profile.h
        blocks = -np.einsum("i,cj,ickq->ickjq", h * period, scheme.values, fu)
        blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(n))
        blocks *= (sizes / sizes[:, None])[None, None, :, None, :]
        widths = scale[:nu].reshape(-1, n)[nodes] / sizes  # (N, m + 1, n): metric beside the sizes
        blocks *= widths[:, None, None, :, :]
        places = block_places(n, m, count)
        top = sparse.csc_matrix((blocks.ravel()[places.order], places.indices, places.starts), shape=places.shape)
        by_parameters = -(h * period)[:, None, None, None] * slopes / sizes[:, None]  # (N, m, n, 2): q, p
        beside = np.hstack([np.zeros((nu - n, self.saddles * n)), by_parameters.reshape(-1, 2) * units[-2:]])
        rest, below = self._rest(z, sizes, units)
        if len(self.slots) < 2:
            kept = [*range(len(units) - 2), *(len(units) + slot for slot in self.slots)]
            beside, below = beside[:, [k - nu for k in kept if k >= nu]], below[:, kept]
        jacobian = with_rows(with_columns(top, beside), below)
        return np.concatenate([self._defect(profile, f, sizes), rest]), jacobian

    def _units(self, z: Array, scale: Array) -> Array:
        """The metric of (u, saddles, q, p)."""
        return np.append(scale[: self.nodes(z) + self.saddles * self.n], scale[-2:])

    def _defect(self, profile: Profile, f: Array, sizes: Array) -> Array:
        """What is left of u' = T f; f : (N m, n) at the Gauss points."""
        rates = in_intervals(basis(profile.m).slopes, profile.u)
        step = (profile.h * profile.period)[:, None, None]
        return np.asarray((rates - step * f.reshape(rates.shape)) / sizes).ravel()

    def _gauss_states(self, profile: Profile, z: Array) -> tuple[Array, Array]:
        """States (N m, n) and parameters (N m, k) at the Gauss points."""
        states = in_intervals(basis(profile.m).values, profile.u).reshape(-1, self.n)
        return states, np.tile(self.full_parameters(z), (len(states), 1))

    def _by_parameters(self, jacobian: Array) -> Array:
        """Of derivatives (..., n, n + k) those by q and p; along a homotopy its parameter is not in f."""
        found = jacobian[..., [self.n + self.second, self.n + self.first]]
        if self.aim is not None:
            found[..., 0] = 0.0
        return np.asarray(found)

    def _rest(self, z: Array, sizes: Array, units: Array) -> tuple[Array, Array]:
        """Equilibria, projections and phase, with their dense rows."""
        n, nu = self.n, self.nodes(z)
        values, rows = self._at_saddles(z, units)
        found = linearised_projections(self, z, sizes, units[-2:])
        row = np.zeros((len(found.values), len(units)))
        row[:, :n], row[:, nu - n : nu] = found.by_first, found.by_last
        row[:, nu : nu + self.saddles * n], row[:, -2:] = found.by_saddles, found.by_parameters
        values.append(found.values)
        rows.append(row * units)
        if self.reversor is None:  # else no phase: the half is isolated on the unstable manifold
            gap, row = self._in_phase(z, sizes, units)
            values.append(gap)
            rows.append(row)
        return np.concatenate(values), np.vstack(rows)

    def _at_saddles(self, z: Array, units: Array) -> tuple[list[Array], list[Array]]:
        """f at the saddles with its rows, of length about 1."""
        n, nu = self.n, self.nodes(z)
        p = self.full_parameters(z)
        values, rows = [], []
        for k, u in enumerate(self.equilibria(z)):
            f, whole = self.orbits.system.jacobian(u, p)
            row = np.zeros((n, len(units)))
            row[:, nu + k * n : nu + (k + 1) * n], row[:, -2:] = whole[:, :n], self._by_parameters(whole)
            size = np.maximum(np.abs(row * units).max(axis=1), 1e-300)
            values.append(f / size)
            rows.append(row * units / size[:, None])
        return values, rows

    def _in_phase(self, z: Array, sizes: Array, units: Array) -> tuple[Array, Array]:
        """The phase condition (1,) with its row, of length 1."""
        nu = self.nodes(z)
        phase = self._phase(sizes)
        row = np.zeros((1, len(units)))
        row[0, :nu] = phase * units[:nu]
        size = float(np.linalg.norm(row))
        return np.array([float(phase @ (z[:nu] - self._reference[:nu])) / size]), row / size

    @property
    def _reference(self) -> Array:
        assert self.chosen.reference is not None, "the curve is not settled"
        return self.chosen.reference

    def _phase(self, sizes: Array) -> Array:
        """Weights of the phase condition at the nodes, (nu,)."""
        old = self.profile(self._reference)
        scheme, m = basis(old.m), old.m
        nodes = np.arange(old.intervals)[:, None] * m + np.arange(m + 1)
        along = np.einsum("c,cj,cq->jq", scheme.gauss_weights, scheme.values, scheme.slopes)
        local = np.einsum("jq,iqk->ijk", along, old.u[nodes]) / elementary.square(sizes)
        row = np.zeros_like(old.u)
        row[nodes[:, :-1]] = local[:, :-1]
        row[nodes[:, -1]] += local[:, -1]
        return row.ravel()
