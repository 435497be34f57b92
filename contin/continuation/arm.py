"""One arm of a branch: march chunk by chunk, resolve what happened in the last step of each, say why it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.curve import Stretch
from contin.continuation.isolate import Found, Note, dips, isolate, resolve_dip
from contin.continuation.offset import far_from_zero, travelled
from contin.continuation.problem import (
    Chunk,
    Frame,
    Problem,
    Sample,
    Stop,
    Verified,
    is_adaptive,
    is_foretelling,
    is_phased,
    is_planar,
    is_terminating,
)
from contin.continuation.settings import Settings
from contin.continuation.targets import Target

CLOSED = 1e-5  # a branch has returned to its start when it passes it closer than this (scaled)
SHORTEST_RETRY = 1e-6  # steps longer than this are repeated where a change between their ends does not verify
JUMP = "the number of unstable eigenvalues jumps at a corner of the equations; the branch goes on"
RETRY_STEP = 1e-4  # first step on a new mesh, after the corrector failed on the old one
HALF_PERIOD = "half a period"  # the symmetry of doubled orbits, see `contin.problems.orbits.symmetry`
SAME_FOLD = 1e-6  # distance of a fold from the orbit at which a family turns back, relative to the range
SAME_POINT = 1e-8  # two verified points of one type closer than this are one


@dataclass(frozen=True, eq=False)
class Row:
    """A labelled point among the rows: it comes before row `before` of its chunk (row 0 is where that began)."""

    before: int
    length: float
    point: Verified
    tangent: Array  # scaled by the piece's scale


@dataclass(frozen=True, eq=False)
class Piece:
    """Accepted rows of one chunk (the row it began at not included) and the labelled points among them."""

    z: Array
    tangents: Array  # scaled
    unstable: NDArray[np.int64]
    eigenvalues: NDArray[np.complex128]
    scale: Array
    found: tuple[Row, ...] = ()
    notes: tuple[str, ...] = ()
    evaluations: int = 0

    def cut(self, rows: int, found: Sequence[Row] | None = None) -> Piece:
        """The first rows, with these labelled points (by default those among them)."""
        kept = tuple(mark for mark in self.found if mark.before <= rows) if found is None else tuple(found)
        return replace(
            self, z=self.z[:rows], tangents=self.tangents[:rows], unstable=self.unstable[:rows],
            eigenvalues=self.eigenvalues[:rows], found=kept,
        )  # fmt: skip


@dataclass(eq=False)
class Arm:
    """Follows a branch from `origin` along its tangent; iterate `pieces()`, then read `end`.

    `loop` is the branch's start, for closing; `before` and `length` describe the row before origin, if any.
    """

    problem: Problem
    origin: Sample
    scale: Array
    bounds: tuple[float, float]
    settings: Settings
    targets: Sequence[Target] = ()
    loop: Sample | None = None
    known: list[Verified] = field(default_factory=list)  # points already labelled, so that none is labelled twice
    symmetries: tuple[str, ...] = ()  # that the branch broke at its birth: where it meets its own image, it is complete
    foundling: bool = False  # no other branch has the branch point at which it meets its own image as a label
    end: End | None = None
    accepted: int = 0
    march: Callable[..., Chunk] | None = None  # in place of the problem's: a journal

    def pieces(self) -> Iterator[Piece]:
        """Chunks until the arm ends; `end` is set when the iterator is exhausted."""
        origin, before, length = self.origin, None, 0.0
        step = self.settings.first_step
        while not self.is_over():
            limit = min(self.settings.steps - self.accepted, self.problem.maximum_chunk)
            if limit <= 0:
                self.end = End("steps", f"all {self.settings.steps} steps used at {self._position(origin)}")
                return
            frame = Frame(self.scale)
            chunk = (self.march or self.problem.march)(
                origin, before, length, frame, step, limit, self.bounds, self.settings, self.loop
            )
            if chunk.stop is Stop.CORNER and (corner := self._beyond_corner(_without_last(chunk))) is not None:
                chunk = _without_last(chunk)
            else:
                corner = self._beyond_corner(chunk) if chunk.stop is Stop.CORRECTOR else None
            piece = self._resolve(chunk, before, corner is not None)
            if piece is None:  # the last step jumped to another branch: again, shorter
                chunk, self.end = _without_last(chunk), None
                piece = self._resolve(chunk, before)
                assert piece is not None
            self.accepted += len(piece.z)
            yield piece
            failed = self.end if chunk.stop is Stop.CORRECTOR and len(chunk) > 1 else None
            if self.is_over() and not (failed is not None and is_adaptive(self.problem)):
                yield from self._foretold(chunk, origin, before, frame)
                return
            if corner is not None:
                origin, before, length, step = corner[0], None, 0.0, self.settings.first_step
                yield corner[1]
                continue
            step = chunk.next_step
            if len(chunk) > 1:
                origin, before, length = chunk.sample(-1), chunk.sample(-2), float(chunk.lengths[-1])
                before = _renormalised(before, origin)
            if is_adaptive(self.problem):
                renewal = self.problem.renew(origin, before, self.loop, frame, self.settings)
                if failed is not None and renewal.end is None:
                    if renewal.origin is origin:  # nothing to adapt that might help
                        yield from self._foretold(chunk, origin, before, frame)
                        return
                    step = RETRY_STEP
                self.scale, self.loop, self.end = renewal.scale, renewal.loop, renewal.end
                origin, before = renewal.origin, renewal.before
                if renewal.last is not None:
                    yield _single(renewal.last, self.scale)
                if renewal.point is not None:
                    yield _labelled(renewal.point, origin, self.scale)
            elif chunk.stop is Stop.RESCALE:
                origin, before = self._rescale(self._grown(origin), origin, before)
            elif not is_planar(self.problem):
                longer = travelled(chunk.z[0], chunk.z[-1], self.scale, self.problem.angle_periods)
                if longer is not None:
                    origin, before = self._rescale(longer, origin, before)

    def is_over(self) -> bool:
        """True once the arm has an end."""
        return self.end is not None

    def _foretold(self, chunk: Chunk, origin: Sample, before: Sample | None, frame: Frame) -> Iterator[Piece]:
        """Where the corrector has failed, the end that the branch was near instead of that failure."""
        if chunk.stop is not Stop.CORRECTOR or not is_foretelling(self.problem):
            return
        if len(chunk) > 1:
            origin, before = chunk.sample(-1), chunk.sample(-2)
        renewal = None if before is None else self.problem.foretold(origin, _renormalised(before, origin), frame)
        if renewal is None:
            return
        self.end = renewal.end
        if renewal.point is not None:
            yield _labelled(renewal.point, origin, self.scale)

    def _position(self, sample: Sample) -> str:
        return f"{self.problem.parameters[0]} = {sample.z[-1]:.10g}"

    def _grown(self, origin: Sample) -> Array:
        """The metric after states have outgrown their scales."""
        n = len(self.scale) - 1
        angles = self.problem.angle_periods
        far = ~self.problem.growing[:-1] if is_planar(self.problem) else far_from_zero(origin.z, self.scale, angles)
        fixed = far | (angles > 0.0)
        grown = self.scale.copy()
        grown[:-1] = np.where(fixed, grown[:-1], np.maximum(grown[:-1], np.sqrt(n) * np.abs(origin.z[:-1])))
        return grown

    def _rescale(self, grown: Array, origin: Sample, before: Sample | None) -> tuple[Sample, Sample | None]:
        """Measure in another metric from here on."""
        ratio = self.scale / grown
        self.scale = grown

        def renewed(sample: Sample) -> Sample:
            t = sample.tangent * ratio
            return replace(sample, tangent=t / np.linalg.norm(t))

        if self.loop is not None:
            self.loop = renewed(self.loop)
        return renewed(origin), None if before is None else renewed(before)

    def _beyond_corner(self, chunk: Chunk) -> tuple[Sample, Piece] | None:
        """A point past a sharp corner, and the piece that leads there (the corner's label, then the point)."""
        crossed = self.problem.cross_corner(chunk.sample(-1), Frame(self.scale, chunk.reference), self.settings)
        if crossed is None:
            return None
        beyond, point = crossed
        marks: tuple[Row, ...] = ()
        if point is not None and not self._is_known(point):
            self.known.append(point)
            marks = (Row(1, 0.0, point, beyond.tangent),)
        notes: tuple[str, ...] = ()
        if point is None and chunk.unstable[-1] != beyond.unstable:
            notes = (f"{JUMP} near {self._position(beyond)}",)
        return beyond, replace(_single(beyond, self.scale), found=marks, notes=notes)

    def _resolve(self, chunk: Chunk, before: Sample | None, corner: bool = False) -> Piece | None:
        """Labels and ends of a chunk; None where its last step must be repeated with a shorter one."""
        frame = Frame(self.scale, chunk.reference)
        rows = len(chunk) - 1
        found: list[Found] = []
        notes: list[str] = []
        last: Sample | None = chunk.sample(rows) if rows else None
        replaced, halt = False, None
        if rows:
            stretch = Stretch(self.problem, chunk.sample(rows - 1), frame, self.settings)
            assert last is not None
            if chunk.stop is Stop.BOUND:
                last, replaced = self._at_bound(stretch, last), True
            closing = self._closing(stretch, last, chunk.stop)
            if closing is not None:
                last, replaced = closing, True
            items = list(isolate(stretch, stretch.base, last)) if chunk.stop is not Stop.LIMIT else []
            earlier = chunk.sample(rows - 2) if rows >= 2 else before
            if chunk.stop in (Stop.DIP, Stop.EVENT) and earlier is not None:  # an event may hide a dip of another test
                low = set(dips(stretch, earlier, stretch.base, chunk.sample(rows)))
                for test in sorted(low | ({chunk.dipped} if chunk.stop is Stop.DIP else set())):
                    items += list(resolve_dip(stretch, earlier, stretch.base, last, test))
            if chunk.lengths[-1] > SHORTEST_RETRY and any(isinstance(i, Note) and i.suspect for i in items):
                return None
            for item in items:
                if isinstance(item, Note):
                    notes.append(item.text)
                elif not self._is_known(item.point) and not any(self._same(item.point, f.point) for f in found):
                    found.append(item)
            found.sort(key=lambda f: f.length)
            outside = next((f for f in found if self._walls_passed(f.point.z)), None)
            if outside is not None and self.end is None:  # the curve turns back, but beyond the bound
                beyond = replace(outside.sample, z=outside.point.z)
                last, replaced = self._at_bound(stretch, beyond), True
                found = [f for f in found if f.length < stretch.length_of(last)]
            mirror = self._mirror(found)
            if mirror is not None:
                last = replace(mirror.sample, z=mirror.point.z, unstable=mirror.point.unstable)
                replaced = True
                near = SAME_FOLD * float(self.scale[-1])  # the parameter turns there too, which is no event of its own
                at = float(mirror.point.z[-1])
                found = [
                    f
                    for f in found
                    if f.length < mirror.length and not (f.point.type == "LPC" and abs(f.point.z[-1] - at) < near)
                ]
                notes = []  # they are about what the branch passes there
                if self.foundling and not self._halves(mirror):
                    found.append(mirror)
                    halt = mirror
            halt = halt or self._halt(found)
            if halt is not None:
                found = [f for f in found if f.length <= halt.length]
            self.known.extend(f.point for f in found)
        z, tangents = chunk.z[1:].copy(), chunk.tangents[1:]
        unstable, eigenvalues = chunk.unstable[1:], chunk.eigenvalues[1:]
        if replaced and last is not None:
            z[-1] = last.z
            tangents, unstable, eigenvalues = tangents.copy(), unstable.copy(), eigenvalues.copy()
            tangents[-1], unstable[-1] = last.tangent, last.unstable
            eigenvalues = _with_last(eigenvalues, last.eigenvalues)
        if not corner:
            self._failures(chunk)
        if halt is not None:  # the labelled point itself is the last row
            z, tangents, unstable, eigenvalues = z[:-1], tangents[:-1], unstable[:-1], eigenvalues[:-1]
        marked = [Row(rows if f.length >= 0.0 else rows - 1, f.length, f.point, f.sample.tangent) for f in found]
        marked += self._hits(chunk, z, frame, marked)
        marked.sort(key=lambda r: (r.before, r.length))
        return Piece(z, tangents, unstable, eigenvalues, self.scale, tuple(marked), tuple(notes), chunk.evaluations)

    def _halt(self, found: list[Found]) -> Found | None:
        """The first point of a type at which the run is asked to stop (`settings.stop_at`); ends the arm.

        So do a DP from which on a curve of folds is its own mirror image, and points that the problem's curves end at.
        """
        if self.end is not None:
            return None
        for f in found:
            where = f"{self.problem.parameters[0]} = {f.point.z[-1]:.10g}"
            if f.point.type == "DP" and self.problem.reverses(f.point.z, f.sample.tangent * self.scale, ()):
                text = f"met its own mirror image on the curve of branch points at {where}"
                self.end = End("joined", text, {"at": float(f.point.z[-1])})
                return f
            if f.point.type == "TZ" and self.problem.locus == "BP":
                self.end = End("joined", f"three eigenvalues vanish at {where}: curves of several types meet there")
                return f
            if f.point.type in self.settings.stop_at:
                self.end = End(f.point.type.lower(), f"{f.point.type} at {where}, where the run was asked to stop")
                return f
            if is_terminating(self.problem):
                self.end = self.problem.end_at(f.point)
                if self.end is not None:
                    return f
        return None

    def _halves(self, f: Found) -> bool:
        """True where orbits meet those of half the period."""
        return f.point.type == "BPC" and self.problem.reverses(f.point.z, f.sample.tangent * self.scale, (HALF_PERIOD,))

    def _mirror(self, found: list[Found]) -> Found | None:
        """The branch point at which the branch meets its own mirror image, or orbits those of half the period.

        Ends the arm.
        """
        if self.end is not None:
            return None
        for f in found:
            if f.point.type not in ("BP", "BPC"):
                continue
            tangent, at = f.sample.tangent * self.scale, float(f.point.z[-1])
            where = f"{self.problem.parameters[0]} = {at:.10g}"
            if self._halves(f):
                text = f"came together with orbits of half the period, at their period doubling {where}"
            elif self.symmetries and self.problem.reverses(f.point.z, tangent, self.symmetries):
                text = f"met its own mirror image at the branch point {where}"
            else:
                continue
            self.end = End("joined", text, {"at": at})
            return f
        return None

    def _is_known(self, point: Verified) -> bool:
        return any(self._same(point, k) for k in self.known)

    def _same(self, a: Verified, b: Verified) -> bool:
        """One type at one place (angles modulo their periods) and, for oscillations, one frequency."""
        if a.type != b.type:
            return False
        if is_adaptive(self.problem):
            return self.problem.same_point(a, b, self.scale)
        u, v = a.vectors.get("omega", 0.0), b.vectors.get("omega", 0.0)
        near = float(np.linalg.norm(self._seen(self._wrapped(a.z - b.z) / self.scale))) < SAME_POINT
        return near and abs(u - v) <= 1e-6 * (abs(u) + abs(v))

    def _at_bound(self, stretch: Stretch, beyond: Sample) -> Sample:
        """The point of the curve on the bound that was passed; ends the arm."""
        reached = []
        for index, value, name in self._walls_passed(beyond.z):
            sample = at_value(stretch, stretch.base, beyond, value, index)
            reached.append((stretch.length_of(sample), sample, value, name))
        _, sample, value, name = min(reached, key=lambda item: item[0])
        self.end = End("bound", f"{name} reached {value:.10g}", {"value": value})
        return sample

    def _walls_passed(self, z: Array) -> list[tuple[int, float, str]]:
        """(unknown, bound, name) of every bound that z is beyond."""
        problem = self.problem
        walls = problem.walls if is_planar(problem) else [(len(z) - 1, *self.bounds)]
        names = reversed(problem.parameters[: len(walls)])
        passed = []
        for (index, lowest, highest), name in zip(walls, names, strict=True):
            if not lowest <= z[index] <= highest:
                passed.append((index, lowest if z[index] < lowest else highest, name))
        return passed

    def _seen(self, offset: Array) -> Array:
        """An offset without the unknowns that do not tell points apart."""
        return np.where(self.problem.identifying, offset, 0.0) if is_planar(self.problem) else offset

    def _closing(self, stretch: Stretch, last: Sample, stop: Stop) -> Sample | None:
        """The start again, where the last step passed it."""
        if self.loop is None or stop in (Stop.LIMIT, Stop.RESCALE) or self.end is not None:
            return None
        start = self._start_near(last)

        def along(sample: Sample) -> float:
            return float(start.tangent @ self._seen(self._wrapped(sample.z - start.z) / self.scale))

        if not (along(stretch.base) < 0.0 <= along(last)):
            return None
        if np.linalg.norm(self._seen(self._wrapped(last.z - start.z) / self.scale)) > 4 * stretch.distance(
            stretch.base, last
        ):
            return None
        _, high = stretch.zero(along, stretch.base, last, 1e-9)
        start = self._start_near(high)
        gap = self._wrapped(high.z - start.z)
        if np.linalg.norm(self._seen(gap / self.scale)) > CLOSED:
            return None
        self.end = End("closed", f"closed loop: back at the start, {self._position(start)}")
        winding = (high.z - start.z) - gap
        closed = start.z + winding
        return replace(high, z=closed if not is_planar(self.problem) else self._same_vectors(high.z, closed))

    def _start_near(self, sample: Sample) -> Sample:
        """The start, in phase with a sample."""
        assert self.loop is not None
        return self.problem.in_phase(self.loop, sample.z, self.scale) if is_phased(self.problem) else self.loop

    def _same_vectors(self, z: Array, closed: Array) -> Array:
        """The start again, with the auxiliary vectors as the curve brought them (their sign may have turned)."""
        return np.where(self._seen(np.ones(len(z))) > 0.0, closed, z)

    def _wrapped(self, difference: Array) -> Array:
        periods = self.problem.angle_periods
        angles = np.flatnonzero(periods)
        if angles.size:
            difference = difference.copy()
            p = periods[angles]
            difference[angles] -= p * np.round(difference[angles] / p)
        return difference

    def _hits(self, chunk: Chunk, z: Array, frame: Frame, marked: list[Row]) -> list[Row]:
        """User values crossed between consecutive points of the piece, labelled points included."""
        hits: list[Row] = []
        if not self.targets or len(chunk) < 2:
            return hits
        rows = np.vstack([chunk.z[:1], z])
        order: list[tuple[int, float, Array]] = [(k, -np.inf, row) for k, row in enumerate(rows)]
        order += [(r.before, r.length, r.point.z) for r in marked]
        order.sort(key=lambda item: (item[0] - (item[1] != -np.inf), item[1]))
        points = np.array([item[2] for item in order])
        owner = np.array([item[0] if item[1] == -np.inf else item[0] - 1 for item in order])
        for target in self.targets:
            values = target.values(self.problem, points) - target.value
            for i in np.flatnonzero((values[:-1] * values[1:] < 0.0) | (values[1:] == 0.0)):
                k = int(owner[i])
                stretch = Stretch(self.problem, chunk.sample(k), frame, self.settings)
                found = target.locate(stretch, points[i], points[i + 1])
                if found is not None and not self._is_known(found.point):
                    self.known.append(found.point)
                    hits.append(Row(k + 1, found.length, found.point, found.sample.tangent))
        return hits

    def _failures(self, chunk: Chunk) -> None:
        if self.end is not None or chunk.stop not in (Stop.CORRECTOR, Stop.NOT_FINITE):
            return
        where = self._position(chunk.sample(-1))
        advice = chunk.detail or self.problem.describe_failure(chunk.z[-1])
        self.end = End(
            "corrector", f"corrector failed at {where} at the smallest step ({self.settings.min_step:.0e}). {advice}"
        )


def _labelled(point: Verified, sample: Sample, scale: Array) -> Piece:
    """A labelled point with no other rows."""
    size = len(sample.z)
    mark = Row(1, 0.0, point, sample.tangent)
    empty = np.empty((0, size))
    return Piece(empty, empty, np.empty(0, np.int64), np.empty((0, len(sample.eigenvalues)), complex), scale, (mark,))


def _single(sample: Sample, scale: Array) -> Piece:
    """One row."""
    return Piece(sample.z[None], sample.tangent[None], np.array([sample.unstable]), sample.eigenvalues[None], scale)


def _with_last(eigenvalues: NDArray[np.complex128], last: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The rows with another last one, padded with NaN where it has more values than they, or fewer."""
    width = max(eigenvalues.shape[1], len(last))
    rows = np.full((len(eigenvalues), width), np.nan, complex)
    rows[:-1, : eigenvalues.shape[1]] = eigenvalues[:-1]
    rows[-1, : len(last)] = last
    return rows


def _without_last(chunk: Chunk) -> Chunk:
    """The chunk before its last step, which is to be repeated with a quarter of its length."""
    m = len(chunk) - 1
    return replace(
        chunk, z=chunk.z[:m], tangents=chunk.tangents[:m], tests=chunk.tests[:m], unstable=chunk.unstable[:m],
        eigenvalues=chunk.eigenvalues[:m], lengths=chunk.lengths[:m], stop=Stop.LIMIT,
        next_step=float(chunk.lengths[m]) / 4,
    )  # fmt: skip


def _renormalised(before: Sample, origin: Sample) -> Sample:
    """Tests of the row before, in the normalisation of a chunk that begins at origin (|determinant| = 1 there)."""
    tests = before.tests.copy()
    if origin.tests[1] != 0.0:
        tests[1] /= abs(origin.tests[1])
    return replace(before, tests=tests)


def at_value(stretch: Stretch, a: Sample, b: Sample, value: float, index: int = -1) -> Sample:
    """The point between a and b where unknown `index` has exactly this value, solved to full precision."""
    problem, scale = stretch.problem, stretch.frame.scale
    low, high = stretch.zero(lambda s: float(s.z[index] - value), a, b, 1e-7 * stretch.distance(a, b))
    near = low if abs(low.z[index] - value) < abs(high.z[index] - value) else high
    if is_planar(problem):
        solved = problem.at_unknown(index, near.z, value, scale)
    else:
        solved = problem.at_parameter(near.z, value, scale)
    if solved is None or np.linalg.norm((solved - near.z) / stretch.frame.scale) > stretch.distance(a, b) + 1e-6:
        low, high = stretch.zero(lambda s: float(s.z[index] - value), a, b, 1e-13)
        solved = high.z.copy()
        solved[index] = value
    return replace(near, z=solved)


ProgressCallback = Callable[[Mapping[str, object]], None]
