"""Where a branch leaves the region in which its equations have a meaning: it ends there, and says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import Floor, Problem
from contin.continuation.segment import Row, Segment

SMALL: Final = 1e-6  # of its scale: an unknown this near to its floor lies on it
STRAIGHT: Final = 1e-3  # of a step's length: a chord this near to the point at which all unknowns vanish leads through
BOUNDS: Final = (np.minimum, np.maximum)


def above_floors(problem: Problem, segments: Iterable[Segment], arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm up to the first row where an unknown has fallen to its floor; then `arm.end` says so.

    A branch that lies on a floor, or begins there and rises, goes on. A labelled point on the floor is the last row,
    unless the equations are singular there.
    """
    floors = problem.floors
    before = start
    for segment in segments:
        cut = _first_fall(floors, before, segment)
        if cut is None:
            yield segment
            before = segment.z[-1] if len(segment.z) else before
            continue
        row, floor = cut
        found = tuple(mark for mark in segment.found if _stays(mark, row, floor, segment))
        last = segment.z[row - 1] if row else before
        end = (
            found[-1].point.z if found and found[-1].before == row + 1 else _where(floor, last, segment.z[row], segment)
        )
        text = f"at {problem.parameters[0]} = {end[-1]:.10g}, {floor.text}"
        arm.end = End("bound", text, {"value": floor.lowest})
        yield segment.cut(row, found)
        return


def _stays(mark: Row, row: int, floor: Floor, segment: Segment) -> bool:
    """A labelled point before the fall, or on this side of the floor in the step that falls."""
    height = float(floor.heights(mark.point.z[None], segment.scale)[0])
    return mark.before <= row + 1 and height > (SMALL if floor.singular else -SMALL)


def _first_fall(floors: Iterable[Floor], before: Array, segment: Segment) -> tuple[int, Floor] | None:
    """The first row of the segment on or below a floor that the row before it was above."""
    if not floors:  # rows of orbits may change their length
        return None
    if not len(segment.z) or all(floor.together and _stays_far(floor, before, segment) for floor in floors):
        return None
    rows, falls = np.vstack([before[None], segment.z]), []
    for floor in floors:
        if floor.together and _is_far(rows.T[list(floor.together)], segment.scale[list(floor.together)]):
            continue
        above = floor.heights(rows, segment.scale) > SMALL
        fallen = np.flatnonzero(above[:-1] & (~above[1:] | _leads_through(floor, rows, segment.scale)))
        if fallen.size:
            falls.append((int(fallen[0]), floor))
    return min(falls, key=lambda fall: fall[0]) if falls else None


def _stays_far(floor: Floor, before: Array, segment: Segment) -> bool:
    """`_is_far`, with the whole extent of the rows in place of their chords: fewer operations, and fewer truths."""
    taken = list(floor.together)
    ends = zip(BOUNDS, segment.extent, strict=True)
    low, high = (bound(before, end)[taken] / segment.scale[taken] for bound, end in ends)
    return bool(np.maximum(low, -high).max() > 2.0 * np.linalg.norm(high - low) + SMALL)


def _is_far(unknowns: Array, scale: Array) -> bool:
    """True where unknowns (m, K) do not vanish together on any row or chord, for few operations; false says nothing.

    Where a chord leads through, no unknown at its ends is farther from zero than the chord is long, or hardly so.
    """
    lowest = np.abs(unknowns).min(axis=1) / scale
    moved = np.abs(np.diff(unknowns, axis=1)).max(axis=1, initial=0.0) / scale
    return bool(lowest.max() > 2.0 * np.linalg.norm(moved) + SMALL)


def _leads_through(floor: Floor, rows: Array, scale: Array) -> NDArray[np.bool_]:
    """True, (K - 1,), where all unknowns of the floor vanish together between rows (K, N) and the next ones."""
    if not floor.together:
        return np.zeros(len(rows) - 1, dtype=bool)
    taken = list(floor.together)
    share, nearest = _nearest(rows[:-1, taken], rows[1:, taken], scale[taken])
    return np.asarray((share > 0.0) & (share < 1.0) & (nearest < STRAIGHT))


def _nearest(a: Array, b: Array, scale: Array) -> tuple[Array, Array]:
    """Of chords from a to b, (K, m): the share of each at which it is nearest to zero, and that distance over its
    length, (K,) each."""
    start, chord = a / scale, (b - a) / scale
    length = np.linalg.norm(chord, axis=1)
    share = -np.sum(start * chord, axis=1) / np.maximum(length * length, np.finfo(float).tiny)
    distance = np.linalg.norm(start + share[:, None] * chord, axis=1)
    return share, np.asarray(distance / np.maximum(length, np.finfo(float).tiny))


def _where(floor: Floor, last: Array, fallen: Array, segment: Segment) -> Array:
    """The fallen row, or, where it is beyond the floor, the point of the chord to it that is on the floor."""
    if not floor.together:
        return fallen
    taken = list(floor.together)
    share, _ = _nearest(last[None, taken], fallen[None, taken], segment.scale[taken])
    return np.asarray(last + min(max(float(share[0]), 0.0), 1.0) * (fallen - last))
