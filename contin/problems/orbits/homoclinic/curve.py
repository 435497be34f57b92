"""The equations of a connecting orbit between saddles in two parameters.

    u' = T f(u, p, q) on [0, 1],   f(x0) = 0,  f(x1) = 0  (x1 = x0 for a homoclinic orbit)
    L_s(x0)^T (u(0) - x0) = 0      the orbit starts in the unstable eigenspace of x0
    L_u(x1)^T (u(1) - x1) = 0      and ends in the stable eigenspace of x1
    sum of weights * <u - reference, reference'> = 0

with L_s, L_u bases of the left stable and unstable subspaces (Beyn 1990; Champneys, Kuznetsov and Sandstede 1996). The
length T of the time interval is fixed: the error is of the order of the squared distances of the ends from the saddles.
Where x0 = x1 is a saddle-node, one eigenvalue is zero, there is one projection less, and the fold takes its place: the
orbit leaves along the centre-unstable directions and arrives along the centre-stable ones.
z = (u at the nodes, x0, [x1], T, h_1 .. h_N, q, p); T and the mesh are carried along, not solved for.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation_basis import basis
from contin.machine import elementary
from contin.problems.orbits.homoclinic.subspaces import left_subspace
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.orbits.saddle_node import borders, fold_scalar
from contin.problems.orbits.two_parameters import CurveOfOrbits

STEP = 1e-6  # of the differences of the projections, relative


@dataclass(eq=False)
class Gauge:
    """What is kept from one chunk to the next: phase reference, bases, and vectors that signs refer to."""

    reference: Array | None = None
    stable: Array | None = None
    unstable: Array | None = None
    borders: tuple[Array, Array] | None = None  # of the matrix at a saddle-node
    vectors: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ConnectionCurve(CurveOfOrbits):
    """`orbits` gives the equations, with the first parameter free; counts: stable directions of x0, unstable of x1.

    They add up to n, at a saddle-node (`node`) to n - 1.  winding : whole turns of angles, by which u(1) is farther.
    """

    orbits: OrbitProblem
    second: int
    saddles: int  # 1 homoclinic, 2 heteroclinic
    stable_count: int
    unstable_count: int
    node: bool = False
    winding: Array | None = None
    gauge: Gauge = field(default_factory=Gauge)

    type = "HOM"

    @property
    def n(self) -> int:
        return self.orbits.n

    # -- layout -------------------------------------------------------------------------------------------------------

    def join(self, profile: Profile, saddles: Array, q: float) -> Array:
        return np.concatenate([profile.u.ravel(), saddles.ravel(), [profile.period], profile.h, [q, profile.parameter]])

    def intervals(self, z: Array) -> int:
        return int((z.size - self.n * (1 + self.saddles) - 3) // (self.orbits.points * self.n + 1))

    def nodes(self, z: Array) -> int:
        """Number of node values."""
        return (self.intervals(z) * self.orbits.points + 1) * self.n

    def profile(self, z: Array) -> Profile:
        nu, count = self.nodes(z), self.intervals(z)
        place = nu + self.saddles * self.n
        u = z[:nu].reshape(-1, self.n)
        return Profile(self.orbits.points, u, float(z[place]), z[place + 1 : place + 1 + count], float(z[-1]))

    def equilibria(self, z: Array) -> Array:
        """(1 or 2, n)"""
        nu = self.nodes(z)
        return z[nu : nu + self.saddles * self.n].reshape(self.saddles, self.n)

    def termini(self, z: Array) -> tuple[Array, Array]:
        """Where the orbit comes from and where it goes to, both (n,)."""
        ends = self.equilibria(z)
        return ends[0], ends[-1] if self.winding is None else ends[-1] + self.winding

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, saddles, q, p) in z."""
        return np.append(np.arange(self.nodes(z) + self.saddles * self.n), [z.size - 2, z.size - 1])

    def full_parameters(self, z: Array) -> Array:
        p = self.orbits.full_parameters(z)
        p[self.second] = z[-2]
        return p

    def matrix(self, u: Array, z: Array) -> Array:
        """f_u at a state."""
        return np.asarray(self.orbits.system.jacobian(u, self.full_parameters(z))[1][:, : self.n])

    # -- equations ----------------------------------------------------------------------------------------------------

    def settle(self, z: Array, sizes: Array) -> None:
        """Phase reference and bases at z."""
        first, last = self.equilibria(z)[0], self.equilibria(z)[-1]
        self.gauge.reference = z.copy()
        self.gauge.stable = self._basis(first, z, sizes, True, None)
        self.gauge.unstable = self._basis(last, z, sizes, False, None)
        if self.node:
            self.gauge.borders = borders(self.scaled_matrix(first, z, sizes))

    def scaled_matrix(self, u: Array, z: Array, sizes: Array) -> Array:
        """f_u at a state, of states relative to their sizes."""
        return np.asarray(self.matrix(u, z) * sizes / sizes[:, None])

    def _basis(self, u: Array, z: Array, sizes: Array, stable: bool, reference: Array | None) -> Array:
        matrix = self.scaled_matrix(u, z, sizes)
        return left_subspace(matrix, self.stable_count if stable else self.unstable_count, stable, reference)

    def offsets(self, z: Array, sizes: Array) -> tuple[Array, Array]:
        """Of both ends of the orbit from the saddles, relative to the states' sizes."""
        u, (first, last) = z[: self.nodes(z)], self.termini(z)
        return (u[: self.n] - first) / sizes, (u[-self.n :] - last) / sizes

    def projections(self, z: Array, sizes: Array) -> Array:
        """The n boundary conditions (scaled); at a saddle-node the last one is its fold."""
        ends = self.equilibria(z)
        start, finish = self.offsets(z, sizes)
        stable = self._basis(ends[0], z, sizes, True, self.gauge.stable)
        unstable = self._basis(ends[-1], z, sizes, False, self.gauge.unstable)
        conditions = [stable.T @ start, unstable.T @ finish]
        if self.node:
            assert self.gauge.borders is not None
            conditions.append(np.array([fold_scalar(self.scaled_matrix(ends[0], z, sizes), *self.gauge.borders)]))
        return np.concatenate(conditions)

    def linearise(self, z: Array, scale: Array, sizes: Array) -> tuple[Array, Any]:
        """Scaled equations (k,) and their sparse Jacobian (k, k + 1) by `unknowns`."""
        from scipy import sparse

        n, m = self.n, self.orbits.points
        profile, ends = self.profile(z), self.equilibria(z)
        count, nu, period = profile.intervals, profile.u.size, profile.period
        where = self.unknowns(z)
        units = scale[where]
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
        return np.concatenate([defect.ravel(), rest]), sparse.vstack([top, sparse.csr_matrix(dense)], format="csc")

    def _at_gauss(self, profile: Profile, z: Array) -> tuple[Array, Array, Array]:
        """f (N, m, n), f_u (N, m, n, n) and by (q, p) (N, m, n, 2) at the Gauss points."""
        n, m, count = self.n, profile.m, profile.intervals
        nodes = np.arange(count)[:, None] * m + np.arange(m + 1)
        states = np.einsum("cj,ijk->ick", basis(m).values, profile.u[nodes]).reshape(-1, n)
        p = self.full_parameters(z)
        system = self.orbits.system
        f, jacobian = np.empty((len(states), n)), np.empty((len(states), n, n + 2))
        chosen = [*range(n), n + self.second, n + self.first]
        for k, u in enumerate(states):
            f[k], whole = system.jacobian(u, p)
            jacobian[k] = whole[:, chosen]
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
            size = np.maximum(np.abs(row * units).max(axis=1), 1e-300)
            values.append(f / size)
            rows.append(row * units / size[:, None])
        values.append(self.projections(z, sizes))
        row = np.zeros((n, total))
        row[: self.stable_count, :n] = self._basis(ends[0], z, sizes, True, self.gauge.stable).T / sizes
        arriving = slice(self.stable_count, self.stable_count + self.unstable_count)
        row[arriving, nu - n : nu] = self._basis(ends[-1], z, sizes, False, self.gauge.unstable).T / sizes
        small = [*range(nu, nu + self.saddles * n), total - 2, total - 1]
        where = self.unknowns(z)
        for column in small:
            step = STEP * float(sizes[column % n] if column < total - 2 else units[column])
            plus, minus = z.copy(), z.copy()
            plus[where[column]] += step
            minus[where[column]] -= step
            row[:, column] = (self.projections(plus, sizes) - self.projections(minus, sizes)) / (2.0 * step)
        rows.append(row * units)
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
