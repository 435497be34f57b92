"""Algebraic multigrid as a preconditioner: the levels are pyamg's, the cycles compiled here.

A V-cycle is a sweep of Gauss and Seidel's method down the rows on the way to coarser levels, and one up the rows on the
way back, so that it is symmetric where the matrix is (Briggs, Henson and McCormick, A Multigrid Tutorial, 2000). Rows
are coloured, and those of one colour, which do not depend on each other, are swept at once, by as many threads as there
are. Unknowns are scaled so that every diagonal is one.

The first sweep begins at zero: the residual after it is -U x, and zero in the rows of the last colour; on the way back
these rows do not ask what they were. So no coarse correction is brought to them, and no residual taken from them: where
they are the unknowns that are not on the coarser level, both ways are little more than copies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.kernels import multigrid as kernels
from contin.linalg.coloured import Places, placed
from contin.linalg.packed_rows import DIGITS, Packed
from contin.machine.threads import in_parts

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

COARSEST: Final = 2_000  # unknowns up to which the last level is inverted


@dataclass(frozen=True, eq=False)
class Level:
    """A matrix L + 1 + U in colours, and the ways to the next coarser level and back."""

    lower: Packed
    upper: Packed
    colours: tuple[int, ...]  # where the rows of each begin, and where the last ones end
    to_coarse: tuple[Packed, ...]  # of the solution after the first sweep: one after the other
    from_coarse: Packed  # to all rows but those of the last colour

    @classmethod
    def of(cls, matrix: csr_matrix, to_coarse: csr_matrix, from_coarse: csr_matrix, colours: tuple[int, ...]) -> Level:
        """Scaled, and ordered by colours."""
        from scipy.sparse import tril, triu

        unit = float(np.abs(matrix.data).max(initial=0.0)) / DIGITS
        lower, upper = tril(matrix, -1, format="csr"), triu(matrix, 1, format="csr")
        inner = colours[-2]  # rows that are not of the last colour
        residual, collected = -upper[:inner], to_coarse[:, :inner].tocsr()
        at_once = (collected @ residual).tocsr()
        steps = (residual, collected) if at_once.nnz > residual.nnz + collected.nnz + inner else (at_once,)
        return cls(
            Packed.of(lower, unit), Packed.of(upper, unit), colours,
            tuple(Packed.of(step) for step in steps), Packed.of(from_coarse[:inner].tocsr()),
        )  # fmt: skip

    def sweep_down(self, right: Array, x: Array) -> None:
        """x = (L + 1)^-1 right: a sweep from x = 0."""
        x[: self.colours[1]] = right[: self.colours[1]]
        for first, last in pairwise(self.colours[1:]):
            self._relax(self.lower, right, x, first, last)

    def sweep_up(self, right: Array, x: Array) -> None:
        """A sweep from the last colour to the first, from what x is (but in the last colour)."""
        one, both = self.lower, self.upper
        *others, end = tuple(pairwise(self.colours))
        self._relax(one if others else both, right, x, *end)
        for first, last in reversed(others[1:]):
            in_parts(
                first, last, lambda a, b: kernels.relax_rows_of_both(
                    one.starts, one.entries, both.starts, both.entries, one.unit, right, x, a, b
                ),
            )  # fmt: skip
        for first, last in others[:1]:
            self._relax(both, right, x, first, last)

    @staticmethod
    def _relax(part: Packed, right: Array, x: Array, first: int, last: int) -> None:
        in_parts(first, last, lambda a, b: kernels.relax_rows(part.starts, part.entries, part.unit, right, x, a, b))

    def coarse_right(self, x: Array) -> Array:
        """The coarser level's right-hand side, from the solution after the first sweep."""
        for step in self.to_coarse:
            x = step.times(x, np.empty(len(step.starts) - 1))
        return x


@dataclass(frozen=True, eq=False)
class Multigrid:
    """r -> about A^-1 r by one V-cycle; a preconditioner (`FunctionProblem(..., preconditioner=...)`)."""

    levels: tuple[Level, ...]
    coarsest: Array  # the inverse of the last level's matrix
    order: Vector  # position in the first level -> row
    in_scale: Array  # of right-hand sides and ...
    out_scale: Array  # ... of solutions, by position

    def __call__(self, right: Array) -> Array:
        right, n = np.ascontiguousarray(right, dtype=float), len(self.order)
        inner, out = np.empty(n), np.empty(n)
        in_parts(0, n, lambda a, b: kernels.gather_scaled(self.order, self.in_scale, right, inner, a, b))
        found = self._cycle(0, inner)
        in_parts(0, n, lambda a, b: kernels.scatter_scaled(self.order, self.out_scale, found, out, a, b))
        return out

    def _cycle(self, k: int, right: Array) -> Array:
        if k == len(self.levels):
            return np.asarray(np.einsum("ij,j->i", self.coarsest, right))
        here, x = self.levels[k], np.empty_like(right)
        here.sweep_down(right, x)
        here.from_coarse.times(self._cycle(k + 1, here.coarse_right(x)), x, add=True)
        here.sweep_up(right, x)
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
        It is no square matrix, pyamg is missing, entries of the diagonal vanish or have both signs, or the levels end
        too soon.
    """
    from scipy.sparse import csr_matrix

    whole = csr_matrix(matrix, dtype=float)
    if whole.shape[0] != whole.shape[1]:
        rows, columns = whole.shape
        raise InputError(
            f"multigrid wants a square matrix, not {rows} x {columns}: "
            "as a preconditioner, write `lambda u, p: contin.multigrid(jacobian(u, p))`"
        )
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
    places = [Places.of(a, csr_matrix(level.P)) for level, a in levels[:-1]]
    places.append(Places.of_coarsest(last.shape[0]))
    parts = []
    for (level, a), here, coarse in zip(levels, places, places[1:], strict=False):
        scaled = placed(a, here, here.rows, here, here.columns)
        to_coarse = placed(csr_matrix(level.R), coarse, coarse.rows, here, 1.0 / here.rows)
        from_coarse = placed(csr_matrix(level.P), here, 1.0 / here.columns, coarse, coarse.columns)
        parts.append(Level.of(scaled, to_coarse, from_coarse, here.colours))
    first = places[0]
    return Multigrid(tuple(parts), np.linalg.pinv(last.toarray()), first.order, first.rows / unit, first.columns)


def _pyamg() -> Any:
    try:
        return import_module("pyamg")
    except ImportError:
        raise InputError("multigrid needs the package pyamg: pip install pyamg (or contin[amg])") from None
