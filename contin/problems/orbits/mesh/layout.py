"""How an orbit is stored in one vector z: node values, period, mesh, parameter; and what is read off it.

z = (u at the N m + 1 nodes, T, h_1 .. h_N, p). The interval lengths are part of z, so every point of a branch knows its
own mesh and the engine needs to know of none. Rows of a finished branch are padded with NaN on the left to a common
length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation_basis import basis, interpolation

HOPF_INTERVALS = 20  # a small cycle is a sine


@dataclass(frozen=True, eq=False)
class Profile:
    """An orbit: values u (N m + 1, n) at the nodes of a mesh with interval lengths h (N,), over the scaled time
    [0, 1].
    """

    m: int
    u: Array
    period: float
    h: Array
    parameter: float

    @property
    def n(self) -> int:
        return int(self.u.shape[1])

    @property
    def intervals(self) -> int:
        return len(self.h)

    @property
    def mesh(self) -> Array:
        """Ends of the intervals, (N + 1,), from 0 to 1."""
        return np.concatenate([[0.0], np.cumsum(self.h)])

    @property
    def times(self) -> Array:
        """Scaled times of the nodes, (N m + 1,)."""
        return node_times(self.h, self.m)

    @property
    def gauss_times(self) -> Array:
        """Scaled times of the collocation points, (N m,)."""
        ends = np.cumsum(self.h)
        return np.asarray((self.h[:, None] * basis(self.m).gauss + (ends - self.h)[:, None]).ravel())

    @property
    def weights(self) -> Array:
        """Quadrature weights of the nodes, (N m + 1,), sum 1."""
        return node_weights(self.h, self.m)

    def vector(self) -> Array:
        """z."""
        return np.concatenate([self.u.ravel(), [self.period], self.h, [self.parameter]])

    def at(self, times: Array) -> Array:
        """Values at scaled times in [0, 1], (len(times), n)."""
        return Transfer.to_times(self.m, self.h, times)(self.u)

    def on_mesh(self, h: Array) -> Profile:
        """The same orbit on another mesh (interpolated)."""
        return Profile(self.m, Transfer.to_mesh(self.m, self.h, h)(self.u), self.period, h, self.parameter)


@dataclass(frozen=True, eq=False)
class Transfer:
    """Interpolation of functions on one mesh; the same for all of them, so it is worth keeping for several."""

    nodes: NDArray[np.intp]  # (K, m + 1) nodes of the interval in which each of the K times lies
    weights: Array  # (K, m + 1)

    @classmethod
    def to_times(cls, m: int, h: Array, times: Array) -> Transfer:
        """From the nodes of the mesh h to scaled times in [0, 1]."""
        mesh = np.concatenate([[0.0], np.cumsum(h)])
        i = np.clip(np.searchsorted(mesh, times, side="right") - 1, 0, len(h) - 1)
        local = np.clip((times - mesh[i]) / h[i], 0.0, 1.0)
        return cls(i[:, None] * m + np.arange(m + 1), interpolation(m, local))

    @classmethod
    def to_mesh(cls, m: int, h: Array, other: Array) -> Transfer:
        """From the nodes of the mesh h to those of another one."""
        return cls.to_times(m, h, node_times(other, m))

    def __call__(self, u: Array) -> Array:
        """(K, k) from values (N m + 1, k) at the nodes."""
        return np.asarray(np.einsum("tj,tjk->tk", self.weights, u.take(self.nodes, axis=0)))


def node_times(h: Array, m: int) -> Array:
    """Scaled times of all nodes, (N m + 1,)."""
    out = np.empty(len(h) * m + 1)
    ends = np.cumsum(h)
    out[:-1] = (h[:, None] * basis(m).nodes[:-1] + (ends - h)[:, None]).ravel()
    out[-1] = 1.0
    return out


def node_weights(h: Array, m: int) -> Array:
    """Weights of all nodes for integrals over [0, 1]."""
    weights = np.zeros(len(h) * m + 1)
    local = h[:, None] * basis(m).node_weights
    weights[:-1] = local[:, :-1].ravel()
    weights[m::m] += local[:, -1]
    return weights


def in_intervals(matrix: Array, u: Array) -> Array:
    """(N, c, k): in every interval what a matrix (c, m + 1) of the scheme makes of values (N m + 1, k) at its nodes."""
    c, nodes, k = len(matrix), matrix.shape[1], u.shape[1]
    places = np.arange(nodes)[:, None] + (nodes - 1) * np.arange((len(u) - 1) // (nodes - 1))
    found = np.einsum("cj,jx->cx", matrix, u.take(places, axis=0).reshape(nodes, -1))  # long rows: sums of few are slow
    return np.ascontiguousarray(found.reshape(c, -1, k).transpose(1, 0, 2))


def of_one_mesh(one: Profile, other: Profile) -> bool:
    return len(one.h) == len(other.h) and bool(np.all(one.h == other.h))


def at_places(m: int, u: Array, h: Array, count: int) -> Array:
    """Values (count, k) at equally spaced scaled times, both ends among them, of u at the nodes of the mesh h."""
    return _to_places(m, h.tobytes(), count)(u)


@lru_cache(maxsize=64)  # rows in turn have the same mesh, and tangents are asked after all rows
def _to_places(m: int, mesh: bytes, count: int) -> Transfer:
    return Transfer.to_times(m, np.frombuffer(mesh), np.linspace(0.0, 1.0, count))


def rows_at_places(m: int, n: int, z: Array, values: Array, count: int) -> Array:
    """(K, count, n) of the functions, and (K, count, 1) of the period beside them, of rows z and values like them."""
    sizes, padded = np.full(len(z), z.shape[1]), np.isnan(z[:, 0])
    sizes[padded] -= np.isnan(z[padded]).sum(axis=1)
    intervals = (sizes - n - 2) // (m * n + 1)
    out, same = np.empty((len(z), count, n + 1)), np.append(sizes[1:] == sizes[:-1], False)
    for number in np.unique(intervals).tolist():
        rows = np.flatnonzero(same & (intervals == number))
        same[rows] = np.all(z[rows, -1 - number : -1] == z[rows + 1, -1 - number : -1], axis=1)
    first = 0
    for row in (np.flatnonzero(~same) + 1).tolist():
        number, part = int(intervals[first]), values[first:row, -int(sizes[first]) :]
        transfer = _to_places(m, np.ascontiguousarray(z[first, -1 - number : -1]).tobytes(), count)
        places = (n * transfer.nodes[:, :, None] + np.arange(n)).transpose(1, 0, 2).reshape(m + 1, -1)
        terms = zip(np.repeat(transfer.weights.T, n, axis=1), places, strict=True)
        out[first:row, :, :n] = sum(weight * part[:, at] for weight, at in terms).reshape(row - first, count, n)
        out[first:row, :, n] = part[:, (number * m + 1) * n, None]
        first = row
    return out


def trimmed(z: Array) -> Array:
    """A row without the padding (NaN) on its left, which rows on coarser meshes have."""
    first = float(z[0])
    return z[int(np.argmax(~np.isnan(z))) :] if first != first else z


def profile_of(z: Array, n: int, m: int) -> Profile:
    """Read z (padded, perhaps)."""
    z = trimmed(z)
    intervals = (z.size - n - 2) // (m * n + 1)
    nodes = (intervals * m + 1) * n
    return Profile(m, z[:nodes].reshape(-1, n), float(z[nodes]), z[nodes + 1 : -1], float(z[-1]))


def make_scale(h: Array, m: int, sizes: Array, period: float, parameter: float) -> Array:
    """The metric, in which z has the length^2 <(u / sizes)^2> + (T / period)^2 + (p / parameter)^2.

    z / scale has this Euclidean length; <> is the mean over time and states.
    """
    n = len(sizes)
    nodes = np.sqrt(n) * sizes[None, :] / np.sqrt(node_weights(h, m))[:, None]
    return np.concatenate([nodes.ravel(), [period], np.ones(len(h)), [parameter]])


def sizes_of(scale: Array, h: Array, n: int, m: int) -> Array:
    """The states' sizes that `make_scale` was given."""
    return np.asarray(scale[:n] * np.sqrt(h[0] * basis(m).node_weights[0] / n))
