"""By how much a mesh moves the birth of a family of orbits: amplitudes beside it are off by more than their mesh says.

Radau's formula damps the oscillation that is born, by some h^5 of its frequency, so that orbits on a mesh are born
where the equations make up for that. Their squared amplitudes, on a line through zero beside a birth, show the place.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array

BORN: Final = 1e-6  # part of the next row's amplitude: less is none
TOLD: Final = 0.05  # part of an amplitude that may be wrong in the second row
RIGHT: Final = 0.01  # ... and that is right enough


def remark(parameter: str, z: Array, amplitude: Callable[[Array], float]) -> str:
    """A note on rows z (K, N) that begin or end at a birth, where the mesh has moved it; else empty."""
    if len(z) < 3:
        return ""
    for rows in (z[:3], z[:-4:-1]):
        sizes = np.array([amplitude(row) for row in rows])
        if not sizes[0] <= BORN * sizes[1] < BORN * sizes[2]:
            continue
        square, p = sizes * sizes, rows[:, -1]
        moved = float(p[1] - square[1] * (p[2] - p[1]) / (square[2] - square[1]) - p[0])
        part = moved / float(p[1] - p[0]) if p[1] != p[0] else 0.0  # of the squared amplitude, which is missing
        off = abs(1.0 - float(np.sqrt(max(1.0 - part, 0.0))))
        if off > TOLD:
            far = 0.5 * abs(moved) / RIGHT
            return (
                f"on this mesh the family is born {abs(moved):.1e} from {parameter} = {p[0]:.10g}: amplitudes are "
                f"off by {off:.0%} in the first row there, by {RIGHT:.0%} at a distance of {far:.1e}; write more "
                "`intervals` in `settings`"
            )
    return ""
