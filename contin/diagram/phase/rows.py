"""Few lines across the box that pass through many regions: one exploration then serves all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.diagram.phase.plane import Face
from contin.linalg.polygons import clearance

ENOUGH: Final = 0.4  # of the distance from the border that a face's own inner point has


def common_rows(faces: Sequence[Face]) -> list[list[tuple[int, Array]]]:
    """Rows, each with the faces it serves: their number and the point of the face on the row, well inside it.

    Greedy: of the heights of the faces' own points, the one through most of the faces that are left is next.
    Cost: the square of the number of faces.
    """
    points: dict[tuple[int, int], Array] = {}
    for j, other in enumerate(faces):
        for k, face in enumerate(faces):
            found = face.point if j == k else _on_row(face, float(other.point[1]))
            if found is not None:
                points[j, k] = found
    left = set(range(len(faces)))
    rows: list[list[tuple[int, Array]]] = []
    while left:
        served = {j: [k for k in left if (j, k) in points] for j in range(len(faces))}
        best = max(left, key=lambda j: (len(served[j]), -j))
        rows.append([(k, points[best, k]) for k in sorted(served[best])])
        left -= set(served[best])
    return rows


def _on_row(face: Face, height: float) -> Array | None:
    """The middle of the widest part of the face at this height, where it is far enough from the border."""
    crossings = []
    for ring in (face.outline, *face.holes):
        a, b = ring, np.roll(ring, -1, axis=0)
        cut = (a[:, 1] > height) != (b[:, 1] > height)
        a, b = a[cut], b[cut]
        crossings += (a[:, 0] + (height - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])).tolist()
    if not crossings:
        return None
    ends = np.sort(crossings).reshape(-1, 2)
    left, right = ends[np.argmax(ends[:, 1] - ends[:, 0])]
    point = np.array([0.5 * (left + right), height])
    rings = [face.outline, *face.holes]
    near, own = clearance(np.array([point, face.point]), rings)
    return point if near >= ENOUGH * own else None
