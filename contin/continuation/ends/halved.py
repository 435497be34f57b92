"""Curves of cycles that come to cycles of half the period: beyond, the same ones follow from their other half.

So end curves of tori of doubled cycles at R2 of the cycles they were doubled from, and curves of their folds at GPD.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.segment import Segment


def until_halved(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm up to the last row before the halves of its cycles change places."""
    before = arm.origin.z
    for segment in segments:
        rows = np.vstack([before[None], segment.z]) if before.size == segment.z.shape[1] else segment.z
        known = len(rows) - len(segment.z)
        passed = arm.problem.past_half(rows)
        if passed is None:
            yield segment
            before = segment.z[-1] if len(segment.z) else before
            continue
        row = max(passed - known, 0)
        last = segment.z[row - 1] if row else before
        yield replace(segment.cut(row, [m for m in segment.found if m.before < row]), notes=(), hiding=0)
        text = f"came together with cycles of half the period near {arm.course.position(last)}"
        arm.end = End("joined", text, {"at": {arm.problem.parameters[0]: float(last[-1])}})
        return
