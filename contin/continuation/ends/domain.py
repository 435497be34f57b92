"""Where a branch leaves the region in which its equations have a meaning: it ends there, and says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import Floor, Problem
from contin.continuation.segment import Piece, Row

SMALL: Final = 1e-6  # of its scale: an unknown this near to its floor lies on it


def above_floors(problem: Problem, pieces: Iterable[Piece], arm: Arm, start: Array) -> Iterator[Piece]:
    """The pieces of an arm up to the first row where an unknown has fallen to its floor; then `arm.end` says so.

    A branch that lies on a floor, or begins there and rises, goes on. A labelled point on the floor is the last row,
    unless the equations are singular there.
    """
    floors = problem.floors
    before = start
    for piece in pieces:
        cut = _first_fall(floors, before, piece)
        if cut is None:
            yield piece
            before = piece.z[-1] if len(piece.z) else before
            continue
        row, floor = cut
        found = tuple(mark for mark in piece.found if _stays(mark, row, floor, piece))
        end = found[-1].point.z if found and found[-1].before == row + 1 else piece.z[row]
        text = f"at {problem.parameters[0]} = {end[-1]:.10g}, {floor.text}"
        arm.end = End("bound", text, {"value": floor.lowest})
        yield piece.cut(row, found)
        return


def _stays(mark: Row, row: int, floor: Floor, piece: Piece) -> bool:
    """A labelled point before the fall, or on this side of the floor in the step that falls."""
    height = float(mark.point.z[floor.index]) - floor.lowest
    near = SMALL * float(piece.scale[floor.index])
    return mark.before <= row + 1 and height > (near if floor.singular else -near)


def _first_fall(floors: Iterable[Floor], before: Array, piece: Piece) -> tuple[int, Floor] | None:
    """The first row of the piece on or below a floor that the row before it was above."""
    if not floors:  # rows of orbits may change their length
        return None
    rows = np.vstack([before[None], piece.z]) if len(piece.z) else before[None]
    falls = []
    for floor in floors:
        above = rows[:, floor.index] > floor.lowest + SMALL * float(piece.scale[floor.index])
        fallen = np.flatnonzero(above[:-1] & ~above[1:])
        if fallen.size:
            falls.append((int(fallen[0]), floor))
    return min(falls, key=lambda fall: fall[0]) if falls else None
