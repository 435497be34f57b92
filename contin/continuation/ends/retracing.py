"""Branches that come to their own labelled points again: they turned round unseen, and have told all.

Only one curve passes through a regular orbit, and folds, doublings and tori are such. A doubled family that is so steep
where it returns to the orbits it was born on that its halves are never seen to agree goes on as itself, half a period
later, and without end.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.segment import Segment

REGULAR: Final = ("LPC", "PD", "NS", "LP")  # not branch points, which a branch may pass twice
ROWS: Final = 10  # between a label and the same point again: nearer ones are of one step, looked at twice
TOLD: Final = 2  # points that are met again


def until_retracing(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm of orbits or cycles, up to the second of its labelled points that it meets again.

    `arm.retraced` counts those from the first of these points on: they are rows once more.
    """
    if arm.problem.kind not in ("orbit", "fixed-point"):
        yield from segments
        return
    labelled: dict[int, int] = {}  # rows at which each point was labelled, by its identity
    again: list[Verified] = []
    since = 0  # segments from the first of them on
    for segment in segments:
        labelled.update({id(mark.point): arm.accepted for mark in segment.found})
        for point in arm.course.met:
            old = arm.accepted - labelled.get(id(point), -ROWS) >= ROWS
            if old and point.type in REGULAR and all(point is not other for other in again):
                again.append(point)
        arm.course.met.clear()
        since += bool(again)
        yield segment
        if len(again) >= TOLD and not arm.is_over():
            arm.end, arm.retraced = _end(arm, again), since
            return


def _end(arm: Arm, again: list[Verified]) -> End:
    name = arm.problem.parameters[0]
    points = " and ".join(f"{point.type} at {name} = {float(point.z[-1]):.10g}" for point in again)
    text = f"the branch has turned round: it passes {points} once more, and goes on along itself"
    return End("joined", text, {"at": {name: float(again[0].z[-1])}})
