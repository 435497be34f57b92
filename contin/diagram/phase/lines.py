"""Curves of special points as polylines in the unit square, ready to cut it into regions."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.seed import Seed
from contin.diagram.phase.nodes import MERGED
from contin.machine import elementary

Box = tuple[tuple[float, float], tuple[float, float]]

PARTS: Final = 4  # segments between two rows
BULGE: Final = 0.3  # of a step's length: a cubic that leaves the chord by more is not trusted
THIN: Final = 3e-5  # how far a curve of orbits may lie from the polyline that stands for it
GAP: Final = 0.02  # an end of a curve that could not be followed is joined to what is this near
CONTINUED: Final = frozenset({"corrector", "degenerate", "steps", "hopf", "bt", "saddle-node"})


def polylines(loci: Sequence[Branch], box: Box) -> tuple[list[Array], list[int]]:
    """Polylines without neutral saddles (which change nothing), and the number of the curve that each belongs to."""
    lines: list[Array] = []
    owners: list[int] = []
    loose: list[tuple[bool, bool]] = []  # first and last ends of lines that have not reached where they lead to
    for number, branch in enumerate(loci):
        points = unit(branch.z[:, [-1, -2]], box)
        slopes = _slopes(branch, points, box)
        shown = ~np.asarray(branch.columns.get("neutral", np.zeros(len(points), bool)), bool)
        for p in branch.points:
            if p.type in ("BT", "R1", "R2"):
                shown[p.index] = True
        lost = [end.reason in CONTINUED for end in branch.ends]
        for piece in np.split(np.arange(len(points)), np.flatnonzero(np.diff(shown.astype(int))) + 1):
            if shown[piece[0]] and len(piece) > 1:
                line = np.clip(_cubic(points[piece], slopes[0][piece[:-1]], slopes[1][piece[:-1]]), 0.0, 1.0)
                line = thinned(line) if is_orbital(branch) else _apart(line)
                whole = np.vstack([*_birthplace(branch, loci, box), line]) if piece[0] == 0 else line
                parts = _split_at_tips(whole) if len(whole) > 1 else []  # none of states that all lie at one place
                first, last = lost[0] or piece[0] > 0, lost[1] or piece[-1] < len(points) - 1
                for k, part in enumerate(parts):
                    lines.append(part)
                    owners.append(number)
                    loose.append((first or k > 0, last or k < len(parts) - 1))
    return _closed_gaps(lines, owners, loose, loci, box), owners


def _apart(line: Array) -> Array:
    """The polyline without vertices that the arrangement does not tell from the one before: rows may heap up."""
    kept = [0]
    for k in range(1, len(line)):
        if float(np.abs(line[k] - line[kept[-1]]).max()) > MERGED:
            kept.append(k)
    if len(kept) > 1:
        kept[-1] = len(line) - 1  # its end as it is
    return np.asarray(line[kept])


def _split_at_tips(line: Array) -> list[Array]:
    """The polyline cut where it turns back onto itself.

    In the plane, a curve of states that a symmetry maps onto each other (declared or not) ends where they meet, at a
    point of a curve of branch points, and comes back the way it went: in between two rows, as a rule, so that it does
    not touch what it ends at.
    """
    way = np.diff(line, axis=0)
    back = np.flatnonzero(np.sum(way[1:] * way[:-1], axis=1) < 0.0) + 1
    tips = [int(k) for k in back if _is_retraced(line, int(k))]
    return [line[a : b + 1] for a, b in pairwise([0, *tips, len(line) - 1]) if b > a]


def _is_retraced(line: Array, k: int) -> bool:
    """True where the polyline's ways from vertex k, both ways, are one as far as the shorter of their segments goes."""
    before, after = line[k - 1] - line[k], line[k + 1] - line[k]
    short, long = sorted((before, after), key=lambda way: float(way @ way))
    aside = abs(float(short[0] * long[1] - short[1] * long[0])) / max(float(np.linalg.norm(long)), 1e-300)
    return aside <= THIN


def _birthplace(branch: Branch, loci: Sequence[Branch], box: Box) -> list[Array]:
    """Where a curve of connecting orbits was born, which it cannot be followed down to."""
    if branch.locus == "HOM" and branch.parent is not None:
        for other in loci:
            if other.name == branch.parent.branch:
                return [unit(other[branch.parent.label].z[None, [-1, -2]], box)]
    return []


