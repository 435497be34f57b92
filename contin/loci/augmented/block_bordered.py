"""[F'; g'; B] of singular solutions by the factors of their own bordered matrix, with one small matrix besides.

    N [x; s] + [Q; 0] q = [r; c],   N = [M b; C^T 0]

Folds: M = F_x, q all parameters, s = 0. Branch points: M = [F_x F_s], s = beta of the unfolding F + beta b = 0, q the
parameters but s. What is left are the rows of s = 0 (folds), g' and B in the unknowns (c, q). (Govaerts 2000, ch. 3.)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.augmented.singular import Singular


@dataclass(frozen=True, eq=False)
class BlockBordered:
    """A `contin.loci.augmented.elimination.Bordered`, at the places `where` of z; what stands still has zeros.

    residual : of F and g, then a zero for every unknown that stands still.  found : the scalars, with their gradient
    by (u, [unfolding], parameters).  columns : F_p (n, k).  rows : B, in the same unknowns.
    """

    residual: Array
    found: Singular
    columns: Array
    rows: Array
    where: NDArray[np.intp]
    size: int

    @property
    def form(self) -> Array | None:
        """Of branch points, see `contin.loci.augmented.singular.Singular`."""
        return self.found.form

    @property
    def _n(self) -> int:
        return len(self.columns)

    @property
    def _branching(self) -> bool:
        return len(self.found.right) > self._n

    @cached_property
    def _below(self) -> Array:
        """g' and B."""
        return np.vstack([self.found.gradient, self.rows])

    @cached_property
    def _beside(self) -> Array:
        """Solutions of N x = [Q; 0], (n + .., q)."""
        columns = self.columns[:, :-1] if self._branching else self.columns
        right = np.vstack([columns, np.zeros((self.found.right.shape[1], columns.shape[1]))])
        solved = [self.found.factors.solve(column) for column in right.T]
        return np.column_stack(solved) if solved else right

    def _unknowns(self, x: Array, q: Array) -> Array:
        """(u, [unfolding], parameters) of a solution x of N's and the remaining parameters q."""
        n = self._n
        if self._branching:
            return np.concatenate([x[:n], x[n + 1 :], q, x[n : n + 1]])
        return np.concatenate([x[:n], q])

    def _left(self, x: Array, q: Array) -> Array:
        """What the remaining rows make of it."""
        own = self._below @ self._unknowns(x, q)
        return own if self._branching else np.append(x[self._n :], own)

    @cached_property
    def _small(self) -> Array:
        """Columns of c, then of q."""
        free = self._beside.shape[1]
        null = np.vstack([self.found.right, self.found.values[None]])
        slopes = [self._left(x, np.zeros(free)) for x in null.T]
        slopes += [self._left(-x, unit) for x, unit in zip(self._beside.T, np.eye(free, dtype=float), strict=True)]
        return np.column_stack(slopes)

    @cached_property
    def _determinant(self) -> tuple[float, float]:
        if not np.all(np.isfinite(self._small)):
            return 0.0, 0.0
        sign, size = np.linalg.slogdet(self._small)
        moved = -1.0 if self._branching and self.columns.shape[1] % 2 else 1.0  # the last parameter's column
        return moved * float(sign), float(size)

    @property
    def is_singular(self) -> bool:
        return self.found.factors.is_singular or self._determinant[0] == 0.0

    @property
    def sign(self) -> float:
        return self.found.factors.sign * self._determinant[0]

    @property
    def log_determinant(self) -> float:
        return self.found.factors.log_determinant + self._determinant[1] if self.sign != 0.0 else 0.0

    def solve(self, right: Array) -> Array:
        n, still = self._n, self.size - len(self.where)
        top, below = right[:n], np.append(right[n : len(self.residual) - still], right[len(self.residual) :])
        factors, count, free = self.found.factors, self.found.right.shape[1], self._beside.shape[1]
        begun = np.zeros(n + count)
        if np.any(top):
            begun = factors.solve(np.append(top, np.zeros(count)))
        wanted = below if self._branching else np.append(0.0, below)
        x = np.zeros(self.size)
        try:
            c = np.linalg.solve(self._small, wanted - self._left(begun, np.zeros(free)))
        except np.linalg.LinAlgError:  # singular: the corrector fails, in words
            x[self.where] = np.nan
            return x
        null = np.vstack([self.found.right, self.found.values[None]])
        q = np.asarray(c[count:], dtype=float)
        x[self.where] = self._unknowns(begun + null @ c[:count] - self._beside @ q, q)
        return x
