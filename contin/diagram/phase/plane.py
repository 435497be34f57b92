"""The planar arrangement of curves in a box: where they cut it into regions, and which regions are neighbours.

The faces of the planar graph of `nodes` are traced with the face on the left of every half-edge. Faces too thin to hold
a point of their own (between curves that touch) join the neighbour with which they share the longest border.
Coordinates are scaled: the box is [0, 1] x [0, 1].
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from typing import Final

import numpy as np

from contin.abi import Array
from contin.diagram.phase.nodes import Edges, noded
from contin.linalg.polygons import deepest, inside
from contin.machine import elementary

SMALLEST: Final = 2e-6  # a face with less area is a sliver
THINNEST: Final = 2e-4  # so is one in which no point is farther than this from the border
GRID: Final = 28  # candidates for a face's inner point, along each side of its bounding box


@dataclass(frozen=True, eq=False)
class Face:
    """A region: its outline and holes (closed polygons, (k, 2)), area, and a point well inside."""

    outline: Array
    holes: tuple[Array, ...]
    area: float
    point: Array


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Faces, and for every pair of neighbours (i < j) the numbers of the curves between them."""

    faces: tuple[Face, ...]
    borders: Mapping[tuple[int, int], frozenset[int]]


def arrangement(curves: Sequence[Array], smallest: float = SMALLEST) -> Arrangement:
    """Cut the unit square by polylines (k, 2); faces with less than the `smallest` area join a neighbour.

    Cost: the square of the number of segments, a comparison each.
    """
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    vertices, edges = noded([corners, *curves])
    numbered = {edge: {owner - 1 for owner in owners if owner > 0} for edge, owners in edges.items()}
    cycles, side = _trace(vertices, edges)
    return _assembled(vertices, numbered, cycles, side, smallest)


def _trace(vertices: Array, edges: Edges) -> tuple[list[list[int]], dict[tuple[int, int], int]]:
    """Cycles of vertices with their face on the left, and the cycle of every half-edge."""
    neighbours: dict[int, list[int]] = defaultdict(list)
    for i, j in edges:
        neighbours[i].append(j)
        neighbours[j].append(i)
    following: dict[tuple[int, int], int] = {}
    for v, around in neighbours.items():
        directions = vertices[around] - vertices[v]
        ordered = [around[k] for k in np.argsort(elementary.atan2(directions[:, 1], directions[:, 0]))]
        for k, u in enumerate(ordered):
            following[u, v] = ordered[k - 1]  # coming from u, turn to the next neighbour clockwise
    cycles: list[list[int]] = []
    side: dict[tuple[int, int], int] = {}
    for start in following:
        if start in side:
            continue
        cycle = []
        u, v = start
        while (u, v) not in side:
            side[u, v] = len(cycles)
            cycle.append(u)
            u, v = v, following[u, v]
        cycles.append(cycle)
    return cycles, side


def _assembled(
    vertices: Array, edges: Edges, cycles: list[list[int]], side: dict[tuple[int, int], int], smallest: float
) -> Arrangement:
    areas = [_area(vertices[cycle]) for cycle in cycles]
    inner = [k for k, area in enumerate(areas) if area > 0.0]
    home: dict[int, int] = {k: k for k in inner}
    holes: dict[int, list[int]] = defaultdict(list)
    low, high = (np.array([edge(vertices[cycles[m]], axis=0) for m in inner]) for edge in (np.min, np.max))
    for k in [k for k, area in enumerate(areas) if area <= 0.0]:
        point, own = vertices[cycles[k][0]], set(cycles[k])
        near = np.flatnonzero(np.all((low <= point) & (point <= high), axis=1))
        around = [
            m
            for m in (inner[j] for j in near)
            if areas[m] > -areas[k] and not own & set(cycles[m]) and inside(point[None], [vertices[cycles[m]]])[0]
        ]
        if around:
            home[k] = min(around, key=lambda m: areas[m])
            holes[home[k]].append(k)
    rings = {k: [vertices[cycles[k]], *(vertices[cycles[h]] for h in holes[k])] for k in inner}
    size = {k: areas[k] + sum(areas[h] for h in holes[k]) for k in inner}
    points = {k: _inner_point(rings[k]) if size[k] > smallest else None for k in inner}
    length: dict[tuple[int, int], float] = defaultdict(float)
    for i, j in edges:
        pair = tuple(sorted(home.get(side[e], -1) for e in ((i, j), (j, i))))
        if -1 not in pair and pair[0] != pair[1]:
            length[pair[0], pair[1]] += float(np.linalg.norm(vertices[i] - vertices[j]))
    final = _joined(points, length)
    kept = [k for k in inner if points[k] is not None]
    number = {k: n for n, k in enumerate(kept)}
    borders: dict[tuple[int, int], set[int]] = defaultdict(set)
    across: dict[tuple[int, int], set[int]] = defaultdict(set)  # with a sliver between them
    for (i, j), owners in edges.items():
        cells = [home.get(side[e], -1) for e in ((i, j), (j, i))]
        left, right = (number.get(final.get(cell, -1), -1) for cell in cells)
        if owners and left >= 0 and right >= 0 and left != right:
            found = borders if all(final.get(cell) == cell for cell in cells) else across
            found[min(left, right), max(left, right)] |= owners
    borders = {**across, **borders}
    faces = tuple(Face(rings[k][0], tuple(rings[k][1:]), size[k], _point(points[k])) for k in kept)
    return Arrangement(faces, {pair: frozenset(found) for pair, found in borders.items()})


def _point(found: Array | None) -> Array:
    assert found is not None
    return found


def _joined(points: Mapping[int, Array | None], length: Mapping[tuple[int, int], float]) -> dict[int, int]:
    """The face that each face is counted with: itself, or for slivers the neighbour with the longest common border."""
    beside: dict[int, list[tuple[float, int]]] = defaultdict(list)
    for (i, j), border in length.items():
        beside[i].append((-border, j))
        beside[j].append((-border, i))
    final = {k: k for k, point in points.items() if point is not None}
    waiting = [(border, thin, k) for k in final for border, thin in beside[k] if thin not in final]
    heapify(waiting)
    while waiting:
        _, thin, other = heappop(waiting)
        if thin not in final:
            final[thin] = final[other]
            for border, further in beside[thin]:
                if further not in final:
                    heappush(waiting, (border, further, thin))
    return final


def _area(ring: Array) -> float:
    x, y = ring[:, 0], ring[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _inner_point(rings: Sequence[Array]) -> Array | None:
    """The point of the face that is farthest from its border; None where the face is too thin for one."""
    for grid in (GRID, 4 * GRID):
        found = deepest(rings, grid=grid)
        if found is not None and found[1] > THINNEST:
            return found[0]
    return None
