"""Where a branch leaves the region in which its equations, an approximation, hold: it ends there, and says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import Problem
from contin.continuation.segment import Segment


def within_reach(problem: Problem, segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm up to the last row at which the equations hold; then `arm.end` says so."""
    if not problem.has_reach:
        yield from segments
        return
    name = arm.problem.parameters[0]
    before = arm.origin.z  # where a change since the last segment is seen from; unknowns may be others on a new mesh
    for segment in segments:
        rows = [segment.z, *(mark.point.z[None] for mark in segment.found)]
        known = [before[None]] if before.size == segment.z.shape[1] else []
        left = problem.left_reach(np.vstack([*known, *rows]))
        before = segment.z[-1] if len(segment.z) else before
        if left is None:
            yield segment
            continue
        row, text = max(left[0] - len(known), 0), left[1]
        if row >= len(segment.z):  # a labelled point beyond, between rows that are not
            found = segment.found[: row - len(segment.z)]
            yield replace(segment, found=found)
            row = segment.found[row - len(segment.z)].before
        else:
            yield segment.cut(row)
        where = segment.z[min(row, len(segment.z) - 1), -1] if len(segment.z) else arm.origin.z[-1]
        arm.end = End("bound", f"at {name} = {where:.10g}, {text}")
        return
