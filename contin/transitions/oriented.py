"""The sense in which a branch that is born is followed first."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm

LEVEL: Final = 1e-6  # part of a direction below which the parameter does not change along it
MOVES: Final = 1e-3  # part of the largest entry from which one moves; of entries alike rounding chooses the largest


def oriented(direction: Array, scale: Array) -> Array:
    """A direction (N,), raw, towards growing parameter; where that does not change, of the first unknown that moves.

    scale : (N,), in whose units the direction is measured.
    """
    scaled = direction / scale
    sizes = np.abs(scaled)
    moving = sizes.size - 1 if sizes[-1] > LEVEL * norm(scaled) else int(np.argmax(sizes > MOVES * sizes.max()))
    return -direction if scaled[moving] < 0.0 else direction
