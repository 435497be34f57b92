"""LU factors as LAPACK and SuperLU make them, one class a storage: tridiagonal, band, sparse (in two precisions).

Each solves with the matrix and with its transpose, and knows the sign of its determinant where that is real.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Vector
from contin.linalg.tally import Tally

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import SuperLU

TINY_PIVOT = 1e-15  # a zero pivot becomes this part of the largest one, so that singular matrices have (huge) solutions


class _Counted(ABC):
    """Counts its solves."""

    tally: Tally | None = None

    @abstractmethod
    def _apply(self, right: Vector, transposed: bool) -> Vector:
        """Solve with the matrix or its transpose."""

    def _counted(self, right: Vector, transposed: bool) -> Vector:
        if self.tally is not None:
            self.tally.applied(right)
        return self._apply(right, transposed)

    def solve(self, right: Vector) -> Vector:
        return self._counted(right, False)

    def solve_transposed(self, right: Vector) -> Vector:
        return self._counted(right, True)


class _Reordered(_Counted):
    """Solves with a matrix whose rows and columns were put in another order."""

    order: Vector | None
    complex_: bool

    @abstractmethod
    def _solve(self, right: Vector, transposed: bool) -> Vector:
        """Solve with the reordered matrix or its transpose."""

    def _apply(self, right: Vector, transposed: bool) -> Vector:
        if np.iscomplexobj(right) and not self.complex_:
            return self._apply(right.real, transposed) + 1j * self._apply(right.imag, transposed)
        if self.order is None:
            return self._solve(right, transposed)
        solution = self._solve(right[self.order], transposed)
        result = np.empty_like(solution)
        result[self.order] = solution
        return result


def _sign(diagonal: Vector, exchanges: int) -> float:
    """Of the determinant, from the pivots; tiny pivots are replaced in place."""
    size = np.abs(diagonal)
    small = ~(size > TINY_PIVOT * size.max())
    if small.any():
        diagonal[small] = TINY_PIVOT * size.max()
    return float((-1.0) ** (exchanges + int(np.count_nonzero(diagonal.real < 0.0))))


class TridiagonalFactor(_Reordered):
    """LAPACK gttrf, three times as fast as a band of the same width."""

    def __init__(
        self, data: Vector, diagonals: tuple[tuple[Vector, Vector], ...], n: int,
        order: Vector | None,
    ) -> None:  # fmt: skip
        from scipy.linalg import lapack

        self.order, self.complex_ = order, np.iscomplexobj(data)
        kind = complex if self.complex_ else float
        below, diagonal, above = np.zeros(n - 1, kind), np.zeros(n, kind), np.zeros(n - 1, kind)
        for part, (entries, places) in zip((below, diagonal, above), diagonals, strict=True):
            part[places] = data[entries]
        factor, self._solver = (lapack.zgttrf, lapack.zgttrs) if self.complex_ else (lapack.dgttrf, lapack.dgttrs)
        *factors, self._pivots, _ = factor(below, diagonal, above)
        exchanges = int(np.count_nonzero(self._pivots != np.arange(1, n + 1)))
        self.sign = _sign(factors[1], exchanges)
        self._factors = factors

    def _solve(self, right: Vector, transposed: bool) -> Vector:
        return np.asarray(self._solver(*self._factors, self._pivots, right, trans="T" if transposed else "N")[0])


class BandFactor(_Reordered):
    """LAPACK gbtrf of the reordered band; matrix entry `data[k]` is at (rows[k], columns[k]) of it."""

    def __init__(
        self, data: Vector, rows: Vector, columns: Vector, widths: tuple[int, int], n: int,
        order: Vector | None,
    ) -> None:  # fmt: skip
        from scipy.linalg import lapack

        self.widths, self.order, self.complex_ = widths, order, np.iscomplexobj(data)
        lower, upper = widths
        band = np.zeros((2 * lower + upper + 1, n), dtype=complex if self.complex_ else float, order="F")
        band[lower + upper + rows - columns, columns] = data
        factor, self._solver = (lapack.zgbtrf, lapack.zgbtrs) if self.complex_ else (lapack.dgbtrf, lapack.dgbtrs)
        self._band, self._pivots, _ = factor(band, lower, upper, overwrite_ab=True)
        exchanges = int(np.count_nonzero(self._pivots != np.arange(n)))
        self.sign = _sign(self._band[lower + upper], exchanges)

    def _solve(self, right: Vector, transposed: bool) -> Vector:
        return np.asarray(self._solver(self._band, *self.widths, right, self._pivots, trans=int(transposed))[0])


class SuperFactor(_Counted):
    """SuperLU factors; symmetric patterns are eliminated in a minimum-degree order, with weak pivoting."""

    def __init__(self, matrix: csc_matrix) -> None:
        from scipy.sparse import identity

        size = float(np.abs(matrix.data).max(initial=1e-300))
        try:
            self._lu = self.factors(matrix)
        except RuntimeError:  # exactly singular
            shifted = matrix + TINY_PIVOT * size * identity(matrix.shape[0], format="csc")
            self._lu = self.factors(shifted)
        self._complex = np.iscomplexobj(matrix.data)

    @cached_property
    def sign(self) -> float:
        """Of the determinant."""
        return sign_of(self._lu)

    @staticmethod
    def factors(matrix: csc_matrix) -> SuperLU:
        """In the precision of the matrix."""
        from scipy.sparse.linalg import splu

        return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.05, options={"SymmetricMode": True})

    def _apply(self, right: Vector, transposed: bool) -> Vector:
        if np.iscomplexobj(right) and not self._complex:
            return self._apply(right.real.copy(), transposed) + 1j * self._apply(right.imag.copy(), transposed)
        return np.asarray(self._lu.solve(right, "T" if transposed else "N"))


class SingleFactor(_Counted):
    """SuperLU factors in single precision of a real matrix; right-hand sides and solutions are double, of any size."""

    def __init__(self, matrix: csc_matrix) -> None:
        self._size = float(np.abs(matrix.data).max(initial=0.0)) or 1.0
        single = (matrix / self._size).astype(np.float32)
        self._lu = SuperFactor.factors(single)

    def _apply(self, right: Vector, transposed: bool) -> Vector:
        if np.iscomplexobj(right):
            return self._apply(right.real.copy(), transposed) + 1j * self._apply(right.imag.copy(), transposed)
        size = np.abs(right).max(axis=0, initial=0.0)
        size = np.where((size > 0.0) & np.isfinite(size), size, 1.0)
        found = self._lu.solve((right / size).astype(np.float32), "T" if transposed else "N")
        return np.asarray(found * (size / self._size))


def sign_of(factors: SuperLU) -> float:
    """Of the determinant; made on request, because reading the pivots copies both factors."""
    diagonal = factors.U.diagonal() if factors.shape[0] else np.empty(0)
    negative = int(np.count_nonzero(diagonal.real < 0.0))
    return (-1.0) ** (negative + _exchanges(factors.perm_r) + _exchanges(factors.perm_c))


def _exchanges(permutation: Vector) -> int:
    """Parity of a permutation: its length minus the number of its cycles, which are counted by their least members."""
    places = np.arange(len(permutation))
    least, ahead, reach = places, np.asarray(permutation, dtype=np.intp), 1
    while reach < len(places):
        least, ahead, reach = np.minimum(least, least[ahead]), ahead[ahead], 2 * reach
    return (len(places) - int(np.count_nonzero(least == places))) % 2
