"""Where a branch leaves the region in which its equations, an approximation, hold: it ends there, and says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import Problem
from contin.continuation.segment import Piece


def within_reach(problem: Problem, pieces: Iterable[Piece], arm: Arm) -> Iterator[Piece]:
    """The pieces of an arm up to the last row at which the equations hold; then `arm.end` says so."""
    if not problem.has_reach:
        yield from pieces
        return
    name = arm.problem.parameters[0]
    before = arm.origin.z  # where a change since the last piece is seen from; unknowns may be others on a new mesh
    for piece in pieces:
        rows = [piece.z, *(mark.point.z[None] for mark in piece.found)]
        known = [before[None]] if before.size == piece.z.shape[1] else []
        left = problem.left_reach(np.vstack([*known, *rows]))
        before = piece.z[-1] if len(piece.z) else before
        if left is None:
            yield piece
            continue
        row, text = max(left[0] - len(known), 0), left[1]
        if row >= len(piece.z):  # a labelled point beyond, between rows that are not
            found = piece.found[: row - len(piece.z)]
            yield replace(piece, found=found)
            row = piece.found[row - len(piece.z)].before
        else:
            yield piece.cut(row)
        where = piece.z[min(row, len(piece.z) - 1), -1] if len(piece.z) else arm.origin.z[-1]
        arm.end = End("bound", f"at {name} = {where:.10g}, {text}")
        return
