"""Where to write the name of a region: as far from its border as possible."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.abi import Array

GRID = 40  # candidates along each side of the region's bounding box
EDGES = 4000  # of a border, at most: longer ones are sampled


def deepest(rings: Sequence[Array], window: Array | None = None) -> tuple[Array, float]:
    """The candidate inside the rings (even-odd) that is farthest from them, and its distance; (nan, 0) without one.

    window : lower and upper corner (2, 2) of what is seen: candidates are in it, and far from its border too.

    Cost: `GRID`^2 candidates times the number of edges.
    """
    from matplotlib.path import Path

    low, high = rings[0].min(axis=0), rings[0].max(axis=0)
    if window is not None:
        low, high = np.maximum(low, window[0]), np.minimum(high, window[1])
        if not np.all(low < high):
            return np.full(2, np.nan), 0.0
    u = (np.arange(GRID) + 0.5) / GRID
    x, y = np.meshgrid(low[0] + u * (high[0] - low[0]), low[1] + u * (high[1] - low[1]))
    candidates = np.column_stack([x.ravel(), y.ravel()])
    odd = np.zeros(len(candidates), bool)
    for ring in rings:
        odd ^= Path(ring).contains_points(candidates)
    candidates = candidates[odd]
    if not len(candidates):
        return np.full(2, np.nan), 0.0
    nearest = np.full(len(candidates), np.inf)
    if window is not None:
        nearest = np.minimum(candidates - window[0], window[1] - candidates).min(axis=1)
    for ring in rings:
        corners = ring[:: max(1, len(ring) // EDGES)]
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            d = b - a
            t = np.clip((candidates - a) @ d / max(float(d @ d), 1e-300), 0.0, 1.0)
            nearest = np.minimum(nearest, np.hypot(*(candidates - a - t[:, None] * d).T))
    best = int(np.argmax(nearest))
    return candidates[best], float(nearest[best])
