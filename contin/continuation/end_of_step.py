"""One step and what ends the arm in it: bounds and the start are met exactly, events located, whichever comes first."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.course import Behind, Course
from contin.continuation.curve import Stretch
from contin.continuation.location.back_at_start import back_at_start
from contin.continuation.location.beside_ends import before_end, before_last
from contin.continuation.location.bounds import at_wall, just_beyond, on_bound_itself, walls_passed
from contin.continuation.location.dips import dips, resolve_dip
from contin.continuation.location.found import Found, Note, anchored
from contin.continuation.location.halting import Halt, halt, halves, mirror
from contin.continuation.location.isolate import isolate, next_to_event
from contin.continuation.location.sameness import offset, same_point
from contin.continuation.outcome import Verified
from contin.continuation.sample import Chunk, Sample, Stop
from contin.continuation.sentence import Sentence
from contin.linalg.vectors import dot, norm

NEXT_TO: Final = 1e-6  # scaled: how near to a labelled point its test is nothing but rounding
SHORTEST_RETRY: Final = 1e-7  # steps longer than this are repeated where a change between their ends does not verify
APART: Final = 0.1  # scaled: two branches with one tangent are far enough apart so far from where they touch
SAME_FOLD: Final = 1e-6  # distance of a fold from the orbit at which a family turns back, relative to the range


@dataclass(eq=False)
class LastStep:
    """The step from `stretch.base` to `last`; whatever ends the arm moves `last` and says so, whichever comes first."""

    course: Course
    stretch: Stretch
    chunk: Chunk
    loop: Sample | None
    event: Behind | None  # in the step before
    ending: bool = False  # no further step is allowed
    end: End | None = None
    found: list[Found] = field(default_factory=list)
    notes: list[Sentence] = field(default_factory=list)
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
                self.notes.append(item.said)
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


def _anchored(found: Found, chunk: Chunk, scale: Array) -> Found:
    """A branch point with the last row before it that is so far away that branches are told apart there."""
    if found.point.type != "BP" or "beside" not in found.point.vectors:
        return found
    offsets = (chunk.z - found.point.z) / scale
    distances = np.linalg.norm(offsets[:, -len(scale) :], axis=1)
    behind = np.flatnonzero((offsets @ found.sample.tangent < 0.0) & (distances >= APART))
    row = int(behind[-1]) if behind.size else int(np.argmax(distances))
    return replace(found, point=anchored(found.point, chunk.z[row]))
