"""Memory of the kernels for the linearised two-point problem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation import new_points
from contin.kernels.collocation_system import new_factors


@dataclass(frozen=True, eq=False)
class Workspace:
    """Memory of the kernels for one mesh size; a linearisation is good until the next one is made in it."""

    points: Any
    factors: Any
    last: Array  # (2 n + 2, 2 n + 2)
    pivots: NDArray[np.int64]

    @classmethod
    def of(cls, n: int, m: int, intervals: int, p: Array) -> Workspace:
        size = 2 * n + 2
        points = new_points(n, m, intervals, p)  # type: ignore[no-untyped-call]
        factors = new_factors(n, m, intervals)  # type: ignore[no-untyped-call]
        return cls(points, factors, np.zeros((size, size)), np.zeros(size, np.int64))
