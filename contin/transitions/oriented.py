"""The sense in which a branch that is born is followed first."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm

LEVEL: Final = 1e-6  # part of a direction below which the parameter does not change along it


def oriented(direction: Array, scale: Array) -> Array:
    """A direction (N,), raw, towards growing parameter; where that does not change, that of its largest entry.

    scale : (N,), in whose units the direction is measured.
    """
    scaled = direction / scale
    lead = direction[-1] if abs(scaled[-1]) > LEVEL * norm(scaled) else 0.0
    backwards = lead < 0.0 or (lead == 0.0 and direction[int(np.argmax(np.abs(direction)))] < 0.0)
    return -direction if backwards else direction
