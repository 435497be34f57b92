"""The rows that the kernels of orbits and of special orbits fill: points, tangents, test functions, multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.sample import Chunk, Stop

FILLED: Final = 0.8  # part of its rows that a march of thousands of unknowns keeps all of them for


@dataclass(frozen=True, eq=False)
class Rows:
    """Row 0 is where a march begins, or the base of a correction.

    info : [last row, next step, evaluations, ...], the rest as the kernel says.
    """

    z: Array
    t: Array
    tests: Array
    unstable: NDArray[np.int64]
    re: Array
    im: Array
    lengths: Array
    info: Array

    @classmethod
    def of(cls, rows: int, size: int, tests: int, n: int) -> Rows:
        return cls(
            np.empty((rows, size)), np.empty((rows, size)), np.empty((rows, tests)), np.zeros(rows, np.int64),
            np.full((rows, n), np.nan), np.zeros((rows, n)), np.zeros(rows), np.zeros(11),
        )  # fmt: skip

    def __len__(self) -> int:
        """Rows that were marched, with row 0."""
        return int(self.info[0]) + 1

    def chunk(self, stop: Stop, reference: float = 0.0, dipped: int = 0, detail: str = "") -> Chunk:
        """What was marched; the arrays are let go where most of their rows were not needed."""
        m, info = len(self), self.info
        z, t = (rows[:m] if FILLED * len(rows) <= m else rows[:m].copy() for rows in (self.z, self.t))
        return Chunk(
            z, t, self.tests[:m], self.unstable[:m], self.re[:m] + 1j * self.im[:m], self.lengths[:m], stop,
            float(info[1]), reference, dipped, int(info[2]), detail,
        )  # fmt: skip
