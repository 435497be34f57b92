"""What happened in the last step of a chunk: bounds and the start are met exactly, events labelled, the end told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.beside_steps import at_beginning, in_steps, low_beside
from contin.continuation.branch import End
from contin.continuation.course import Behind, Course
from contin.continuation.curve import Stretch
from contin.continuation.end_of_step import NEXT_TO, LastStep
from contin.continuation.location.bounds import on_bound_itself
from contin.continuation.location.found import Found, Note
from contin.continuation.location.targets import hits
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.segment import Row, Segment
from contin.continuation.sentence import Sentence
from contin.linalg.vectors import dot, norm


@dataclass(frozen=True)
class Again:
    """So many of a chunk's last steps are to be repeated, with shorter ones."""

    steps: int


def resolve(
    course: Course, chunk: Chunk, before: Sample | None, scale: Array, loop: Sample | None, corner: bool = False,
    event: Behind | None = None, passing: bool = False, beginning: bool = False, ending: bool = False,
) -> tuple[Segment, End | None] | Again:  # fmt: skip
    """Labels and end of a chunk; `Again` where its last step jumped and must be repeated with a shorter one.

    before : the row before the chunk's first one.  loop : the branch's start, for closing.  corner : where the
    corrector failed, the arm goes on.  event : a labelled point in the step that led to the chunk's first row.
    passing : no step is repeated: shorter ones have not explained what changes here either.  beginning : the first row
    is where the branch starts, at no special point.  ending : no further step is allowed.
    """
    rows, frame = len(chunk) - 1, Frame(scale, chunk.reference, chunk.gauge)
    segment = Segment(
        chunk.z[1:], chunk.tangents[1:], chunk.unstable[1:], chunk.eigenvalues[1:], scale,
        evaluations=chunk.evaluations,
    )  # fmt: skip
    marked: list[Row] = []
    notes: list[Sentence] = []
    hiding = 0
    end: End | None = None
    if rows > 1 and event is not None:
        low = {0, *low_beside(course, chunk, event, forward=True)}
        marked, notes, hiding = in_steps(course, chunk, frame, event, low)
    if rows:
        stretch = Stretch(course.problem, chunk.sample(rows - 1), frame, course.settings)
        step = LastStep(course, stretch, chunk, loop, event if rows == 1 else None, ending)
        if not step.explained(chunk.sample(rows - 2) if rows >= 2 else before, passing):
            return Again(min(step.again, rows))
        step.finish()
        end = step.end
        if step.last is not step.marched:
            segment = segment.ending_in(step.last)
        if step.halt is not None:  # the labelled point itself is the last row
            segment = segment.cut(rows - 1)
        jumps = tuple(rows if length >= 0.0 else rows - 1 for length in step.jumps)
        segment = replace(segment, notes=(*notes, *step.notes), jumps=jumps, hiding=hiding + step.hiding)
        marked += [_row(f, chunk, scale) for f in step.found]
        if beginning:
            hidden, more, untold = at_beginning(course, chunk, frame, step.last)
            marked += hidden
            segment = replace(segment, notes=(*more, *segment.notes), hiding=segment.hiding + untold)
        if step.found and end is None:
            first = Behind(step.found[0].point, float(np.sum(chunk.lengths[1:rows])) + step.found[0].length)
            before_it = low_beside(course, chunk, first, forward=False)
            hidden, more, untold = in_steps(course, chunk, frame, first, before_it, forward=False)
            marked += hidden
            segment = replace(segment, notes=(*segment.notes, *more), hiding=segment.hiding + untold)
    if end is None and not corner:
        end = _failure(course, chunk)
    values, unplaced = _user_values(course, chunk, segment, frame, marked)
    marked += values
    marked.sort(key=lambda row: (row.before, row.length))
    return replace(segment, found=tuple(marked), notes=(*segment.notes, *unplaced)), end


def _row(found: Found, chunk: Chunk, scale: Array) -> Row:
    """Where a point comes among the rows; before one that touches no row lies beyond it, where branches are alike."""
    rows = len(chunk) - 1
    before = rows if found.length >= 0.0 else rows - 1
    if found.point.touches:
        beyond = (chunk.z - found.point.z) / scale @ found.sample.tangent >= 0.0
        while before > 1 and beyond[before - 1]:
            before -= 1
    return Row(before, found.length, found.point, found.sample.tangent)


def _user_values(
    course: Course, chunk: Chunk, segment: Segment, frame: Frame, marked: Sequence[Row]
) -> tuple[list[Row], list[Sentence]]:
    """User values and extrema that are not labelled already (they are from now on), and notes of those not verified."""
    rows, notes = [], []
    for row in hits(course.targets, course.problem, chunk, segment.z, frame, course.settings, marked):
        if isinstance(row, Note):
            notes.append(row.said)
            continue
        kept = _within(course, chunk, segment, frame, row)
        if kept is not None and not course.is_known(kept.point, frame.scale):
            course.known.append(kept.point)
            rows.append(kept)
    return rows, notes


def _within(course: Course, chunk: Chunk, segment: Segment, frame: Frame, row: Row) -> Row | None:
    """A point of the last step as it lies before the end of the arm, which may be nearer than the step's; else None."""
    last = len(segment.z)
    if row.before < last:
        return row
    step = (segment.z[-1] - chunk.z[last - 1]) / frame.scale
    length = dot(chunk.tangents[last - 1], step)
    if row.length <= length + NEXT_TO * norm(step):
        point = on_bound_itself(course.problem, row.point, course.bounds, frame.scale)
        return None if point is None else replace(row, point=point)
    return None


def _failure(course: Course, chunk: Chunk) -> End | None:
    """The end of an arm whose corrector failed."""
    if chunk.stop not in (Stop.CORRECTOR, Stop.NOT_FINITE):
        return None
    where, smallest = course.position(chunk.z[-1]), course.settings.min_step
    advice = chunk.detail or course.problem.describe_failure(chunk.z[-1])
    return End("corrector", f"corrector failed at {where} at the smallest step ({smallest:.0e}). {advice}")
