"""Factors of a matrix whose rows and columns are scaled to like sizes first, so that units do not choose the pivots.

Rows and columns are divided by the roots of their largest entries, again and again (Ruiz, A scaling algorithm to
equilibrate both rows and columns norms in matrices, RAL-TR-2001-034), by powers of two, which round nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.linalg.factor import Factor, Factoriser

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

SWEEPS: Final = 20  # each halves the logarithms of what is left
ALIKE: Final = 2.0  # ... until no factor is larger


@dataclass(eq=False)
class Balanced:
    """diag(rows) A diag(columns) is factored; a `Factor` of A."""

    inner: Factor
    rows: Array
    columns: Array

    @property
    def sign(self) -> float:
        return self.inner.sign

    @classmethod
    def of(cls, matrix: csc_matrix, factoriser: Factoriser) -> Balanced:
        """Cost beside the factors: some passes over the entries."""
        place, by_row, first = factoriser.places(matrix)
        rows, columns = np.ones(matrix.shape[0]), np.ones(matrix.shape[1])
        sizes = np.abs(matrix.data)
        for _ in range(SWEEPS):
            left = sizes * rows[matrix.indices] * columns[place]
            row_factors = _inverse_roots(_largest(left[by_row], first))
            column_factors = _inverse_roots(_largest(left, matrix.indptr))
            rows *= row_factors
            columns *= column_factors
            if max(_spread(row_factors), _spread(column_factors)) <= ALIKE:
                break
        scaled = matrix.copy()
        scaled.data = matrix.data * rows[matrix.indices] * columns[place]
        return cls(factoriser.factor(scaled), rows, columns)

    def solve(self, right: Vector) -> Vector:
        """One right-hand side, or the columns of several."""
        return np.asarray((self.columns * self.inner.solve((self.rows * right.T).T).T).T)

    def solve_transposed(self, right: Vector) -> Vector:
        return np.asarray((self.rows * self.inner.solve_transposed((self.columns * right.T).T).T).T)


def _largest(values: Array, first: NDArray[np.intp]) -> Array:
    """The largest of every group of values, the k-th from first[k] to first[k + 1]; 0 of an empty one."""
    found = np.zeros(len(first) - 1)
    filled = np.diff(first) > 0
    if filled.any():  # an empty group would be given the value that follows it
        found[filled] = np.maximum.reduceat(values, first[:-1][filled])
    return found


def _inverse_roots(sizes: Array) -> Array:
    """The powers of two next to 1 / sqrt(sizes); 1 for rows of zeros, and what is not finite."""
    known = (sizes > 0.0) & np.isfinite(sizes)
    exponents = np.frexp(np.where(known, sizes, 1.0))[1]
    return np.where(known, np.ldexp(1.0, -(exponents // 2)), 1.0)


def _spread(factors: Array) -> float:
    return float(max(factors.max(initial=1.0), 1.0 / factors.min(initial=1.0)))
