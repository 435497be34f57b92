"""One arm of a branch: march chunk by chunk, and after each say where the next one begins, or that the arm is over."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.course import Behind, Course
from contin.continuation.defects import contained
from contin.continuation.explained import Unexplained, first_unexplained
from contin.continuation.last_step import Again, resolve
from contin.continuation.location.isolate import LOST_IN_ROUNDING
from contin.continuation.location.through_zero import ThroughZero
from contin.continuation.location.user_value import Target
from contin.continuation.metric import measured_in, outgrown, travelled, unresolved
from contin.continuation.outcome import Corner, Jump, Verified
from contin.continuation.problem import Problem, Renewal, in_two_parameters
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.segment import Row, Segment
from contin.continuation.sentence import Sentence
from contin.continuation.turning_off import CROSSED, turned_at_once
from contin.linalg.vectors import dot, norm
from contin.special.table import special_type

JUMPS: Final = "the number of unstable eigenvalues jumps at a corner of the equations; the branch goes on"
TURNS: Final = "the parameter turns at a corner, where the function is not smooth; the branch goes on"
BENDS: Final = "the branch bends at a corner, where the function is not smooth"
LOWEST: Final = 1e-6  # of its size elsewhere: a test so small at a row may touch zero there
MOST_RETRIES: Final = 8  # quarterings of steps to changes that stay unexplained: tests are rounding there, and ...
PASSING: Final = -1  # ... the next step, from the last row, passes that place
STUCK: Final = "no step is taken in any metric: what is followed shrinks to a point there, or is singular"
MOST_IDLE: Final = 20  # each in a metric of its own, where one serves at all
NEAR: Final = 4.0  # steps: what a corner is crossed to lies so near to the row before
NOISE: Final = 10.0  # of the corrector's tolerance: what it leaves in a row
BESIDE: Final = 1.5  # times a step's length in the parameters: from its middle, to a labelled point that explains it
RETRY_STEP: Final = 1e-4  # first step on a new mesh, after the corrector failed on the old one


@dataclass(eq=False)
class Arm:
    """Follows a branch from `origin` along its tangent; iterate `segments()`, then read `end`.

    `loop` is the branch's start, for closing; `march` stands in place of the problem's: a journal.
    """

    course: Course
    origin: Sample
    scale: Array
    loop: Sample | None = None
    march: Callable[..., Chunk] | None = None
    plain: bool = False  # the branch starts at the origin itself, which is no special point
    end: End | None = None
    accepted: int = 0
    retraced: int = 0  # last segments, which are rows of the arm once more
    zeros: ThroughZero = field(init=False)
    idle: int = 0  # chunks in succession without a step that want another metric
    retries: int = 0  # steps in succession that were repeated, shorter; or `PASSING`

    def __post_init__(self) -> None:
        self.zeros = ThroughZero(self.course.problem)

    @property
    def problem(self) -> Problem:
        return self.course.problem

    @property
    def bounds(self) -> tuple[float, float]:
        return self.course.bounds

    def is_over(self) -> bool:
        """True once the arm has an end."""
        return self.end is not None

    def allow(self, steps: int) -> None:
        """Take no more than so many steps."""
        settings = self.course.settings
        self.course = replace(self.course, settings=replace(settings, steps=min(settings.steps, max(steps, 0))))

    def segments(self) -> Iterator[Segment]:
        """Chunks until the arm ends; `end` is set when the iterator is exhausted."""
        settings, problem, frame = self.course.settings, self.problem, Frame(self.scale)
        origin, before, length, step = self.origin, None, 0.0, settings.first_step
        event: Behind | None = None  # in the step before the chunk
        while not self.is_over():
            limit = min(settings.steps - self.accepted, problem.maximum_chunk)
            if limit <= 0:
                self.end = End("steps", f"all {settings.steps} steps used at {self.course.position(origin.z)}")
                return
            chunk, origin, before, finer = self._marched(origin, before, length, frame, step, limit)
            frame = Frame(self.scale, gauge=chunk.gauge)
            chunk, corner, (segment, self.end) = self._looked_at(chunk, before, event)
            past = None if self.is_over() else self._past_touching(segment)
            if past is not None:
                self.accepted += len(past[0].z)
                yield past[0]
                origin, before, length, step, event = past[1], None, 0.0, settings.first_step, None
                continue
            segment = self._with_zeros(chunk, segment)
            event = _behind(chunk, segment, self.scale) if len(chunk) > 1 else event
            self.accepted += len(segment.z)
            yield segment
            failed = self.end if chunk.stop is Stop.CORRECTOR and len(chunk) > 1 else None
            if self.is_over() and not (failed is not None and problem.adaptive):
                yield from self._foretold(chunk, origin, before, frame)
                return
            if corner is not None:
                origin, before, length, step = corner[0], None, 0.0, settings.first_step
                yield corner[1]
                continue
            beyond = self._other_arm(chunk, segment)
            if beyond is not None:
                self.accepted += 1
                yield Segment.single(beyond, self.scale)
                origin, before, length, step, event = beyond, None, 0.0, settings.first_step, None
                continue
            step = chunk.next_step
            if len(chunk) > 1:
                origin, before, length = chunk.sample(-1), chunk.sample(-2), float(chunk.lengths[-1])
                before = _renormalised(before, origin)
            untold = bool(segment.notes) and not segment.found and chunk.stop in (Stop.EVENT, Stop.DIP)
            if untold and self.retries >= MOST_RETRIES and step < settings.first_step:
                before, length, step, self.retries = None, 0.0, settings.first_step, PASSING
            if problem.adaptive:
                renewal = problem.renew(origin, before, self.loop, frame, settings)
                if failed is not None and renewal.end is None:
                    if renewal.origin is origin:  # nothing to adapt that might help
                        yield from self._foretold(chunk, origin, before, frame)
                        return
                    step = RETRY_STEP
                origin, before, frame = self._renewed(renewal, frame)
                if renewal.last is not None:
                    yield Segment.single(renewal.last, self.scale)
                if renewal.point is not None:
                    yield Segment.labelled(renewal.point, origin, self.scale)
            else:
                origin, before = self._remeasured(chunk, origin, before, finer)

    def _renewed(self, renewal: Renewal, frame: Frame) -> tuple[Sample, Sample | None, Frame]:
        """The last samples in the metric of a renewal, and with its gauge, if it has one."""
        self.scale, self.loop, self.end = renewal.scale, renewal.loop, renewal.end
        gauge = frame.gauge if renewal.gauge is None else renewal.gauge
        return renewal.origin, renewal.before, Frame(self.scale, gauge=gauge)

    def _with_zeros(self, chunk: Chunk, segment: Segment) -> Segment:
        """The segment with a note where tests of points of codimension two have been zero to their rounding errors."""
        if not in_two_parameters(self.problem):
            return segment
        rows = self.zeros.passed(chunk, segment.found)
        notes = [Sentence.near(self.course.problem, chunk.z[row], LOST_IN_ROUNDING) for row in rows]
        hiding = segment.hiding + len(notes)
        last = len(chunk) - (chunk.stop is Stop.BOUND)  # where a step ends beyond a bound, they may cross there
        crossed = sorted({*chunk.crossed, *turned_at_once(chunk.tangents, chunk.lengths)})
        rows = [row for row in crossed if row < last and not self._is_labelled(chunk, row)]
        notes += [Sentence.near(self.course.problem, chunk.z[row], CROSSED) for row in rows]
        return replace(segment, notes=(*segment.notes, *notes), hiding=hiding) if notes else segment

    def _is_labelled(self, chunk: Chunk, row: int) -> bool:
        """Whether the parameters of a labelled point, at which other curves may cross, are about the step to a row."""
        places = [index for index, *_ in self.problem.walls]  # type: ignore[attr-defined]
        ends, scale = chunk.z[row - 1 : row + 1, places], self.scale[places]
        middle, reach = ends.mean(axis=0), BESIDE * norm((ends[1] - ends[0]) / scale)
        return any(norm((known.z[places] - middle) / scale) <= reach for known in self.course.known)

    def _marched(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int
    ) -> tuple[Chunk, Sample, Sample | None, Array | None]:
        """The next chunk, its origin and the row before in its metric, and the finer metric that is wanted after it.

        Where its first step wants a finer one, that is taken at once.
        """
        settings, march = self.course.settings, self.march or self.problem.march
        while True:
            frame = Frame(self.scale, gauge=frame.gauge)
            chunk, finer = self._until_unresolved(
                march(origin, before, length, frame, step, limit, self.bounds, settings, self.loop)
            )
            strange = self._first_unexplained(chunk, before, length)
            row, over = (None, None) if strange is None else (strange.long, strange.over)
            if over is not None and (row is None or over <= row) and self._is_at_corner(chunk, over, frame):
                return chunk.cut(over + 2, Stop.CORNER, settings.first_step), origin, before, None
            if row is not None:  # again from there, with half the step
                shorter = 0.5 * float(chunk.lengths[row + 1])
                if row == 0:
                    step = shorter
                    continue
                return chunk.cut(row + 1, Stop.LIMIT, shorter), origin, before, None
            if finer is None or len(chunk) > 1:
                return chunk, origin, before, finer
            origin, before, length, step = self._measure_in(finer, origin, None)[0], None, 0.0, settings.first_step

    def _is_at_corner(self, chunk: Chunk, row: int, frame: Frame) -> bool:
        """True where a corner at which the branch turns lies in the step that has led from a row to another branch."""
        last = chunk.sample(row)
        crossed = self.problem.cross_corner(last, Frame(self.scale, frame.reference, frame.gauge), self.course.settings)
        if crossed is None or not isinstance(crossed[1], Verified):
            return False
        return norm((crossed[0].z - last.z) / self.scale) <= NEAR * float(chunk.lengths[row + 1])

    def _first_unexplained(self, chunk: Chunk, before: Sample | None, length: float) -> Unexplained | None:
        """See `first_unexplained`."""
        if len(chunk) < 2 or chunk.stop is Stop.CORNER:
            return None
        problem, settings = self.problem, self.course.settings
        return first_unexplained(
            chunk, before, length, self.scale, problem.angle_periods, NOISE * settings.newton_tolerance,
            settings.min_step, problem.asked_alone,
        )  # fmt: skip

    def _until_unresolved(self, chunk: Chunk) -> tuple[Chunk, Array | None]:
        """A chunk's rows as far as the metric is fine enough for them, and the finer one that is wanted from there."""
        if not self.problem.is_smooth:  # a shorter step explains no corner
            return chunk, None
        settings = self.course.settings
        found = unresolved(chunk, self.scale, self.problem.angle_periods, NOISE * settings.newton_tolerance)
        if found is None:
            return chunk, None
        row, finer = found
        return chunk.cut(row + 1, Stop.RESCALE, settings.first_step), finer

    def _remeasured(
        self, chunk: Chunk, origin: Sample, before: Sample | None, finer: Array | None
    ) -> tuple[Sample, Sample | None]:
        """The last samples in another metric: a finer one, or where states have outgrown theirs."""
        if finer is not None:
            return self._measure_in(finer, origin, before)
        if chunk.stop is Stop.RESCALE:
            return self._measure_in(outgrown(self.problem, origin.z, self.scale), origin, before)
        if in_two_parameters(self.problem):
            return origin, before
        longer = travelled(chunk.z[0], chunk.z[-1], self.scale, self.problem.angle_periods)
        return (origin, before) if longer is None else self._measure_in(longer, origin, before)

    def _past_touching(self, segment: Segment) -> tuple[Segment, Sample] | None:
        """Where another branch touches this one: the rows up to there, and where it goes on for certain."""
        mark = next((m for m in segment.found if m.point.touches), None)
        if mark is None:
            return None
        sample = self.problem.beyond(mark.point, Frame(self.scale), self.course.settings)
        if sample is None:
            return None
        kept = [m for m in segment.found if (m.before, m.length) <= (mark.before, mark.length)]
        for lost in segment.found:
            if lost not in kept:
                self.course.known.remove(lost.point)
        rows = segment.cut(mark.before - 1, kept)
        single = Segment.single(sample, self.scale)
        return replace(
            rows, z=np.concatenate([rows.z, single.z]), tangents=np.concatenate([rows.tangents, single.tangents]),
            unstable=np.concatenate([rows.unstable, single.unstable]),
            eigenvalues=np.concatenate([rows.eigenvalues, single.eigenvalues]),
            notes=(*rows.notes, *self._skipped(mark.point.z, sample.z)),
        ), sample  # fmt: skip

    def _skipped(self, z: Array, beyond: Array) -> list[Sentence]:
        """A note for user values between two points of the branch between which it is not followed."""
        ends = np.array([z, beyond])
        spans = [(t, t.values(self.problem, ends) - t.value) for t in self.course.targets if isinstance(t, Target)]
        why = "is not labelled: two branches touch near there and cannot be told apart"
        return [Sentence(f"{t.column} = {t.value:.10g} {why}") for t, (a, b) in spans if a * b < 0.0]

    def _looked_at(
        self, chunk: Chunk, before: Sample | None, event: Behind | None
    ) -> tuple[Chunk, tuple[Sample, Segment] | None, tuple[Segment, End | None]]:
        """What counts of a chunk, the sharp corner beyond it, its segment, and the end of the arm if reached."""
        if self.problem.parts_touching:
            chunk = _until_lowest(chunk)
        if chunk.stop is Stop.CORNER and (corner := self._beyond_corner(_without_last(chunk), before)) is not None:
            chunk = _without_last(chunk)
        else:
            corner = self._beyond_corner(chunk, before) if chunk.stop is Stop.CORRECTOR else None
        resolved = self._resolved(chunk, before, corner is not None, event)
        plain = not isinstance(resolved, Again) and len(chunk) > 3
        self.retries = 0 if self.retries == PASSING or plain else self.retries
        if isinstance(resolved, Again):  # the last step jumped to another branch: again, shorter
            self.retries += 1
            self._forget(corner)
            corner = None
            chunk, resolved = self._shortened(_without_last(chunk, resolved.steps), before, event)
        self.idle = self.idle + 1 if chunk.stop is Stop.RESCALE and len(chunk) == 1 else 0
        if self.idle > MOST_IDLE:
            resolved = resolved[0], End("corrector", f"at {self.course.position(chunk.z[-1])}, {STUCK}")
        return chunk, corner, resolved

    def _shortened(
        self, chunk: Chunk, before: Sample | None, event: Behind | None = None
    ) -> tuple[Chunk, tuple[Segment, End | None]]:
        """A chunk without those of its last steps that jumped to another branch, resolved."""
        resolved = resolve(self.course, chunk, before, self.scale, self.loop, event=event)
        while isinstance(resolved, Again):  # of a chunk without steps nothing is asked
            chunk = _without_last(chunk, resolved.steps)
            resolved = resolve(self.course, chunk, before, self.scale, self.loop, event=event)
        return chunk, resolved

    def _resolved(
        self, chunk: Chunk, before: Sample | None, corner: bool, event: Behind | None
    ) -> tuple[Segment, End | None] | Again:
        """See `resolve`; where an error comes up in the last step, the arm ends before that step."""
        errors: list[str] = []
        resolved: tuple[Segment, End | None] | Again = Again(1)
        with contained(errors.append):
            passing = self.retries == PASSING
            plain = self.plain and self.accepted == 0 and before is None
            ending = self.accepted + len(chunk) - 1 >= self.course.settings.steps
            resolved = resolve(self.course, chunk, before, self.scale, self.loop, corner, event, passing, plain, ending)
        if not errors:
            return resolved
        rest = _without_last(chunk) if len(chunk) > 1 else replace(chunk, stop=Stop.LIMIT)
        rest, ready = self._shortened(rest, before)
        text = f"after {self.course.position(rest.z[-1])}, {errors[0]}"
        return ready[0], End("corrector", text, defect=True)

    def _measure_in(self, scale: Array, origin: Sample, before: Sample | None) -> tuple[Sample, Sample | None]:
        """Take another metric from here on."""
        old, self.scale = self.scale, scale
        if self.loop is not None:
            self.loop = measured_in(self.loop, old, scale)
        return measured_in(origin, old, scale), None if before is None else measured_in(before, old, scale)

    def _foretold(self, chunk: Chunk, origin: Sample, before: Sample | None, frame: Frame) -> Iterator[Segment]:
        """Where the corrector has failed, the end that the branch was near instead of that failure."""
        if chunk.stop not in (Stop.CORRECTOR, Stop.NOT_FINITE):
            return
        if len(chunk) > 1:
            origin, before = chunk.sample(-1), chunk.sample(-2)
        earlier = None if before is None else _renormalised(before, origin)
        renewal = self.problem.foretold(origin, earlier, frame)
        if renewal is None:
            return
        self.end = renewal.end
        if renewal.point is not None:
            yield Segment.labelled(renewal.point, origin, self.scale)

    def _beyond_corner(self, chunk: Chunk, before: Sample | None) -> tuple[Sample, Segment] | None:
        """A point past a sharp corner, and the segment that leads there (the corner's label, then the point).

        A row that lies beyond the corner by rounding alone has the sense of the rows `before`: two arms that leave a
        corner almost alike have almost opposite tangents where the branch passes from one to the other. From there
        the corner would be crossed back to the arm by which the branch came; from the row before it is crossed rightly.
        """
        course, last = self.course, chunk.sample(-1)
        frame = Frame(self.scale, chunk.reference, chunk.gauge)
        crossed = self.problem.cross_corner(last, frame, course.settings)
        if crossed is None:
            return None
        if len(chunk) == 1 and before is not None and crossed[0].unstable == before.unstable != last.unstable:
            crossed = self.problem.cross_corner(before, frame, course.settings) or crossed
        beyond, point = crossed
        marks: tuple[Row, ...] = ()
        notes: tuple[Sentence, ...] = ()
        corners: tuple[int, ...] = ()
        if isinstance(point, Verified):
            if not course.is_known(point, self.scale):
                course.known.append(point)
                marks = (Row(1, 0.0, point, beyond.tangent),)
        elif isinstance(point, Corner):
            turns = beyond.tangent[-1] * chunk.tangents[-1][-1] < 0.0
            notes = (Sentence.near(course.problem, point.z, TURNS if turns else BENDS),)
            corners = (1,) if turns else ()
        elif chunk.unstable[-1] != beyond.unstable and isinstance(point, Jump) and point.at is not None:
            notes = (Sentence(f"at {course.position(point.at)}, {point.text}"),)
        elif chunk.unstable[-1] != beyond.unstable:
            notes = (Sentence(JUMPS, course.position(beyond.z), corner=True),)
        jumps = corners if isinstance(point, Verified) or chunk.unstable[-1] == beyond.unstable else (1,)
        return beyond, replace(Segment.single(beyond, self.scale), found=marks, notes=notes, jumps=jumps)

    def _other_arm(self, chunk: Chunk, segment: Segment) -> Sample | None:
        """Past a corner that the last step has labelled: a point with the sense in which the other arm leads away.

        The last row is there already, but its tangent has the sense of the row before (see `_beyond_corner`).
        """
        mark = next((m for m in segment.found if m.point.normal_form.get("kind") == "nonsmooth"), None)
        if mark is None or chunk.stop is not Stop.EVENT or not 1 <= mark.before == len(chunk) - 1:
            return None
        last = chunk.sample(mark.before - 1)
        crossed = self.problem.cross_corner(last, Frame(self.scale, chunk.reference, chunk.gauge), self.course.settings)
        if crossed is None or not isinstance(crossed[1], Verified) or crossed[0].unstable != chunk.unstable[-1]:
            return None
        return crossed[0]

    def _forget(self, corner: tuple[Sample, Segment] | None) -> None:
        """Forget a corner that the arm has not come to."""
        for mark in () if corner is None else corner[1].found:
            self.course.known.remove(mark.point)


