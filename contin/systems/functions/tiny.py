"""Unknowns far smaller than others: sizes of their own, or zeros that rounding has left its mark on.

Steps in proportion to 1e-16 have no digits where values are near 1, and nothing tells beforehand which of both such an
unknown is: wider steps are tried where those of its own size lose digits, and taken where they agree with what is left.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector

FAR: Final = 1e3  # times smaller
WIDER: Final = 100.0  # from one step to the next
LOST: Final = 1e-9  # of the largest component: rounding errors of a derivative that are worth wider steps
AGREE: Final = 64.0  # rounding errors, which are those of sums

Wider = Callable[[float], tuple[Vector, Array, NDArray[np.bool_]]]


def room(sizes: Array, v: Vector, reach: float) -> float:
    """How many times wider steps along v may be: until an unknown changes by the size of the largest; 1 if not FAR.

    sizes : of the unknowns, as many as v has.  reach : over which one of them changes by its own.
    """
    times = float(np.max(sizes)) / float(np.max(np.abs(v))) / reach
    return times if times > FAR else 1.0


def with_more_digits(
    best: Vector, lost: Array, wider: Wider, room: float, taken: Callable[[float], object] = lambda times: None
) -> tuple[Vector, Array]:  # fmt: skip
    """A derivative whose rounding errors are about `lost`, or what wider steps make of it, and what those then are.

    wider : times -> the derivative by steps so many times as wide, its rounding errors, and where it has converged.
    taken : told the times from which some component is.
    """
    times = 1.0
    while room > times:
        known = np.isfinite(best)
        if not np.any(lost[known] > LOST * np.max(np.abs(best[known]), initial=0.0)):
            break
        times = min(times * WIDER, room)
        found, rounding, settled = wider(times)
        better = settled & (rounding < lost) & (np.abs(found - best) <= AGREE * lost)
        if better.any():
            taken(times)
        best, lost = np.where(better, found, best), np.where(better, rounding, lost)
    return best, lost
