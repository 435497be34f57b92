"""Sparse matrices in CSC form: of one pattern many times; with a few dense rows and columns, without triplets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


def filled(pattern: csc_matrix, data: Array) -> csc_matrix:
    """The matrix with these entries where `pattern` has its own; rows and columns are shared.

    (Made from its parts, scipy looks through rows and columns every time; `copy.copy` takes four times as long.)
    """
    made = object.__new__(type(pattern))
    made.__dict__.update(pattern.__dict__)
    made.data = data
    return made


def with_columns(matrix: csc_matrix, columns: Array, place: int | None = None) -> csc_matrix:
    """M (n, m) with dense columns (n, k) before its column `place`, or after the last one; zeros are not stored."""
    from scipy import sparse

    n, m = matrix.shape
    place = m if place is None else place
    there = columns.T != 0.0
    cut, added = int(matrix.indptr[place]), int(there.sum())
    rows = np.broadcast_to(np.arange(n, dtype=matrix.indices.dtype), there.shape)[there]
    starts = matrix.indptr[place] + np.cumsum(there.sum(axis=1))
    return sparse.csc_matrix(
        (
            np.concatenate([matrix.data[:cut], columns.T[there], matrix.data[cut:]]),
            np.concatenate([matrix.indices[:cut], rows, matrix.indices[cut:]]),
            np.concatenate([matrix.indptr[: place + 1], starts, matrix.indptr[place + 1 :] + added]),
        ),
        shape=(n, m + columns.shape[1]),
    )


def with_rows(matrix: csc_matrix, rows: Array) -> csc_matrix:
    """M (n, m), its indices sorted, with dense rows (k, m) below; zeros are not stored."""
    from scipy import sparse

    n, m = matrix.shape
    there = rows.T != 0.0  # (m, k)
    added = there.sum(axis=1)
    shift = np.concatenate([[0], np.cumsum(added)])
    indptr = matrix.indptr + shift
    size = int(indptr[-1])
    new = np.repeat(indptr[1:] - added, added) + (np.arange(size - matrix.nnz) - np.repeat(shift[:-1], added))
    old = np.ones(size, bool)
    old[new] = False
    values, indices = np.empty(size, matrix.data.dtype), np.empty(size, matrix.indices.dtype)
    values[old], indices[old] = matrix.data, matrix.indices
    values[new] = rows.T[there]
    indices[new] = np.broadcast_to(n + np.arange(len(rows), dtype=indices.dtype), there.shape)[there]
    return sparse.csc_matrix((values, indices, indptr), shape=(n + len(rows), m))
