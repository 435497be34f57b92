"""A branch whose parameter approaches a bound for ever, while a state grows: it has reached the bound."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.problem import Chunk, Stop

NEAR: Final = 1e-10  # of the range: the parameter is on its bound to what matters
ROWS: Final = 4
GROWN: Final = 1e4
LONG: Final = 1e-3  # steps; near a fold on the bound only much shorter ones stay as near


@dataclass
class Approach:
    """Watches an arm chunk by chunk: how many rows in turn came nearer to a bound, in long steps, but not onto it."""

    bounds: tuple[float, float]
    parameter: str
    scale: Array  # of the states, at the start: one that outgrows it is left to `contin.continuation.lost`
    rows: int = 0

    def watch(self, chunk: Chunk) -> tuple[Chunk, End | None]:
        """The chunk up to where the bound counts as reached, with the end of the arm; or the whole chunk and None."""
        width = self.bounds[1] - self.bounds[0]
        if not np.isfinite(width):
            return chunk, None
        distance = np.abs(chunk.z[:, -1, None] - np.array(self.bounds)).min(axis=1)
        for row in range(1, len(chunk)):
            small = np.all(np.abs(chunk.z[row, :-1]) < GROWN * self.scale)
            nearer = small and 0.0 < distance[row] <= distance[row - 1] < NEAR * width and chunk.lengths[row] > LONG
            self.rows = self.rows + 1 if nearer else 0
            if self.rows == ROWS:
                bound = min(self.bounds, key=lambda b: abs(b - chunk.z[row, -1]))
                return _up_to(chunk, row), End("bound", f"{self.parameter} approaches {bound:g} ever more closely")
        return chunk, None


def _up_to(chunk: Chunk, row: int) -> Chunk:
    """The chunk without the rows after this one."""
    if row + 1 == len(chunk):
        return chunk
    names = ("z", "tangents", "tests", "unstable", "eigenvalues", "lengths")
    return replace(chunk, **{name: getattr(chunk, name)[: row + 1] for name in names}, stop=Stop.LIMIT)
