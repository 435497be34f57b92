"""What steps beside a located event, and the first step of a branch, may hide."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.continuation.course import Behind, Course
from contin.continuation.curve import Stretch
from contin.continuation.location.beside_ends import after_start
from contin.continuation.location.found import Found, Note
from contin.continuation.location.isolate import next_to_event
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.segment import Row
from contin.continuation.sentence import Sentence
from contin.kernels.steering import is_dip

NEIGHBOURS: Final = 5  # rows beside an event's step that are looked at


def low_beside(course: Course, chunk: Chunk, event: Behind, forward: bool) -> set[int]:
    """Rows beyond which, seen from the event, its test may hide two zeros: with the event's own divided out it is low.

    event.length : its arclength from the chunk's first row, along the rows.
    """
    test = course.problem.test_of(event.point.type)
    if test is None:  # as a DP on a curve of folds
        return set()
    s = np.cumsum(np.append(0.0, chunk.lengths[1:]))
    last = len(chunk) - 1 if forward else len(chunk) - 2  # the event lies before the first row, or after this one
    rows = range(1, min(last, NEIGHBOURS)) if forward else range(max(1, last - NEIGHBOURS), last)
    rest = chunk.tests[:, test] / np.maximum(np.abs(s - event.length), 1e-300)
    dips = [k for k in rows if is_dip(rest[k - 1], rest[k], rest[k + 1], s[k] - s[k - 1], s[k + 1] - s[k])]
    return {near for k in dips for near in ((k - 1, k) if forward else (k, min(k + 1, last)))}


def at_beginning(course: Course, chunk: Chunk, frame: Frame, last: Sample) -> tuple[list[Row], list[Sentence], int]:
    """What the first step hides behind tests that are low at the start; see `in_steps`."""
    stretch = Stretch(course.problem, chunk.sample(0), frame, course.settings)
    rows = [*(chunk.sample(k) for k in range(1, min(len(chunk) - 1, 3))), last]
    found = after_start(stretch, rows[0], rows[1] if len(rows) > 1 else None)
    return _kept(course, frame, [(1, item) for item in found])


def in_steps(
    course: Course, chunk: Chunk, frame: Frame, event: Behind, rows: set[int], forward: bool = True
) -> tuple[list[Row], list[Sentence], int]:
    """What the steps beyond these rows hide, seen from an event nearby; notes, and how many say that it may."""
    items: list[tuple[int, Found | Note]] = []
    for k in sorted(rows):
        stretch = Stretch(course.problem, chunk.sample(k), frame, course.settings)
        far = k + 1 if forward else k - 1
        centre = event.length - float(np.sum(chunk.lengths[1 : k + 1]))
        found = next_to_event(stretch, chunk.sample(k), chunk.sample(far), event.point, centre)
        items += [(max(k, far), item) for item in found]
    return _kept(course, frame, items)


def _kept(
    course: Course, frame: Frame, items: Sequence[tuple[int, Found | Note]]
) -> tuple[list[Row], list[Sentence], int]:  # fmt: skip
    """Of what lies before these rows, the points that are not labelled yet (they are from now on); notes; see above."""
    found, notes, hiding = [], [], 0
    for row, item in items:
        if isinstance(item, Note):
            notes.append(item.said)
            hiding += item.hides
        elif not course.is_known(item.point, frame.scale):
            course.known.append(item.point)
            found.append(Row(row, item.length, item.point, item.sample.tangent))
    return found, notes, hiding
