"""The order and the scales in which rows of a sparse matrix are swept: by colours, with a diagonal of ones.

Rows of one colour do not depend on each other (Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., sec. 12.4).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.multigrid import colour_rows

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

SWEEPS: Final = 20  # each halves the logarithms of what is left


@dataclass(frozen=True, eq=False)
class Places:
    """The order in which a level's rows are swept, and the scales of B = rows A columns, with a diagonal of ones."""

    order: Vector
    rows: Array
    columns: Array
    colours: tuple[int, ...]

    @classmethod
    def of(cls, matrix: csr_matrix, from_coarse: csr_matrix) -> Places:
        """The last colour is the one with most of the rows that are not on the coarser level."""
        pattern = matrix if _is_symmetric_pattern(matrix) else abs(matrix) + abs(matrix.T)
        n = matrix.shape[0]
        colours, parts = np.empty(n, np.int64), (pattern.indptr.astype(np.int64), pattern.indices.astype(np.int64))
        count = int(colour_rows(*parts, np.full(n + 1, -1), colours))
        fine = np.bincount(colours, np.diff(from_coarse.indptr) != 1, count)
        colours[colours == np.argmax(fine)] = count
        order = np.argsort(colours, kind="stable")
        begins = np.flatnonzero(np.diff(colours[order], prepend=-1))
        diagonal = matrix.diagonal()
        units = _units(matrix, diagonal)
        return cls(order, (1.0 / (diagonal * units))[order], units[order], (*begins.tolist(), n))

    @classmethod
    def of_coarsest(cls, n: int) -> Places:
        return cls(np.arange(n), np.ones(n), np.ones(n), (0, n))


def _units(matrix: csr_matrix, diagonal: Array) -> Array:
    """Of unknowns, so that the largest entries of row and column k of B are alike, for every k (Osborne 1960).

    B is symmetric where A is. The rest, of states in units of their own, by powers of two.
    """
    units, sizes = 1.0 / np.sqrt(np.abs(diagonal)), np.abs(diagonal)
    of_row, filled = np.repeat(np.arange(len(units)), np.diff(matrix.indptr)), matrix.indptr[:-1]
    outside = matrix.indices != of_row
    for _ in range(SWEEPS):
        left = np.abs(matrix.data) * units[matrix.indices] / (sizes * units)[of_row] * outside
        rows, columns = np.maximum.reduceat(left, filled), np.zeros(len(units))
        np.maximum.at(columns, matrix.indices, left)
        known = (rows > 0.0) & (columns > 0.0) & np.isfinite(rows) & np.isfinite(columns)
        exponents = np.frexp(np.divide(rows, columns, out=np.ones(len(units)), where=known))[1] / 4.0
        factors = np.ldexp(1.0, exponents.astype(np.int64))
        units *= factors
        if np.all(factors == 1.0):
            break
    return units


def _is_symmetric_pattern(matrix: csr_matrix) -> bool:
    turned = matrix.T.tocsr()
    return np.array_equal(turned.indptr, matrix.indptr) and np.array_equal(turned.indices, matrix.indices)


def placed(matrix: csr_matrix, rows: Places, row_scale: Array, columns: Places, column_scale: Array) -> csr_matrix:
    """Its rows and columns in other orders, times scales in these orders."""
    from scipy.sparse import csr_matrix

    position = np.empty(len(columns.order), np.int64)
    position[columns.order] = np.arange(len(position))
    moved = matrix[rows.order]
    places = position[moved.indices]
    data = moved.data * np.repeat(row_scale, np.diff(moved.indptr)) * column_scale[places]
    made = csr_matrix((data, places, moved.indptr), shape=matrix.shape)
    made.sort_indices()
    return made
