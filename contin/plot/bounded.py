"""The part of a picture where branches are bounded: one that runs to infinity must not flatten all others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.abi import Array

COVERED: Final = 0.95  # part of the horizontal way whose values are shown whatever happens
RUNAWAY: Final = 6.0  # times that extent: what reaches farther is cut off
ROOM: Final = 0.5  # of that extent is left beyond it


def bounded(curves: Sequence[tuple[Array, Array]], marks: Array) -> tuple[float, float] | None:
    """Vertical limits that leave out the runaway part of curves (x, y); None where nothing runs away.

    The values of y are weighted by the horizontal way dx over which they are taken (a branch that goes to infinity at
    a finite parameter spends next to none there); marked points are always shown.
    """
    parts = [_weighted(x, y) for x, y in curves if len(x) > 1]
    if not parts:
        return None
    values, weights = np.concatenate([v for v, _ in parts]), np.concatenate([w for _, w in parts])
    finite = np.isfinite(values) & np.isfinite(weights)
    values, weights = values[finite], weights[finite]
    if not len(values) or not weights.sum() > 0:
        return None
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    rest = (1.0 - COVERED) / 2
    low, high = values[order][np.searchsorted(share, rest)], values[order][np.searchsorted(share, 1.0 - rest)]
    shown = marks[np.isfinite(marks)]
    low, high = min([low, *shown]), max([high, *shown])
    extent = high - low
    if not extent > 0 or np.ptp(values) <= RUNAWAY * extent:
        return None
    reached = np.concatenate([y[np.isfinite(y)] for _, y in curves])
    margin, edge = ROOM * extent, 0.1 * ROOM * extent
    return max(float(reached.min()) - edge, low - margin), min(float(reached.max()) + edge, high + margin)


def _weighted(x: Array, y: Array) -> tuple[Array, Array]:
    """Middles of the segments and the horizontal way of each."""
    return (y[1:] + y[:-1]) / 2, np.abs(np.diff(x))
