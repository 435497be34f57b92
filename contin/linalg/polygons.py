"""Polygons with holes in the plane, as closed rings (k, 2): what is inside, and how far from the border."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

GRID = 40  # candidates along each side of a bounding box
ROUNDING = 1e-12  # of the box: a candidate nearer to the border is on it


def inside(points: Array, rings: Sequence[Array]) -> NDArray[np.bool_]:
    """Which of the points (k, 2) are inside, by the even-odd rule over all rings together."""
    odd = np.zeros(len(points), bool)
    x, y = points[:, 0, None], points[:, 1, None]
    for ring in rings:
        a, b = ring, np.roll(ring, -1, axis=0)
        rises = (a[None, :, 1] > y) != (b[None, :, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = a[None, :, 0] + (y - a[None, :, 1]) / (b[None, :, 1] - a[None, :, 1]) * (b[None, :, 0] - a[None, :, 0])
        odd ^= (np.sum(rises & (x < at), axis=1) % 2).astype(bool)
    return odd


def clearance(points: Array, rings: Sequence[Array]) -> Array:
    """Distance of each point from the nearest edge of the rings."""
    best = np.full(len(points), np.inf)
    for ring in rings:
        a, d = ring, np.roll(ring, -1, axis=0) - ring
        length = np.maximum(np.sum(d * d, axis=1), 1e-300)
        for first in range(0, len(ring), 300):
            part = slice(first, first + 300)
            offset = points[:, None, :] - a[None, part, :]
            t = np.clip(np.sum(offset * d[None, part], axis=2) / length[None, part], 0.0, 1.0)
            gap = offset - t[..., None] * d[None, part]
            best = np.minimum(best, np.sqrt(np.min(np.sum(gap * gap, axis=2), axis=1)))
    return best


def deepest(rings: Sequence[Array], window: Array | None = None, grid: int = GRID) -> tuple[Array, float] | None:
    """Of grid^2 candidates in the bounding box the one inside that is farthest from the border, and how far.

    window : lower and upper corner (2, 2) of what is seen: candidates are in it, and far from its border too. None
    where no candidate is inside.
    """
    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    if window is not None:
        low, high = np.maximum(low, window[0]), np.minimum(high, window[1])
        if not np.all(low < high):
            return None
    u = (np.arange(grid) + 0.5) / grid
    x, y = np.meshgrid(low[0] + u * (high[0] - low[0]), low[1] + u * (high[1] - low[1]))
    candidates = np.column_stack([x.ravel(), y.ravel()])
    candidates = candidates[inside(candidates, rings)]
    if not len(candidates):
        return None
    distances = clearance(candidates, rings)
    if window is not None:
        distances = np.minimum(distances, np.minimum(candidates - window[0], window[1] - candidates).min(axis=1))
    best = int(np.argmax(distances))
    if not distances[best] > ROUNDING * float(np.max(high - low)):  # on the border
        return None
    return candidates[best], float(distances[best])
