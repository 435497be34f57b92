"""Equal multipliers that pass 1 and -1 in one step: no test changes its sign, nor does `unstable`.

Of multipliers that a symmetry makes equal an even number passes 1 on its way in and -1 on its way out (rings of cells
have pairs). Different ones may go round the circle as a complex pair, equal ones are kept real.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outset import MULTIPLIERS
from contin.continuation.problem import Problem
from contin.continuation.sentence import Sentence

REAL: Final = 1e-6  # imaginary part, relative, of multipliers that rounding makes complex
EQUAL: Final = 1e-4  # relative distance of multipliers that are equal but for the errors of orbits
BEYOND: Final = 1e-3  # distance from the circle of one that is beyond it, not on it


def passed_twice(multipliers: NDArray[np.complex128], told: Collection[int]) -> list[int]:
    """Rows of multipliers (rows, k) before which equal ones beyond 1 become equal ones beyond -1, or the reverse.

    told : rows of labelled points; the steps to them and from them are left out.
    """
    if len(multipliers) < 2 or not multipliers.shape[1]:
        return []
    ahead, behind = _equal(multipliers, 1.0), _equal(multipliers, -1.0)
    rows = np.diff(ahead) * np.diff(behind) < 0
    return [row for row in (np.flatnonzero(rows) + 1).tolist() if row not in told and row - 1 not in told]


def passed_twice_note(
    problem: Problem, multipliers: NDArray[np.complex128], z: Array, told: Collection[int]
) -> list[Sentence]:
    """A note for rows found by `passed_twice`."""
    rows = passed_twice(multipliers, told) if problem.kind in MULTIPLIERS else []
    if not rows:
        return []
    name, row = problem.parameters[0], rows[0]
    more = f", and in {len(rows) - 1} more steps" if len(rows) > 1 else ""
    text = (
        f"equal multipliers pass 1 and -1 within one step, and what happens there is not labelled: between {name} = "
        f"{z[row - 1, -1]:.10g} and {z[row, -1]:.10g}{more}; try a smaller settings.max_step"
    )
    return [Sentence(text)]


def _equal(multipliers: NDArray[np.complex128], side: float) -> NDArray[np.int64]:
    """(rows,) how many real multipliers beyond `side`, 1 or -1, are equal to the next larger one."""
    with np.errstate(invalid="ignore"):
        real = np.abs(multipliers.imag) <= REAL * np.abs(multipliers.real)
        beyond = real & (side * multipliers.real > 1.0 + BEYOND)
        values = np.sort(np.where(beyond, side * multipliers.real, np.nan), axis=1)
        return np.asarray(np.sum(np.diff(values, axis=1) <= EQUAL * values[:, 1:], axis=1))
