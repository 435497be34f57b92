"""Algebraic multigrid as a preconditioner: the levels are pyamg's, the cycles compiled here.

A V-cycle is a sweep of Gauss and Seidel's method down the rows on the way to coarser levels, and one up the rows on the
way back, so that it is symmetric where the matrix is (Briggs, Henson and McCormick, A Multigrid Tutorial, 2000). The
first one begins at zero: it and the residual after it take the lower and the upper triangle once each, a whole cycle
two passes through every level's matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.kernels.multigrid import add_product, sweep_back, sweep_from_zero

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

DIGITS: Final = 2.0**31 - 1.0  # of an entry, in units of its row
COARSEST: Final = 2_000  # unknowns up to which the last level is inverted


@dataclass(frozen=True, eq=False)
class Packed:
    """Rows of a sparse matrix as `contin.kernels.multigrid` reads them; `units` are the largest entries of rows."""

    starts: Vector
    entries: Vector
    units: Array

    @classmethod
    def of(cls, matrix: csr_matrix, units: Array | None = None) -> Packed:
        """units : of each row; None: its largest entry."""
        starts = matrix.indptr.astype(np.int64)
        rows = np.repeat(np.arange(matrix.shape[0]), np.diff(starts))
        if units is None:
            units = np.zeros(matrix.shape[0])
            np.maximum.at(units, rows, np.abs(matrix.data))
            units = np.where(units > 0.0, units, 1.0) / DIGITS
        digits = np.rint(matrix.data / units[rows]).astype(np.int64)
        return cls(starts, (digits << 32) | matrix.indices.astype(np.int64), units)

    def add_to(self, out: Array, x: Array, factor: float = 1.0) -> Array:
        """out + factor A x, in place."""
        add_product(self.starts, self.entries, self.units, x, factor, out)
        return out


@dataclass(frozen=True, eq=False)
class Level:
    """A matrix L + D + U in three parts, with ways to the next coarser level and back."""

    lower: Packed
    upper: Packed
    inverse: Array  # of D's entries
    to_coarse: Packed
    from_coarse: Packed
    coarse_size: int

    @classmethod
    def of(cls, matrix: csr_matrix, to_coarse: csr_matrix, from_coarse: csr_matrix) -> Level:
        from scipy.sparse import tril, triu

        units = Packed.of(matrix).units
        lower, upper = (Packed.of(part(matrix, k, format="csr"), units) for part, k in ((tril, -1), (triu, 1)))
        back = from_coarse.tocsr()
        inverse = 1.0 / matrix.diagonal()
        return cls(lower, upper, inverse, Packed.of(to_coarse.tocsr()), Packed.of(back), back.shape[1])


@dataclass(frozen=True, eq=False)
class Multigrid:
    """r -> about A^-1 r by one V-cycle; a preconditioner (`FunctionProblem(..., preconditioner=...)`)."""

    levels: tuple[Level, ...]
    coarsest: Array  # the inverse of the last level's matrix
    unit: float  # of A, with the sign of its diagonal: levels are those of A / unit

    def __call__(self, right: Array) -> Array:
        return self._cycle(0, np.ascontiguousarray(right, dtype=float)) / self.unit

    def _cycle(self, k: int, right: Array) -> Array:
        if k == len(self.levels):
            return np.asarray(np.einsum("ij,j->i", self.coarsest, right))
        here, x = self.levels[k], np.empty_like(right)
        lower, upper = here.lower, here.upper
        sweep_from_zero(lower.starts, lower.entries, lower.units, here.inverse, right, x)
        residual = upper.add_to(np.zeros_like(right), x, -1.0)
        coarse = here.to_coarse.add_to(np.zeros(here.coarse_size), residual)
        here.from_coarse.add_to(x, self._cycle(k + 1, coarse))
        sweep_back(lower.starts, lower.entries, upper.starts, upper.entries, lower.units, here.inverse, right, x)
        return x


def multigrid(matrix: Any, hierarchy: Callable[[Any], Any] | None = None) -> Multigrid:
    """A preconditioner of a sparse matrix of a diffusion, whose diagonal has one sign.

    Parameters
    ----------
    matrix : sparse (n, n)
    hierarchy : what makes pyamg's levels of the matrix with a positive diagonal: `pyamg.ruge_stuben_solver` (None),
        `pyamg.smoothed_aggregation_solver`, or one with options of your own. Its smoothers are not used.

    Returns
    -------
    function of r (n,): one V-cycle for A x = r. Its entries have nine digits, what a preconditioner is for: a solution
    is as exact as the residual that the iteration around it leaves.

    Raises
    ------
    InputError
        pyamg is missing, entries of the diagonal vanish or have both signs, or the levels end too soon.
    """
    from scipy.sparse import csr_matrix

    whole = csr_matrix(matrix, dtype=float)
    diagonal = whole.diagonal()
    unit = float(diagonal[np.argmax(np.abs(diagonal))])  # pyamg takes squares of entries
    if not np.all(diagonal / unit > 0.0):  # NaN where they all vanish
        raise InputError("multigrid wants a matrix whose diagonal is positive everywhere, or negative everywhere")
    made = (hierarchy or _pyamg().ruge_stuben_solver)(whole / unit)
    levels = [(level, csr_matrix(level.A)) for level in made.levels]
    for _, a in levels:
        a.sum_duplicates()
        if not np.all(a.diagonal() != 0.0):
            raise InputError("multigrid: the diagonal of a coarser level vanishes somewhere: choose another hierarchy")
    last = levels[-1][1]
    if last.shape[0] > COARSEST:
        raise InputError(f"multigrid: the coarsest level has {last.shape[0]} unknowns, more than {COARSEST}")
    parts = tuple(Level.of(a, level.R, level.P) for level, a in levels[:-1])
    return Multigrid(parts, np.linalg.pinv(last.toarray()), unit)


def _pyamg() -> Any:
    try:
        return import_module("pyamg")
    except ImportError:
        raise InputError("multigrid needs the package pyamg: pip install pyamg (or contin[amg])") from None
