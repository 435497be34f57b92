"""Products with large sparse matrices by their rows, which threads can share; those of scipy go through columns.

Matrices of one pattern are put in order once: where each entry is among those of its row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.long_rows import product_by_rows
from contin.machine.threads import PART, in_parts

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

LARGEST: Final = 2**31 - 1  # rows and columns that fit into half a number


@dataclass(frozen=True, eq=False)
class _Order:
    """Of the entries of a CSC pattern in its rows."""

    pattern: tuple[Vector, Vector]
    starts: Vector
    pairs: Vector  # columns, two in a number
    places: Vector | slice

    @classmethod
    def of(cls, matrix: csc_matrix) -> _Order:
        from scipy.sparse import csc_matrix

        numbered = csc_matrix((np.arange(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
        turned = numbered.tocsr()
        columns = np.zeros(turned.nnz + turned.nnz % 2, np.dtype("<i4"))
        columns[: turned.nnz] = turned.indices
        kept = matrix.indptr.copy(), matrix.indices.copy()
        return cls(kept, turned.indptr.astype(np.int64), columns.view("<i8").astype(np.int64), turned.data)

    def is_of(self, matrix: csc_matrix) -> bool:
        pairs = zip(self.pattern, (matrix.indptr, matrix.indices), strict=True)
        return all(a is b or np.array_equal(a, b) for a, b in pairs)


class ByRows:
    """Makes v -> A v of one matrix after another."""

    def __init__(self) -> None:
        self._order: _Order | None = None

    def product(self, matrix: csc_matrix) -> Callable[[Array], Array]:
        """Of real v (n,); matrices that are not long are scipy's."""
        n = matrix.shape[0]
        if not (PART < n < LARGEST and matrix.format == "csc" and matrix.data.dtype == float):
            return lambda v: np.asarray(matrix @ v)
        if self._order is None or not self._order.is_of(matrix):
            self._order = _Order.of(matrix)
        order = self._order
        data = matrix.data[order.places]

        def product(v: Array) -> Array:
            x, out = np.ascontiguousarray(v, dtype=float), np.empty(n)
            in_parts(0, n, lambda a, b: product_by_rows(order.starts, order.pairs, data, x, a, b, out))
            return out

        return product
