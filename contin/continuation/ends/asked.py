"""Where a run is asked to stop (`stop_at`) at user values, extrema and zeros of a type's own test.

These are looked for when the labels and the end of a chunk are known already; the other types end an arm in
`contin.continuation.location.halting`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from contin.continuation.arm import Arm
from contin.continuation.location.halting import asked_to_stop
from contin.continuation.segment import Segment


def until_asked(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm up to the first labelled point of such a type; then `arm.end` says so."""
    types = arm.course.settings.stop_at
    for segment in segments:
        k = next((k for k, mark in enumerate(segment.found) if mark.point.type in types), None)
        if k is None:
            yield segment
            continue
        mark = segment.found[k]
        yield segment.cut(max(mark.before - 1, 0), segment.found[: k + 1])
        arm.end = asked_to_stop(arm.problem, mark.point)
        return
