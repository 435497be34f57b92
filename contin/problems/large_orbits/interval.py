"""The matrix of one interval, 1 x M - T h (A x J), with M the mass matrix or the identity.

The three points of a state stand beside each other, so that a narrow band stays one.
Column 3 c + k holds the entries (r, c) of J at point k in rows 3 r + i, times -T h A[i, k].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, identity

from contin.abi import Array
from contin.linalg.csc import filled
from contin.problems.large_orbits.radau import STAGES, A


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where entries of J's of one pattern, whose diagonal is full, stand in the interval's matrix."""

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    places: NDArray[np.intp]  # (entries of J, k, i)
    diagonal: NDArray[np.intp]  # (n, 3)
    rows: NDArray[np.int32]
    starts: NDArray[np.int32]

    @classmethod
    def of(cls, J: csc_matrix) -> Pattern:
        n, counts = J.shape[1], np.diff(J.indptr)
        columns = np.repeat(np.arange(n), counts)
        t = np.arange(J.nnz) - J.indptr[columns]
        k, i = np.arange(STAGES)[:, None], np.arange(STAGES)
        square = STAGES * STAGES
        first = square * J.indptr[columns] + STAGES * t
        places = first[:, None, None] + STAGES * counts[columns][:, None, None] * k + i
        rows = np.empty(square * J.nnz, np.int32)
        rows[places] = (STAGES * J.indices)[:, None, None] + i
        starts = np.append(0, np.cumsum(np.repeat(STAGES * counts, STAGES))).astype(np.int32)
        on = np.flatnonzero(J.indices == columns)
        diagonal = places[on][:, np.arange(STAGES), np.arange(STAGES)]
        return cls(J.indptr.copy(), J.indices.copy(), places, diagonal, rows, starts)

    def fits(self, J: csc_matrix) -> bool:
        """True for a matrix of this pattern."""
        return np.array_equal(J.indptr, self.indptr) and np.array_equal(J.indices, self.indices)

    def matrix(self, three: Sequence[csc_matrix], step: float, mass: csc_matrix | None = None) -> csc_matrix:
        """The interval's matrix from J at its points, and M of the same pattern."""
        data: Array = np.empty(len(self.rows))
        for k, J in enumerate(three):
            data[self.places[:, k]] = (-step * J.data)[:, None] * A[:, k]
        if mass is None:
            data[self.diagonal] += 1.0
        else:
            stages = np.arange(STAGES)
            data[self.places[:, stages, stages]] += mass.data[:, None]
        return filled(self._empty, data)

    @cached_property
    def _empty(self) -> csc_matrix:
        size = len(self.starts) - 1
        return csc_matrix((np.zeros(len(self.rows)), self.rows, self.starts), shape=(size, size))


def full_diagonal(J: csc_matrix) -> csc_matrix:
    """J in canonical form with every diagonal entry, zeros too."""
    J = csc_matrix(J)
    J.sum_duplicates()
    columns = np.repeat(np.arange(J.shape[1]), np.diff(J.indptr))
    if int(np.sum(J.indices == columns)) == J.shape[1]:
        return J
    missing = np.setdiff1d(np.arange(J.shape[1]), J.indices[J.indices == columns])
    both = J.tocoo()
    rows, columns = np.concatenate([both.row, missing]), np.concatenate([both.col, missing])
    filled = csc_matrix((np.concatenate([both.data, np.zeros(len(missing))]), (rows, columns)), shape=J.shape)
    filled.sort_indices()
    return filled


def full_diagonals(matrices: Sequence[csc_matrix]) -> list[csc_matrix]:
    """`full_diagonal` of each; a pattern that comes again is looked through once."""
    known: csc_matrix | None = None  # the last one whose entries were all there
    made = []
    for J in matrices:
        if known is not None and _alike(J, known):
            made.append(filled(known, J.data))
            continue
        full = full_diagonal(J)
        known = full if _alike(J, full) else None
        made.append(full)
    return made


def _alike(J: csc_matrix, other: csc_matrix) -> bool:
    """Whether both store entries in the same places, column by column."""
    same = np.array_equal(J.indptr, other.indptr) and np.array_equal(J.indices, other.indices)
    return same and bool(J.format == other.format)


def one_pattern(matrices: Sequence[csc_matrix]) -> list[csc_matrix]:
    """The matrices with the union of their patterns."""
    first = matrices[0]
    if all(np.array_equal(J.indptr, first.indptr) and np.array_equal(J.indices, first.indices) for J in matrices):
        return list(matrices)
    union = identity(first.shape[0], format="csc")
    for J in matrices:
        union = union + abs(J).astype(bool).astype(float)
    union = csc_matrix(union)
    union.sort_indices()
    spread = []
    for J in matrices:
        place = filled(union, np.arange(1.0, union.nnz + 1.0))
        found = csc_matrix(place.multiply(abs(J).astype(bool)))
        found.sort_indices()
        data = np.zeros(union.nnz)
        full = J.copy()  # its pattern may be shared
        full.eliminate_zeros()
        full.sort_indices()
        data[found.data.astype(np.intp) - 1] = full.data
        spread.append(filled(union, data))
    return spread
