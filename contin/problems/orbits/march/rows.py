"""The rows that the kernels of orbits and of special orbits fill: points, tangents, test functions, multipliers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Chunk, Stop


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
            np.full((rows, n), np.nan), np.zeros((rows, n)), np.zeros(rows), np.zeros(7),
        )  # fmt: skip

    def __len__(self) -> int:
        """Rows that were marched, with row 0."""
        return int(self.info[0]) + 1

    def chunk(self, stop: Stop, reference: float = 0.0, dipped: int = 0, detail: str = "") -> Chunk:
        """What was marched."""
        m, info = len(self), self.info
        return Chunk(
            self.z[:m], self.t[:m], self.tests[:m], self.unstable[:m], self.re[:m] + 1j * self.im[:m], self.lengths[:m],
            stop, float(info[1]), reference, dipped, int(info[2]), detail,
        )  # fmt: skip
