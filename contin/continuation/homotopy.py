"""Homotopy: what a point is off by is taken away in steps as long as Newton's method can follow."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array

SHORTEST: Final = 1.0 / 256.0


def without_offset(z: Array, off: Array, solved: Callable[[Array, Array], Array | None]) -> Array | None:
    """From z, which meets c(z) = off, to a point of c = 0; None where Newton's method cannot follow.

    solved : (offset, guess) -> a point of c = offset, or None.
    """
    if not np.all(np.isfinite(off)):
        return None
    done, step = 0.0, 1.0
    while done < 1.0:
        share = min(1.0, done + step)
        found = solved((1.0 - share) * off, z)
        if found is None:
            step *= 0.5
            if step < SHORTEST:
                return None
            continue
        z, done, step = found, share, 2.0 * step
    return z
