"""What happened in the last step of a chunk: bounds and the start are met exactly, events labelled, the end told."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.curve import Stretch
from contin.continuation.location.back_at_start import back_at_start
from contin.continuation.location.beside_ends import after_start, before_end, before_last
from contin.continuation.location.bounds import at_wall, just_beyond, on_bound_itself, walls_passed
from contin.continuation.location.dips import dips, resolve_dip
from contin.continuation.location.found import Found, Note, anchored
from contin.continuation.location.halting import Halt, halt, halves, mirror
from contin.continuation.location.isolate import isolate, next_to_event
from contin.continuation.location.sameness import offset, same_point
from contin.continuation.location.targets import Wanted, hits
from contin.continuation.outcome import Verified
from contin.continuation.position import position
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.segment import Row, Segment
from contin.continuation.settings import Settings
from contin.kernels.steering import is_dip
from contin.linalg.vectors import dot, norm

NEXT_TO: Final = 1e-6  # scaled: how near to a labelled point its test is nothing but rounding
SHORTEST_RETRY: Final = 1e-7  # steps longer than this are repeated where a change between their ends does not verify
APART: Final = 0.1  # scaled: two branches with one tangent are far enough apart so far from where they touch
NEIGHBOURS: Final = 5  # rows beside an event's step that are looked at
SAME_FOLD: Final = 1e-6  # distance of a fold from the orbit at which a family turns back, relative to the range


@dataclass(frozen=True, eq=False)
class Behind:
    """A labelled point in the step that led to a chunk's first row, and its arclength along the tangent there (< 0)."""

    point: Verified
    length: float


@dataclass(frozen=True, eq=False)
class Course:
    """What an arm heeds wherever it is."""

    problem: Problem
    bounds: tuple[float, float]
    settings: Settings
    targets: Sequence[Wanted] = ()
    known: list[Verified] = field(default_factory=list)  # points already labelled, so that none is labelled twice
    symmetries: tuple[str, ...] = ()  # broken at the branch's birth: where it meets its own image, it is complete
    foundling: bool = False  # no other branch has the branch point at which it meets its own image as a label
    met: list[Verified] = field(default_factory=list)  # known points that were located again

    def is_known(self, point: Verified, scale: Array) -> bool:
        """True for a point that is labelled already."""
        label = next((k for k in self.known if same_point(self.problem, point, k, scale)), None)
        if label is not None:
            self.met.append(label)
        return label is not None

    def position(self, z: Array) -> str:
        """In words."""
        return position(self.problem, z)


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
    notes: list[str] = []
    hiding = 0
    end: End | None = None
    if rows > 1 and event is not None:
        low = {0, *_low(course, chunk, event, forward=True)}
        marked, notes, hiding = _in_steps(course, chunk, frame, event, low)
    if rows:
        stretch = Stretch(course.problem, chunk.sample(rows - 1), frame, course.settings)
        step = _LastStep(course, stretch, chunk, loop, event if rows == 1 else None, ending)
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
            hidden, more, untold = _at_beginning(course, chunk, frame, step.last)
            marked += hidden
            segment = replace(segment, notes=(*more, *segment.notes), hiding=segment.hiding + untold)
        if step.found and end is None:
            first = Behind(step.found[0].point, float(np.sum(chunk.lengths[1:rows])) + step.found[0].length)
            before_it = _low(course, chunk, first, forward=False)
            hidden, more, untold = _in_steps(course, chunk, frame, first, before_it, forward=False)
            marked += hidden
            segment = replace(segment, notes=(*segment.notes, *more), hiding=segment.hiding + untold)
    if end is None and not corner:
        end = _failure(course, chunk)
    values, unplaced = _user_values(course, chunk, segment, frame, marked)
    marked += values
    marked.sort(key=lambda row: (row.before, row.length))
    return replace(segment, found=tuple(marked), notes=(*segment.notes, *unplaced)), end


