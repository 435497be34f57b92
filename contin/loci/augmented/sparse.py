"""Bordered systems of large sparse matrices, some of whose unknowns stand still: the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


class Factors:
    """LU factors of a sparse matrix with full rows and columns; `sign` is 0 where it is singular."""

    def __init__(self, matrix: csc_matrix) -> None:
        from scipy.sparse.linalg import splu

        self.sign, self.log_determinant = 0.0, 0.0
        try:
            self._lu = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A")
        except RuntimeError:  # singular: its sign says so
            return
        diagonal = self._lu.U.diagonal()
        self.sign = float(np.prod(np.sign(diagonal))) * _parity(self._lu.perm_r) * _parity(self._lu.perm_c)
        self.log_determinant = float(np.sum(elementary.log(np.abs(diagonal)))) if self.sign != 0.0 else 0.0

    def solve(self, right: Array) -> Array:
        return np.asarray(self._lu.solve(right))

    def solve_transposed(self, right: Array) -> Array:
        return np.asarray(self._lu.solve(right, "T"))


def _parity(permutation: NDArray[np.int32]) -> float:
    """The sign of a permutation, by its cycles."""
    seen = np.zeros(len(permutation), bool)
    sign = 1.0
    for start in range(len(permutation)):
        length, k = 0, start
        while not seen[k]:
            seen[k] = True
            k, length = int(permutation[k]), length + 1
        sign = -sign if length and length % 2 == 0 else sign
    return sign


@dataclass(frozen=True, eq=False)
class SparseBordered:
    """[E'; B] in scaled unknowns, at the places `where` of z; what stands still elsewhere has zeros in the residual."""

    residual: Array  # of E, then a zero for every unknown that stands still
    matrix: csc_matrix
    where: NDArray[np.intp]
    size: int
    form: Array | None = None  # of branch points, see `contin.loci.augmented.singular.Singular`

    @cached_property
    def _factors(self) -> Factors:
        return Factors(self.matrix)

    @property
    def sign(self) -> float:
        return self._factors.sign

    @property
    def log_determinant(self) -> float:
        return self._factors.log_determinant

    def solve(self, right: Array) -> Array:
        still = self.size - len(self.where)
        count = len(self.residual)
        x = np.zeros(self.size)
        x[self.where] = self._factors.solve(np.append(right[: count - still], right[count:]))
        return x