def is_orbital(branch: Branch | Seed) -> bool:
    """True for curves of orbits, closed or connecting (and for seeds of them)."""
    return hasattr(getattr(branch.problem, "curve", None), "orbits")


def thinned(line: Array) -> Array:
    """The polyline without the vertices that it stays within THIN of (Ramer 1972, Douglas and Peucker 1973).

    Curves of orbits may have thousands of rows, where they pass near other special orbits.
    """
    kept = np.zeros(len(line), bool)
    kept[[0, -1]] = True
    waiting = [(0, len(line) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        offset, chord = line[first + 1 : last] - line[first], line[last] - line[first]
        t = np.clip(offset @ chord / max(float(chord @ chord), 1e-300), 0.0, 1.0)
        gaps = np.linalg.norm(offset - t[:, None] * chord, axis=1)
        farthest = int(np.argmax(gaps))
        if gaps[farthest] > THIN:
            middle = first + 1 + farthest
            kept[middle] = True
            waiting += [(first, middle), (middle, last)]
    return np.asarray(line[kept])


def unit(points: Array, box: Box) -> Array:
    """Points of the box in coordinates in which it is the unit square."""
    low = np.array([b[0] for b in box])
    width = np.array([b[1] - b[0] for b in box])
    return np.asarray((points - low) / width)


def smooth_rows(branch: Branch, points: Array, box: Box) -> Array:
    """A curve in the unit square, `points` its rows there, with PARTS segments for each step."""
    return _cubic(points, *_slopes(branch, points, box))


def _slopes(branch: Branch, points: Array, box: Box) -> tuple[Array, Array]:
    """Derivatives of the two parameters along each step, at its beginning and its end, per step length."""
    curve: Any = branch.problem.curve
    width = np.array([b[1] - b[0] for b in box])
    if is_orbital(branch):  # states on meshes that change: only the plane is looked at
        return _plane_slopes(points, branch.tangents[:, [-1, -2]] / width)
    scale = np.concatenate([curve.sizes, width[::-1]])
    keep = [*range(curve.n), -2, -1]
    z, t = branch.z[:, keep] / scale, branch.tangents[:, keep] / scale
    t = t / np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-300)
    chord = np.diff(z, axis=0)
    pair = [-1, -2]
    begin = np.sum(chord * t[:-1], axis=1)[:, None] * t[:-1][:, pair]
    end = np.sum(chord * t[1:], axis=1)[:, None] * t[1:][:, pair]
    return np.asarray(begin), np.asarray(end)


def _plane_slopes(points: Array, t: Array) -> tuple[Array, Array]:
    t = t / np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-300)
    chord = np.diff(points, axis=0)
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    pair = []
    for side in (t[:-1], t[1:]):
        sense = np.sign(np.sum(side * chord, axis=1, keepdims=True))
        pair.append(length * sense * side)
    return pair[0], pair[1]


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
            a * (1 - 3 * elementary.square(s) + 2 * elementary.pow(s, 3.0))
            + b * (3 * elementary.square(s) - 2 * elementary.pow(s, 3.0))
            + begin * (s - 2 * elementary.square(s) + elementary.pow(s, 3.0))
            + end * (elementary.pow(s, 3.0) - elementary.square(s))
        )
    rows = np.stack(parts, axis=1).reshape(-1, 2)
    return np.vstack([rows, points[-1:]])


def _closed_gaps(
    lines: list[Array], owners: Sequence[int], loose: Sequence[tuple[bool, bool]], loci: Sequence[Branch], box: Box
) -> list[Array]:
    """Loose ends of curves led to the degenerate point that they lead to, where the corrector could not follow them."""
    result = list(lines)
    marked = [(unit(p.z[[-1, -2]][None], box)[0], k) for k, branch in enumerate(loci) for p in branch.points]
    for k, (line, sides) in enumerate(zip(lines, loose, strict=True)):
        for row in (row for row, is_loose in zip((0, -1), sides, strict=True) if is_loose):
            others = [place for place, owner in marked if owner != owners[k] or loci[owner].locus != "HOM"]
            # the other half of a curve cut at its tip begins where this one ends, and leads nowhere
            target = _nearest(line[row], others, [m for j, m in enumerate(lines) if owners[j] != owners[k]])
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
