"""The collocation equations' derivatives on one mesh, by intervals: as a sparse matrix, with borders, or transposed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.bvp.pattern import assembled
from contin.kernels.collocation_basis import basis
from contin.linalg.borders import below

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


@dataclass(frozen=True, eq=False)
class Collocated:
    """F (size,) and F' = [F_x, F_q] at y = (u, q) / scale; F = slopes u - h f at the Gauss points, then g.

    fu (N, m, n, n), fq (N, m, n, k) derivatives of f at the Gauss points; ends (n, 2 n), ends_q (n, k) those of g;
    scale (size + k,), by which columns are multiplied.
    """

    residual: Array
    h: Array
    fu: Array
    fq: Array
    ends: Array
    ends_q: Array
    scale: Array

    @property
    def size(self) -> int:
        """Number of equations, and of node values."""
        return len(self.residual)

    @property
    def _n(self) -> int:
        return len(self.ends)

    @cached_property
    def columns(self) -> Array:
        """F_q (size, k)."""
        local = -self.h[:, None, None, None] * self.fq
        return np.vstack([local.reshape(-1, self.fq.shape[-1]), self.ends_q]) * self.scale[self.size :]

    @cached_property
    def _parts(self) -> tuple[Array, Array]:
        """Blocks by interval, and the conditions'."""
        n, count, m = self._n, len(self.h), self.fu.shape[1]
        scheme = basis(m)
        blocks = -np.einsum("i,cj,ickq->ickjq", self.h, scheme.values, self.fu)
        blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(n))
        sizes = self.scale[: self.size].reshape(-1, n)
        places = np.arange(count)[:, None] * m + np.arange(m + 1)
        return blocks * sizes[places][:, None, None], self.ends * np.concatenate([sizes[0], sizes[-1]])

    @cached_property
    def slope(self) -> csc_matrix:
        """F_x."""
        return self.with_borders(np.empty((self.size, 0)), np.empty((0, self.size)))

    def with_borders(self, beside: Array, below: Array) -> csc_matrix:
        """[F_x beside; below]"""
        return assembled(*self._parts, beside, below)

    def pulled(self, w: Array) -> Array:
        """w^T F' (size + k,), w (size,)."""
        n, count, m = self._n, len(self.h), self.fu.shape[1]
        scheme, found = basis(m), np.zeros(self.size + self.fq.shape[-1])
        local, last = w[:-n].reshape(count, m, n), w[-n:]
        weighed = -self.h[:, None, None] * local
        nodes = np.einsum("icq,cj->ijq", np.einsum("ick,ickq->icq", weighed, self.fu), scheme.values)
        nodes += np.einsum("ick,cj->ijk", local, scheme.slopes)
        u = found[: self.size].reshape(-1, n)
        u[:-1] = nodes[:, :-1].reshape(-1, n)
        u[m::m] += nodes[:, -1]
        u[0] += last @ self.ends[:, :n]
        u[-1] += last @ self.ends[:, n:]
        found[self.size :] = np.einsum("ick,ickq->q", weighed, self.fq) + last @ self.ends_q
        return found * self.scale

    def critical(self, branching: bool) -> Critical:
        """F_x, or [F_x, F_s] with the column of the last parameter where branch points are meant."""
        return Critical(self, branching)


@dataclass(frozen=True, eq=False)
class Critical:
    """M, which is singular at folds, or has a kernel of two dimensions at branch points."""

    whole: Collocated
    branching: bool

    @property
    def shape(self) -> tuple[int, int]:
        return self.whole.size, self.whole.size + self.branching

    def bordered(self, columns: Array, rows: Array) -> csc_matrix:
        """[M columns; rows^T 0]"""
        beside = np.hstack([self.whole.columns[:, -1:], columns]) if self.branching else columns
        return self.whole.with_borders(beside, below(columns, rows))