@dataclass(eq=False)
class _LastStep:
    """The step from `stretch.base` to `last`; whatever ends the arm moves `last` and says so, whichever comes first."""

    course: Course
    stretch: Stretch
    chunk: Chunk
    loop: Sample | None
    event: Behind | None  # in the step before
    ending: bool = False  # no further step is allowed
    end: End | None = None
    found: list[Found] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    jumps: list[float] = field(default_factory=list)  # arclengths, see `Note.jump`
    hiding: int = 0  # see `Note.hides`
    again: int = 1  # steps to be repeated, where what happened is not explained
    halt: Found | None = None  # the labelled point that the arm ends at
    reach: Sample | None = None  # where the arm ends at a bound, and a point may lie on that: one behind it

    def __post_init__(self) -> None:
        self.problem, self.scale = self.course.problem, self.stretch.frame.scale
        self.last = self.marched = self.chunk.sample(-1)

    def explained(self, earlier: Sample | None, passing: bool) -> bool:
        """Find what happened, up to a bound or the start; False where only a jump to another branch explains it.

        earlier : the row before `stretch.base`.
        """
        stop = self.chunk.stop
        if stop is Stop.BOUND:
            self._end_at_bound(self.last)
            reach = just_beyond(self.stretch, self.last, self.marched)
            self.reach = None if reach is self.last else reach
        if self.loop is not None and self.end is None and stop not in (Stop.LIMIT, Stop.RESCALE):
            closing = back_at_start(self.stretch, self.last, self.loop, earlier)
            if closing is not None:
                self.last, self.end = closing
        items = list(self._events(earlier))
        retry = not passing and self.chunk.lengths[-1] > SHORTEST_RETRY
        suspect = [steps for i, steps in items if isinstance(i, Note) and i.suspect] if retry else []
        if suspect:
            self.again = max(suspect)
            return False
        for item, _ in items:
            if isinstance(item, Note):
                self.notes.append(item.text)
                self.jumps += [] if item.jump is None else [item.jump]
                self.hiding += item.hides
            else:
                self._take(item)
        self.found = sorted((_anchored(f, self.chunk, self.scale) for f in self.found), key=lambda f: f.length)
        return True

    def _events(self, earlier: Sample | None) -> Iterator[tuple[Found | Note, int]]:
        """What happened, and how many steps it takes to be before it."""
        stretch, stop = self.stretch, self.chunk.stop
        known = [*self.course.known]
        if stop is not Stop.LIMIT:
            events = list(isolate(stretch, stretch.base, self.last if self.reach is None else self.reach))
            yield from ((event, 1) for event in events)
            known += [event.point for event in events if isinstance(event, Found)]
            first = next((e for e in events if isinstance(e, Found)), None)
            if first is not None and earlier is not None:
                hidden = next_to_event(stretch, stretch.base, earlier, first.point, first.length)
                yield from ((item, 2) for item in hidden)
        if self.event is not None:
            hidden = next_to_event(stretch, stretch.base, self.last, self.event.point, self.event.length)
            yield from ((item, 1) for item in hidden)
        if stop in (Stop.DIP, Stop.EVENT) and earlier is not None:  # an event may hide a dip of another test
            low = set(dips(stretch, earlier, stretch.base, self.marched))
            for test in sorted(low | ({self.chunk.dipped} if stop is Stop.DIP else set())):
                for item in resolve_dip(stretch, earlier, stretch.base, self.last, test):
                    place = item.at if isinstance(item, Note) else None
                    if place is None or not self._is_next_to(known, place):  # a test that only touches zero at an event
                        yield item, 1
        beside: Iterable[Found | Note] = ()
        if self.end is not None and self.last is not self.marched:
            beside = before_end(stretch, earlier, self.last, self.marched)
        elif self.ending and self.end is None and stop is Stop.LIMIT:
            beside = before_last(stretch, self.last)
        for item in beside:
            place = item.at if isinstance(item, Note) else None
            if self._is_inside(item) and (place is None or not self._is_next_to(known, place)):
                yield replace(item, suspect=False) if isinstance(item, Note) else item, 1

    def _is_inside(self, item: Found | Note) -> bool:
        """True for what lies before the end of the arm, as far as that is known; `_take` looks at points on a bound."""
        place = item.point.z if isinstance(item, Found) else item.place
        if place is None or place.shape != self.last.z.shape:
            return True
        if self.chunk.stop is Stop.BOUND:
            if isinstance(item, Note):
                return not walls_passed(self.problem, place, self.course.bounds)
            return on_bound_itself(self.problem, item.point, self.course.bounds, self.scale) is not None
        return dot(self.stretch.base.tangent, (place - self.last.z) / self.scale) <= 0.0

    def _take(self, item: Found) -> None:
        """A point that is found for the first time; of those behind the bound, what its error may have put there."""
        point: Verified | None = item.point
        if self.chunk.stop is Stop.BOUND and point is not None:
            point = on_bound_itself(self.problem, point, self.course.bounds, self.scale)
        if point is not None and not self._is_labelled(point):
            self.found.append(item if point is item.point else replace(item, point=point))

    def _is_labelled(self, point: Verified) -> bool:
        here = any(same_point(self.problem, point, f.point, self.scale) for f in self.found)
        return here or self.course.is_known(point, self.scale)

    def _is_next_to(self, points: Sequence[Verified], z: Array) -> bool:
        alike = (p for p in points if p.z.shape == z.shape)
        return any(norm(offset(self.problem, p.z, z, self.scale)) <= NEXT_TO for p in alike)

    def finish(self) -> None:
        """End the arm at a labelled point where one asks for it; what was found up to there is labelled from now on."""
        if self.end is None:
            self._end_before_fold()
        if self.end is None:
            turning = mirror(self.problem, self.found, self.scale, self.course.symmetries)
            if turning is not None:
                self._end_at_image(turning)
        if self.end is None:
            stopping = halt(self.problem, self.found, self.scale, self.course.settings.stop_at)
            if stopping is not None:
                self.halt, self.end = stopping
        if self.halt is not None:
            self.found = [f for f in self.found if f.length <= self.halt.length]
        self.course.known.extend(f.point for f in self.found)

    def _end_at_bound(self, beyond: Sample) -> None:
        self.last, self.end = at_wall(self.stretch, beyond, self.course.bounds)

    def _end_before_fold(self) -> None:
        """The curve turns back within the step, but beyond the bound."""
        bounds = self.course.bounds
        outside = next((f for f in self.found if walls_passed(self.problem, f.point.z, bounds)), None)
        if outside is not None:
            self._end_at_bound(replace(outside.sample, z=outside.point.z))
            self.found = [f for f in self.found if f.length < self.stretch.length_of(self.last)]

    def _end_at_image(self, turning: Halt) -> None:
        image, self.end = turning
        self.last = replace(image.sample, z=image.point.z, unstable=image.point.unstable)
        at, near = float(image.point.z[-1]), SAME_FOLD * float(self.scale[-1])
        self.found = [  # the parameter turns there too, which is no event of its own
            f
            for f in self.found
            if f.length < image.length and not (f.point.type == "LPC" and abs(f.point.z[-1] - at) < near)
        ]
        self.notes, self.jumps, self.hiding = [], [], 0  # they are about what the branch passes there
        if self.course.foundling and not halves(self.problem, image, self.scale):
            self.found.append(image)
            self.halt = image


