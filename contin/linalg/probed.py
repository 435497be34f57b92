"""The matrix of an operator that is known by products alone, from few of them where most of its entries are zero.

One set of n products finds where entries are; later matrices take a product for each set of columns that have no row in
common. A further product with a random vector tells whether entries have appeared elsewhere: then n products find them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.colouring import colour_columns
from contin.linalg.csc import filled

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

Product = Callable[[Array], Array]

LARGEST_FULL: Final = 1000  # unknowns up to which matrices take n products where they are full
LARGEST: Final = 5000  # unknowns up to which n products look for zeros
FULL: Final = 0.25  # part of entries that are not zero from which a matrix is full
ROUNDED: Final = 1e-12  # part of a row that may be off by rounding; what differences make is learned
SMALL: Final = 1e-4  # rows that are a smaller part of the largest one are looked at beside that part
NOISE: Final = 4.0  # times what was off where no entry was missing
BLOCK: Final = 200  # columns that are kept full at a time


class ProbedMatrix:
    """Matrices of one operator at different points. `sizes` of the unknowns scale what it is multiplied with."""

    def __init__(self, n: int) -> None:
        self.n = n
        self._pattern: csc_matrix | None = None
        self._columns = self._colours = np.zeros(0, np.int64)
        self._count = 0
        self._full = False
        self._noise = ROUNDED
        self._test = np.random.default_rng(23).uniform(0.5, 1.0, n) * np.where(np.arange(n) % 3 == 0, -1.0, 1.0)

    def at(self, product: Product, sizes: Array) -> csc_matrix | None:
        """The matrix of v -> product(v); None where it has too many entries for its size."""
        if self.n > LARGEST:
            return None
        off, known = 0.0, self._pattern
        if known is not None:
            matrix = self._by_colours(product, sizes)
            off = self._off(matrix, product, sizes)
            if not off > self._noise:
                return matrix
        elif self._full:
            return entries(product, self.n) if self.n <= LARGEST_FULL else None
        matrix = entries(product, self.n)
        if not np.all(np.isfinite(matrix.data)):
            return matrix
        self._learn(matrix)
        if known is not None and self._pattern is not None and self._pattern.nnz == known.nnz:
            self._noise = NOISE * off
        return matrix if self.n <= LARGEST_FULL or not self._full else None

    def _learn(self, matrix: csc_matrix) -> None:
        """Entries that are there, beside those that were at other points."""
        from scipy.sparse import csc_matrix

        pattern = abs(matrix) if self._pattern is None else abs(matrix) + self._pattern
        self._full = pattern.nnz > FULL * self.n * self.n
        if self._full:
            self._pattern = None
            return
        pattern = csc_matrix(pattern)
        pattern.sort_indices()
        by_rows = pattern.tocsr()
        self._colours = np.empty(self.n, np.int64)
        parts = (pattern.indptr, pattern.indices, by_rows.indptr, by_rows.indices)
        self._count = int(colour_columns(*(np.asarray(a, np.int64) for a in parts), self._colours))
        self._pattern, self._columns = pattern, np.repeat(np.arange(self.n), np.diff(pattern.indptr))

    def _by_colours(self, product: Product, sizes: Array) -> csc_matrix:
        pattern = self._pattern
        assert pattern is not None
        slopes = np.array([product(np.where(self._colours == c, sizes, 0.0)) for c in range(self._count)])
        data = slopes[self._colours[self._columns], pattern.indices] / sizes[self._columns]
        return filled(pattern, data)

    def _off(self, matrix: csc_matrix, product: Product, sizes: Array) -> float:
        """What part of a row is missing, by its product with a random vector; 0 where that is not finite."""
        v: Vector = self._test * sizes
        rows, off = abs(matrix) @ np.abs(v), np.abs(product(v) - matrix @ v)
        largest = float(rows.max(initial=0.0))
        if not (np.all(np.isfinite(off)) and largest < np.inf):
            return 0.0
        return float(np.max(off / (rows + SMALL * largest))) if largest > 0.0 else float(off.any())


def entries(product: Product, n: int) -> csc_matrix:
    """All of them, by n products."""
    from scipy.sparse import csc_matrix, hstack

    blocks = []
    for first in range(0, n, BLOCK):
        unit = np.zeros((min(BLOCK, n - first), n))
        unit[np.arange(len(unit)), first + np.arange(len(unit))] = 1.0
        blocks.append(csc_matrix(np.column_stack([product(v) for v in unit])))
    return hstack(blocks, format="csc")
