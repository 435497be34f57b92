"""The sparse pattern of collocation matrices: interval by interval, conditions, then dense columns and rows."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.csc import filled

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


def assembled(blocks: Array, ends: Array, beside: Array, below: Array) -> csc_matrix:
    """[F_x beside; below] in CSC form, rows by interval, Gauss point, function, then the conditions.

    blocks (N, m, n, m + 1, n): by (interval, Gauss point, function) and (node, function).  ends (n, 2 n): of the
    conditions by the values at both ends.  beside (size, k), below (r, size + k), stored with their zeros.
    """
    count, m, n = blocks.shape[:3]
    order, like = _pattern(n, m, count, beside.shape[1], len(below))
    values = np.concatenate([blocks.ravel(), ends[:, :n].ravel(), ends[:, n:].ravel(), beside.ravel(), below.ravel()])
    return filled(like, values[order])


@lru_cache(maxsize=16)
def _pattern(n: int, m: int, count: int, beside: int, below: int) -> tuple[NDArray[np.intp], csc_matrix]:
    """The order of the values of `assembled`, by column, and a matrix that has its tables."""
    from scipy import sparse

    size = (count * m + 1) * n
    i, r, c = np.meshgrid(np.arange(count), np.arange(m * n), np.arange((m + 1) * n), indexing="ij")
    parts = [(i * m * n + r, i * m * n + c)]
    a, b = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    parts += [(size - n + a, b), (size - n + a, size - n + b)]
    parts.append(_indices(0, size, size, beside))
    parts.append(_indices(size, below, 0, size + beside))
    rows, columns = (np.concatenate([part[side].ravel() for part in parts]) for side in (0, 1))
    order = np.lexsort((rows, columns))
    indptr = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=size + beside))])
    tables = np.zeros(len(order)), rows[order].astype(np.int32), indptr.astype(np.int32)
    return order, sparse.csc_matrix(tables, shape=(size + below, size + beside))


def _indices(row: int, rows: int, column: int, columns: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Of a dense block that begins at (row, column)."""
    a, b = np.meshgrid(np.arange(row, row + rows), np.arange(column, column + columns), indexing="ij")
    return a, b
