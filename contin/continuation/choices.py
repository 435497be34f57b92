"""Functions that choose formulas whatever the states are, or step with them: on which side of them rows are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class Choices:
    """texts : what is told of k functions where their side changes.  values (K, k) : theirs at K rows.

    stepwise (k,) : those that choose at every whole number (floor, ceil, mod), and not where they are zero.
    alone (k,) : the place from the end (< 0) of the one unknown that a function depends on; 0 where there are others.
    """

    texts: tuple[str, ...]
    values: Array
    stepwise: NDArray[np.bool_]
    alone: NDArray[np.intp]

    @classmethod
    def none(cls, rows: int) -> Choices:
        """Where the equations have no such function, or it is not known."""
        return cls((), np.empty((rows, 0)), np.zeros(0, bool), np.zeros(0, np.intp))

    @property
    def sides(self) -> Array:
        """(K, k) one number for each side; 0 where the function has no value."""
        return np.nan_to_num(np.where(self.stepwise, np.floor(self.values), self.values > 0.0))

    def share(self, j: int) -> float:
        """Part of the way from the first row to the last one at which function j changes its side."""
        a, b = float(self.values[0, j]), float(self.values[-1, j])
        at = float(np.ceil(min(a, b))) if self.stepwise[j] else 0.0
        return (a - at) / (a - b) if a != b else 0.5
