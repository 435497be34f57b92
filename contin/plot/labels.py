"""Where to write the labels of marked points so that they hide neither one another nor the curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.abi import Array

# Sixteen directions, and three distances in units of the text height: near is tried first.
_ANGLES: Final = np.deg2rad(
    [45, 135, -45, -135, 90, -90, 0, 180, 22.5, 67.5, 112.5, 157.5, -22.5, -67.5, -112.5, -157.5]
)
_DISTANCES: Final = (1.2, 1.8, 2.6, 3.6)
_LABEL_WEIGHT: Final = 60.0  # a label on a label is the worst,
_MARKER_WEIGHT: Final = 12.0  # on another marker is bad,
_CURVE_WEIGHT: Final = 1.0  # and each vertex of a curve under it is a little bad


def place(anchors: Array, sizes: Array, obstacles: Array, frame: tuple[float, float, float, float]) -> Array:
    """Centres of the label boxes, in the units of `anchors` (pixels); NaN for a label that has no room.

    Greedy: labels in the given order, each at the candidate with the least overlap with labels placed before, with all
    markers, and with the curves. Cost: labels x candidates x (labels + obstacles).

    Parameters
    ----------
    anchors : (k, 2) array
        The marked points.
    sizes : (k, 2) array
        Width and height of each text.
    obstacles : (m, 2) array
        Points of the curves, dense enough that a box over a curve holds some.
    frame : (left, bottom, right, top)
        The axes; a label outside is never chosen while one inside is free.
    """
    centres = np.empty_like(anchors)
    boxes = np.empty((0, 4))
    for k, (anchor, size) in enumerate(zip(anchors, sizes, strict=True)):
        candidates = _candidates(anchor, size)
        half = size / 2
        low, high = candidates - half, candidates + half
        cost = _CURVE_WEIGHT * _inside(obstacles, low, high) + _MARKER_WEIGHT * _inside(anchors, low - 4, high + 4)
        cost += _LABEL_WEIGHT * _overlaps(boxes, low - 1, high + 1)
        left, bottom, right, top = frame
        outside = (low[:, 0] < left) | (low[:, 1] < bottom) | (high[:, 0] > right) | (high[:, 1] > top)
        cost += 40.0 * outside + 0.01 * np.arange(len(candidates))  # ties go to the nearest
        best = int(np.argmin(cost))
        if cost[best] >= _LABEL_WEIGHT:  # on another label it could not be read
            centres[k] = np.nan
            continue
        centres[k] = candidates[best]
        boxes = np.vstack([boxes, [*low[best], *high[best]]])
    return centres


def _candidates(anchor: Array, size: Array) -> Array:
    directions = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1)
    reach = np.array([size[0] / 2, size[1] / 2])
    return np.vstack([anchor + directions * (reach + distance * size[1] * 0.75) for distance in _DISTANCES])


def _inside(points: Array, low: Array, high: Array) -> Array:
    """How many of the points each box holds."""
    if not len(points):
        return np.zeros(len(low))
    within = (points[None] >= low[:, None]) & (points[None] <= high[:, None])
    counts: Array = np.count_nonzero(within.all(axis=2), axis=1).astype(float)
    return counts


def _overlaps(boxes: Array, low: Array, high: Array) -> Array:
    """How many of the boxes each candidate box touches."""
    if not len(boxes):
        return np.zeros(len(low))
    apart = (boxes[None, :, 0] > high[:, None, 0]) | (boxes[None, :, 2] < low[:, None, 0])
    apart |= (boxes[None, :, 1] > high[:, None, 1]) | (boxes[None, :, 3] < low[:, None, 1])
    counts: Array = np.count_nonzero(~apart, axis=1).astype(float)
    return counts


def merged(labels: Sequence[tuple[str, int]], anchors: Array, distance: float) -> list[tuple[int, str]]:
    """One label for neighbouring points of one type within `distance`: (index of the first point, 'LP1-3').

    `labels` are (type, number).
    """
    groups: list[list[int]] = []
    for k, (kind, _) in enumerate(labels):
        for group in groups:
            if labels[group[0]][0] == kind and np.hypot(*(anchors[group[-1]] - anchors[k])) <= distance:
                group.append(k)
                break
        else:
            groups.append([k])
    texts = []
    for group in groups:
        kind, numbers = labels[group[0]][0], sorted({labels[k][1] for k in group})
        texts.append((group[0], f"{kind}{numbers[0]}" if len(numbers) == 1 else f"{kind}{numbers[0]}-{numbers[-1]}"))
    return texts


def densify(curves: Sequence[Array], spacing: float) -> Array:
    """Points along polylines, at most about `spacing` apart."""
    points = [np.empty((0, 2))]
    for curve in curves:
        if len(curve) < 2:
            points.append(curve)
            continue
        lengths = np.hypot(*np.diff(curve, axis=0).T)
        position = np.concatenate([[0.0], np.cumsum(lengths)])
        count = min(int(position[-1] / spacing) + 2, 4000)
        at = np.linspace(0.0, position[-1], count)
        points.append(np.stack([np.interp(at, position, curve[:, 0]), np.interp(at, position, curve[:, 1])], axis=1))
    return np.vstack(points)