def _row(found: Found, chunk: Chunk, scale: Array) -> Row:
    """Where a point comes among the rows; before one that touches no row lies beyond it, where branches are alike."""
    rows = len(chunk) - 1
    before = rows if found.length >= 0.0 else rows - 1
    if found.point.touches:
        beyond = (chunk.z - found.point.z) / scale @ found.sample.tangent >= 0.0
        while before > 1 and beyond[before - 1]:
            before -= 1
    return Row(before, found.length, found.point, found.sample.tangent)


def _anchored(found: Found, chunk: Chunk, scale: Array) -> Found:
    """A branch point with the last row before it that is so far away that branches are told apart there."""
    if found.point.type != "BP" or "beside" not in found.point.vectors:
        return found
    offsets = (chunk.z - found.point.z) / scale
    distances = np.linalg.norm(offsets[:, -len(scale) :], axis=1)
    behind = np.flatnonzero((offsets @ found.sample.tangent < 0.0) & (distances >= APART))
    row = int(behind[-1]) if behind.size else int(np.argmax(distances))
    return replace(found, point=anchored(found.point, chunk.z[row]))


def _low(course: Course, chunk: Chunk, event: Behind, forward: bool) -> set[int]:
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


def _at_beginning(course: Course, chunk: Chunk, frame: Frame, last: Sample) -> tuple[list[Row], list[str], int]:
    """What the first step hides behind tests that are low at the start; see `_in_steps`."""
    stretch = Stretch(course.problem, chunk.sample(0), frame, course.settings)
    rows = [*(chunk.sample(k) for k in range(1, min(len(chunk) - 1, 3))), last]
    found = after_start(stretch, rows[0], rows[1] if len(rows) > 1 else None)
    return _kept(course, frame, [(1, item) for item in found])


def _in_steps(
    course: Course, chunk: Chunk, frame: Frame, event: Behind, rows: set[int], forward: bool = True
) -> tuple[list[Row], list[str], int]:
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
) -> tuple[list[Row], list[str], int]:  # fmt: skip
    """Of what lies before these rows, the points that are not labelled yet (they are from now on); notes; see above."""
    found, notes, hiding = [], [], 0
    for row, item in items:
        if isinstance(item, Note):
            notes.append(item.text)
            hiding += item.hides
        elif not course.is_known(item.point, frame.scale):
            course.known.append(item.point)
            found.append(Row(row, item.length, item.point, item.sample.tangent))
    return found, notes, hiding


def _user_values(
    course: Course, chunk: Chunk, segment: Segment, frame: Frame, marked: Sequence[Row]
) -> tuple[list[Row], list[str]]:
    """User values and extrema that are not labelled already (they are from now on), and notes of those not verified."""
    rows, notes = [], []
    for row in hits(course.targets, course.problem, chunk, segment.z, frame, course.settings, marked):
        if isinstance(row, Note):
            notes.append(row.text)
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
