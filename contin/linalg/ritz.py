"""An operator in the space of a few vectors, which grows: Ritz values and their weights."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.linear import Linear
from contin.linalg.orthonormal import orthonormal
from contin.linalg.vectors import inner, mixed

FIRST: Final = 12  # rows for which there is memory at first


class RitzSpace:
    """Orthonormal rows (k, n), what A makes of them, and the products of both: A in that space."""

    def __init__(self, linear: Linear, n: int) -> None:
        self.linear, self.size = linear, 0
        self._basis, self._images = np.empty((FIRST, n)), np.empty((FIRST, n))
        self.small = np.zeros((0, 0))

    @classmethod
    def of(cls, linear: Linear, rows: Array) -> RitzSpace:
        """The span of orthonormal rows."""
        made = cls(linear, rows.shape[1])
        made._take(rows)
        return made

    @property
    def basis(self) -> Array:
        return self._basis[: self.size]

    @property
    def images(self) -> Array:
        return self._images[: self.size]

    def widen(self, rows: Array) -> bool:
        """With some more directions; False where there are none, or all vectors are in it."""
        fresh = orthonormal(rows, self.basis) if self.size + len(rows) <= rows.shape[1] else rows[:0]
        self._take(fresh)
        return len(fresh) > 0

    def _take(self, fresh: Array) -> None:
        k, size = self.size, self.size + len(fresh)
        if size > len(self._basis):
            more = np.empty((max(size - k, k), self._basis.shape[1]))
            self._basis, self._images = np.concatenate([self.basis, more]), np.concatenate([self.images, more])
        self._basis[k:size] = fresh
        for row in range(k, size):
            self._images[row] = self.linear.apply(self._basis[row])
        self.size = size
        small = np.empty((size, size))
        small[:k, :k] = self.small
        small[:, k:] = inner(self.basis, self._images[k:size])
        small[k:, :k] = inner(self._basis[k:size], self._images[:k])
        self.small = small

    def rightmost(self, wanted: int, symmetric: bool) -> tuple[Vector, Vector]:
        """Ritz values (wanted,), their weights (wanted, k); where A is symmetric, double ones are no pair."""
        values, ritz = (np.linalg.eigh if symmetric else np.linalg.eig)(self.small)
        order = np.argsort(-values.real, kind="stable")[:wanted]
        return values[order], ritz[:, order].T

    def within(self, given: int, wanted: int) -> tuple[Vector, Vector]:
        """The same of those that lie most in the space of the first `given` rows."""
        values, ritz = np.linalg.eig(self.small)
        order = np.argsort(-np.linalg.norm(ritz[:given], axis=0), kind="stable")[:wanted]
        return values[order], ritz[:, order].T

    def sum_of_residuals(self, values: Array, ritz: Array) -> Array:
        """sum A v - l v of real Ritz pairs, (1, n)."""
        total = mixed(ritz.sum(axis=0)[None], self.images)
        return mixed(-(values @ ritz)[None], self.basis, added_to=total)
