"""How far the equations of a model hold, where it is an approximation (an averaged one)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.systems.protocol import System



def left_reach(system: System, states: Array, parameters: Array) -> tuple[int, str] | None:
    """The first of N points at which the model's equations do not hold, and why; None where they hold at all.

    system : compiled.  states : (N, n), parameters : (N, p_size).
    """
    if not system.limits or not len(states):
        return None
    margins = system.margins(np.ascontiguousarray(states), np.ascontiguousarray(parameters))
    broken = ~(margins >= 0.0)
    rows = np.flatnonzero(broken.any(axis=1))
    if not rows.size:
        return None
    row = int(rows[0])
    return row, str(system.limits[int(np.argmax(broken[row]))].beyond)
