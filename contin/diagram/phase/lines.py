"""Curves of special points as polylines in the unit square, ready to cut it into regions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch

Box = tuple[tuple[float, float], tuple[float, float]]

PARTS: Final = 4  # segments between two rows
BULGE: Final = 0.3  # of a step's length: a cubic that leaves the chord by more is not trusted
GAP: Final = 0.02  # an end of a curve that could not be followed is joined to what is this near
CONTINUED: Final = frozenset({"corrector", "degenerate", "steps"})


def polylines(loci: Sequence[Branch], box: Box) -> tuple[list[Array], list[int]]:
    """Polylines without neutral saddles (which change nothing), and the number of the curve that each belongs to."""
    lines: list[Array] = []
    owners: list[int] = []
    for number, branch in enumerate(loci):
        points = unit(branch.z[:, [-1, -2]], box)
        slopes = _slopes(branch, box)
        shown = ~np.asarray(branch.columns.get("neutral", np.zeros(len(points), bool)), bool)
        for p in branch.points:
            if p.type in ("BT", "R1", "R2"):
                shown[p.index] = True
        for piece in np.split(np.arange(len(points)), np.flatnonzero(np.diff(shown.astype(int))) + 1):
            if shown[piece[0]] and len(piece) > 1:
                lines.append(np.clip(_cubic(points[piece], slopes[0][piece[:-1]], slopes[1][piece[:-1]]), 0.0, 1.0))
                owners.append(number)
    return _closed_gaps(lines, owners, loci, box), owners


def unit(points: Array, box: Box) -> Array:
    """Points of the box in coordinates in which it is the unit square."""
    low = np.array([b[0] for b in box])
    width = np.array([b[1] - b[0] for b in box])
    return np.asarray((points - low) / width)


def _slopes(branch: Branch, box: Box) -> tuple[Array, Array]:
    """Derivatives of the two parameters along each step, at its beginning and its end, per step length."""
    curve: Any = branch.problem.curve
    width = np.array([b[1] - b[0] for b in box])
    scale = np.concatenate([curve.sizes, width[::-1]])
    keep = [*range(curve.n), -2, -1]
    z, t = branch.z[:, keep] / scale, branch.tangents[:, keep] / scale
    t = t / np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-300)
    chord = np.diff(z, axis=0)
    pair = [-1, -2]
    begin = np.sum(chord * t[:-1], axis=1)[:, None] * t[:-1][:, pair]
    end = np.sum(chord * t[1:], axis=1)[:, None] * t[1:][:, pair]
    return np.asarray(begin), np.asarray(end)


def _cubic(points: Array, begin: Array, end: Array) -> Array:
    """The cubic Hermite curve through the rows, `PARTS` segments each; a straight line where it would bulge."""
    a, b = points[:-1], points[1:]
    chord = b - a
    size = np.linalg.norm(chord, axis=1)
    wild = np.maximum(np.linalg.norm(begin - chord, axis=1), np.linalg.norm(end - chord, axis=1)) > BULGE * size
    begin, end = np.where(wild[:, None], chord, begin), np.where(wild[:, None], chord, end)
    parts = []
    for k in range(PARTS):
        s = k / PARTS
        parts.append(
            a * (1 - 3 * s**2 + 2 * s**3)
            + b * (3 * s**2 - 2 * s**3)
            + begin * (s - 2 * s**2 + s**3)
            + end * (s**3 - s**2)
        )
    rows = np.stack(parts, axis=1).reshape(-1, 2)
    return np.vstack([rows, points[-1:]])


def _closed_gaps(lines: list[Array], owners: list[int], loci: Sequence[Branch], box: Box) -> list[Array]:
    """Ends of curves that the corrector could not follow to the degenerate point they lead to, led there."""
    result = list(lines)
    marked = [unit(p.z[[-1, -2]][None], box)[0] for branch in loci for p in branch.points]
    for k, (line, owner) in enumerate(zip(lines, owners, strict=True)):
        first, last = loci[owner].ends
        for end, row in ((first, 0), (last, -1)):
            if end.reason not in CONTINUED or (row == 0) != (end is first):
                continue
            others = [m for j, m in enumerate(lines) if j != k]
            target = _nearest(line[row], marked, others)
            if target is not None:
                line = np.vstack([target[None], line]) if row == 0 else np.vstack([line, target[None]])
        result[k] = line
    return result


def _nearest(point: Array, marked: Sequence[Array], lines: Sequence[Array]) -> Array | None:
    """The nearest labelled point within `GAP`, else the nearest vertex of another curve."""
    for candidates in (marked, [row for line in lines for row in line]):
        if len(candidates):
            gaps = np.linalg.norm(np.array(candidates) - point, axis=1)
            best = int(np.argmin(gaps))
            if 0.0 < gaps[best] <= GAP:
                return np.asarray(candidates[best])
    return None
