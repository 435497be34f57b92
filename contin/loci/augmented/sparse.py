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
    """LU factors of a sparse matrix with full rows and columns."""

    def __init__(self, matrix: csc_matrix) -> None:
        from scipy.sparse.linalg import splu

        self.is_singular = False
        try:
            self._lu = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A")
        except RuntimeError:
            self.is_singular = True

    @cached_property
    def _diagonal(self) -> Array:
        return np.asarray(self._lu.U.diagonal())

    @cached_property
    def sign(self) -> float:
        """Of the determinant, 0 where the matrix is singular."""
        if self.is_singular:
            return 0.0
        return float(np.prod(np.sign(self._diagonal))) * _parity(self._lu.perm_r) * _parity(self._lu.perm_c)

    @cached_property
    def log_determinant(self) -> float:
        return float(np.sum(elementary.log(np.abs(self._diagonal)))) if self.sign != 0.0 else 0.0

    def solve(self, right: Array) -> Array:
        return np.asarray(self._lu.solve(right))

    def solve_transposed(self, right: Array) -> Array:
        return np.asarray(self._lu.solve(right, "T"))


def _parity(permutation: NDArray[np.int32]) -> float:
    """The sign of a permutation, by the number of its cycles: each is found by its smallest member."""
    size = len(permutation)
    least, ahead = np.arange(size), permutation
    for _ in range(size.bit_length()):  # twice as far with every round
        least, ahead = np.minimum(least, least[ahead]), ahead[ahead]
    cycles = int(np.sum(least == np.arange(size)))
    return -1.0 if (size - cycles) % 2 else 1.0


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
    def is_singular(self) -> bool:
        return self._factors.is_singular

    @property
    def sign(self) -> float:
        return self._factors.sign

    @property
    def log_determinant(self) -> float:
        return self._factors.log_determinant

    def image(self, x: Array) -> Array:
        """E' x, both scaled, with zeros for what stands still."""
        still = self.size - len(self.where)
        return np.append((self.matrix @ x[self.where])[: len(self.residual) - still], np.zeros(still))

    def solve(self, right: Array) -> Array:
        still = self.size - len(self.where)
        count = len(self.residual)
        x = np.zeros(self.size)
        x[self.where] = self._factors.solve(np.append(right[: count - still], right[count:]))
        return x
