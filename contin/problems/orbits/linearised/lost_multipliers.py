"""Whether the multipliers of a branch are as accurate as they look: by those whose values are known.

The trivial one of an autonomous system is 1, the critical ones of a curve of special orbits are what they are for. The
product of matrices has them to its own errors, as it has the others: along canards 1e8 may stand for 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.position import elsewhere, position
from contin.problems.orbits.linearised.multipliers import Multipliers, nearest

if TYPE_CHECKING:
    from contin.abi import Array
    from contin.continuation.problem import Problem
    from contin.problems.orbits.family import FamilyOfOrbits

TOLD: Final = 1e-3  # relative error from which on multipliers have a note


def remarks(
    problem: Problem, orbits: FamilyOfOrbits, z: Array, rows: Multipliers,
    critical: Callable[[Array], Sequence[complex]] | None = None,
) -> Sequence[str]:  # fmt: skip
    """A note on rows z with multipliers `rows` (K, n), where one whose value is known is not met.

    critical : the values that are known of a row beside the trivial multiplier: one, or a pair.
    """
    known = [(rows[:, 0], np.ones(len(rows)))] if orbits.autonomous and rows.shape[1] else []
    if critical is not None:
        first = int(orbits.autonomous)
        met = [_critical(values[first:], critical(row)) for row, values in zip(z, rows, strict=True)]
        known.append((np.array([found for found, _ in met]), np.array([value for _, value in met])))
    if not known:
        return ()
    errors = np.array([np.abs(found - values) / np.maximum(np.abs(values), TOLD) for found, values in known])
    errors = np.nan_to_num(errors)  # where none could be computed there is a note of its own
    which, row = np.unravel_index(np.argmax(errors), errors.shape)
    if not errors[which, row] > TOLD:
        return ()
    found, values = (part[row].real for part in known[which])
    others = elsewhere(int(np.count_nonzero(errors.max(axis=0) > TOLD)) - 1)
    return (
        f"multipliers are not accurate: one that is known comes out as {found:.4g} for {values:.4g} near "
        f"{position(problem, z[row])}{others}, and others may be off by as much of their size",
    )


def _critical(values: Multipliers, wanted: Sequence[complex]) -> tuple[complex, complex]:
    """What is found for the critical ones, and what they are: of two their means, each has half of the digits at R1."""
    values = values[np.isfinite(values)]  # a row that has fewer than others ends with NaN
    if not len(values):
        return complex(np.nan), 1.0
    return complex(np.mean([values[nearest(values, one)] for one in wanted])), complex(np.mean(wanted))
