"""Polylines in the plane cut at their crossings: vertices and edges, each edge with the curves that run along it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary

MERGED: Final = 1e-6  # vertices nearer than this are one, and a vertex nearer than this to an edge is on it
BLOCK: Final = 500  # segments whose crossings are looked for at once
Edges: TypeAlias = dict[tuple[int, int], set[int]]  # (a, b) with a < b: the numbers of the curves


def noded(lines: Sequence[Array]) -> tuple[Array, Edges]:
    """Distinct vertices (k, 2) and edges of polylines (m, 2); parts where polylines coincide are one edge."""
    a = np.concatenate([line[:-1] for line in lines])
    b = np.concatenate([line[1:] for line in lines])
    owner = np.concatenate([np.full(len(line) - 1, number) for number, line in enumerate(lines)])
    cuts = _cuts(a, b)
    vertices = _Vertices()
    edges: Edges = defaultdict(set)
    for k in range(len(a)):
        inner = [t for t in cuts[k] if 0.0 < t < 1.0] if k in cuts else []
        along = np.unique([0.0, *inner, 1.0])
        numbers = [vertices.number(a[k] + t * (b[k] - a[k])) for t in along]
        for i, j in pairwise(numbers):
            if i != j:
                edges[min(i, j), max(i, j)].add(int(owner[k]))
    return vertices.array(), dict(edges)


class _Vertices:
    """Points by number; one that is nearer than `MERGED` to a known one is that one."""

    def __init__(self) -> None:
        self.points: list[Array] = []
        self.cells: dict[tuple[int, int], list[int]] = defaultdict(list)

    def number(self, point: Array) -> int:
        column, row = round(point[0] / MERGED), round(point[1] / MERGED)
        for x in (column, column - 1, column + 1):
            for y in (row, row - 1, row + 1):
                for known in self.cells.get((x, y), ()):
                    if float(np.abs(self.points[known] - point).max()) <= MERGED:
                        return known
        self.cells[column, row].append(len(self.points))
        self.points.append(point)
        return len(self.points) - 1

    def array(self) -> Array:
        return np.array(self.points)


def _cuts(a: Array, b: Array) -> dict[int, list[float]]:
    """For segments that others cross or touch, where: parts of the way from a to b."""
    low, high = np.minimum(a, b) - MERGED, np.maximum(a, b) + MERGED
    cuts: dict[int, list[float]] = defaultdict(list)
    for first in range(0, len(a), BLOCK):
        block = slice(first, first + BLOCK)
        near = (low[block, None, 0] <= high[None, :, 0]) & (high[block, None, 0] >= low[None, :, 0])
        near &= (low[block, None, 1] <= high[None, :, 1]) & (high[block, None, 1] >= low[None, :, 1])
        i, j = np.nonzero(near)
        i, j = i[i + first != j] + first, j[i + first != j]
        for segment, part in zip(*_touches(a, b, i, j), strict=True):
            cuts[int(segment)].append(float(part))
    return cuts


def _touches(a: Array, b: Array, i: NDArray[np.int64], j: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
    """(segment i, part of it) where segment j crosses it, or has an end on it."""
    d, e, offset = b[i] - a[i], b[j] - a[j], a[j] - a[i]
    across = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    size_d, size_e = elementary.hypot(*d.T), elementary.hypot(*e.T)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (offset[:, 0] * e[:, 1] - offset[:, 1] * e[:, 0]) / across
        s = (offset[:, 0] * d[:, 1] - offset[:, 1] * d[:, 0]) / across
    slack = MERGED / np.maximum(size_e, MERGED)
    crossing = (np.abs(across) > 1e-9 * size_d * size_e) & (s > -slack) & (s < 1.0 + slack) & (t > 0.0) & (t < 1.0)
    found, parts = [i[crossing]], [t[crossing]]
    for end in (a[j], b[j]):
        way = end - a[i]
        part = np.sum(way * d, axis=1) / np.maximum(elementary.square(size_d), 1e-300)
        gap = elementary.hypot(*(way - part[:, None] * d).T)
        on = (gap <= MERGED) & (part > 0.0) & (part < 1.0)
        found.append(i[on])
        parts.append(part[on])
    return np.concatenate(found), np.concatenate(parts)
