"""Curves between computed rows: splines through all of them, so that a branch of few points does not look polygonal."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np

from contin.abi import Array

PARTS: Final = 8  # drawn segments between two rows
CORNER: Final = np.cos(np.deg2rad(45.0))  # a sharper turn is a corner of the curve, not a coarse step
FINE: Final = 2e-3  # rows closer than this part of the picture are joined by straight lines


def smooth(x: Array, y: Array, extent: tuple[float, float]) -> tuple[Array, Array]:
    """The curve through the rows (x, y), each of them exactly, with `PARTS` segments between two rows.

    A centripetal Catmull-Rom spline (Barry and Goldman 1988; it makes no loops and no cusps between its points: Yuksel,
    Schaefer and Keyser 2011), measured in parts of the picture's width and height `extent`. It is only how the picture
    is drawn: data, labels and files hold computed rows.
    """
    scale = np.array(extent)
    points = np.stack([x, y], axis=1) / scale
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    keep = np.concatenate([[True], lengths > 1e-9])  # repeated rows have no direction
    if np.count_nonzero(keep) < 4 or not np.isfinite(lengths).all() or np.median(lengths) < FINE:
        return x, y
    points = points[keep]
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    turns = np.sum(steps[:-1] * steps[1:], axis=1) / (lengths[:-1] * lengths[1:])
    corners = [0, *(np.flatnonzero(turns < CORNER) + 1), len(points) - 1]
    parts = [_spline(points[a : b + 1]) for a, b in pairwise(corners)]
    drawn = np.vstack([*(part[:-1] for part in parts), points[-1:]]) * scale
    return drawn[:, 0], drawn[:, 1]


def _spline(points: Array) -> Array:
    """The spline through a corner-free run of points."""
    if len(points) < 3:
        return points
    extended = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    knots = np.sqrt(np.hypot(*np.diff(extended, axis=0).T))  # centripetal: the square root of the distance
    p0, p1, p2, p3 = (extended[k : len(extended) - 3 + k, None] for k in range(4))
    d1, d2, d3 = (knots[k : len(knots) - 2 + k, None, None] for k in range(3))
    s = np.linspace(0.0, 1.0, PARTS, endpoint=False)[None, :, None]
    m1 = d2 * ((p1 - p0) / d1 - (p2 - p0) / (d1 + d2) + (p2 - p1) / d2)
    m2 = d2 * ((p2 - p1) / d2 - (p3 - p1) / (d2 + d3) + (p3 - p2) / d3)
    cubic = (2 * (p1 - p2) + m1 + m2) * s**3 + (3 * (p2 - p1) - 2 * m1 - m2) * s**2 + m1 * s + p1
    spline: Array = np.vstack([cubic.reshape(-1, 2), points[-1:]])
    return spline