def _until_lowest(chunk: Chunk) -> Chunk:
    """The chunk up to the row after the first at which a test is next to nothing beside its size elsewhere in it.

    Newton's method does not tell apart two branches that touch with contact of high order: no parabola falls to zero.
    """
    if len(chunk) < 4:
        return chunk
    sizes = np.abs(chunk.tests[:-1].T, order="C")  # of one test after the other
    inner, limits = sizes[:, 1:-1], LOWEST * sizes.max(axis=1)
    if not (inner.min(axis=1) <= limits).any():
        return chunk
    low = (inner <= limits[:, None]) & (inner < sizes[:, :-2]) & (inner <= sizes[:, 2:])
    rows, tests = np.nonzero(low.T)
    if not rows.size:
        return chunk
    cut = chunk.cut(int(rows[0]) + 3, Stop.DIP, float(chunk.lengths[int(rows[0]) + 2]))
    return replace(cut, dipped=int(tests[0]))


def _without_last(chunk: Chunk, steps: int = 1) -> Chunk:
    """The chunk before its last steps, which are to be repeated with a quarter of the first one's length."""
    return chunk.cut(len(chunk) - steps, Stop.LIMIT, float(chunk.lengths[-steps]) / 4)


def _is_event(code: str) -> bool:
    """True for types that the march sees by a change of its tests: not user values and extrema."""
    row = special_type(code)
    return row.codimension > 0 and row.test is None


def _behind(chunk: Chunk, segment: Segment, scale: Array) -> Behind | None:
    """The last event in the chunk's last step, seen from where the next one begins; user values are no events."""
    events = [m for m in segment.found if m.before >= len(chunk) - 1 and _is_event(m.point.type)]
    if not events:
        return None
    point, last = max(events, key=lambda m: (m.before, m.length)).point, chunk.sample(-1)
    return Behind(point, dot(last.tangent, (point.z - last.z) / scale))


def _renormalised(before: Sample, origin: Sample) -> Sample:
    """Tests of the row before, in the normalisation of a chunk that begins at origin (|determinant| = 1 there)."""
    tests = before.tests.copy()
    if origin.tests[1] != 0.0:
        tests[1] /= abs(origin.tests[1])
    return replace(before, tests=tests)
