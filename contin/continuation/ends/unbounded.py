"""Where following a branch further tells nothing: it goes to infinity, stands still, or keeps one parameter value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.location.lost_digits import unresolved
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.segment import Segment

POWERS: Final = (*(float(f"1e{k}") for k in range(309)), np.inf)  # of ten
DECADES: Final = 10  # a state has grown by so many powers of ten beyond its scale (a near miss of two branches: 8)
FORETOLD: Final = 6  # ... where the corrector fails there: of numbers as large the equations lose their digits
CONVERGED: Final = 1e-4  # ... and in the last of them the parameter moved by less than this part of its range
SHRINKING: Final = 1.0 / 3.0  # ... and by less than this part of its move in the decade before (a pole: 1/10)
PATIENCE: Final = 400  # rows
VERTICAL: Final = 1e-12  # of the range: a parameter that moves less than this in so many rows does not move
STILL: Final = 1e-7  # scaled arclength of as many rows
NEAR: Final = 1e-10  # of the range: the parameter is on its bound to what matters
GROWN: Final = 1e6  # ... where a state has grown to so many times its scale, from this part of the range on: 1/p and p
NEAR_GROWN: Final = 1e-8  # have the same digits to lose
APPROACHING: Final = 4  # rows in turn that come nearer to a bound
CREEPING: Final = 60  # rows of a state that has grown so much, in mean steps of this part of the longest: rounding
CREEP: Final = 1e-2  # makes them short, and the branch would go on so
OUTGROWN: Final = 1e2  # ... or only to so many times its scale, while this part of the rows has a change that does
FAILING: Final = 0.1  # not verify
LONG: Final = 1e-3  # ... in such steps; near a fold on the bound only much shorter ones stay as near
NEARING: Final = 8  # rows in turn of a curve in two parameters that come nearer to a bound, where it is so near,
STAYING: Final = 1e-2  # ... while no parameter moves by more than this part of its range


def until_lost(segments: Iterable[Segment], arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm up to the row where it is lost; then `arm.end` says how.

    Periodic orbits have ends of their own; a locus may well run along a line of constant parameter, but not come ever
    nearer to one of its bounds.
    """
    if arm.problem.adaptive and not in_two_parameters(arm.problem):
        yield from segments
        return
    record = _Record(arm, start.copy(), arm.scale[:-1].copy(), arm.problem.adaptive, last=start)
    for segment in segments:
        stop = record.lost(segment)
        if stop is None:
            yield segment
            continue
        arm.end = stop.end
        yield segment.cut(stop.row + 1)
        return
    arm.end = record.foretold() or arm.end


def _may_grow(problem: Problem) -> NDArray[np.bool_]:
    """True for the states: not angles, not the auxiliary vectors of a locus; without the last unknown."""
    states = problem.angle_periods == 0.0
    if in_two_parameters(problem):
        states = states & problem.identifying[:-1] & problem.growing[:-1]
    return np.asarray(states)


@dataclass(frozen=True)
class _Stop:
    """The row of a segment at which the arm is to end, and why."""

    row: int
    end: End


@dataclass(eq=False)
class _Record:
    """What the rows so far were like; it costs a few operations a chunk."""

    arm: Arm
    anchor: Array  # a row, from which nothing may have moved since
    scale: Array  # of the states, at the first row
    adaptive: bool = False  # the unknowns follow a mesh
    decades: list[Array] = field(default_factory=list)  # parameters where a state passed 10, 100, .. times it
    vertical: int = 0  # rows without a move of the parameter, and of anything
    standing: int = 0
    approaching: int = 0  # rows in turn that came nearer to a bound
    row: Array = field(default_factory=lambda: np.zeros(0))  # the last one
    last: Array = field(default_factory=lambda: np.zeros(0))  # the row before the next segment
    nearing: dict[str, tuple[float, Array]] = field(default_factory=dict)  # of a locus, by parameter: its last distance
    # from a bound, and the parameters at the rows in turn that came nearer to it
    crept: list[tuple[Array, int]] = field(default_factory=list)  # last rows of a state that has grown, notes on each

    def lost(self, segment: Segment) -> _Stop | None:
        """Take the rows of one more segment."""
        if not len(segment.z):
            return None
        self.row = segment.z[-1].copy()
        if in_two_parameters(self.arm.problem):
            return self._nearing(segment) or (None if self.adaptive else self._infinite(segment))
        size, extent = self._size(segment), segment.extent
        growing = self._infinite(segment) or self._unresolved(segment) or self._creeping(segment, size)
        values = float(extent[0][-1]), float(extent[1][-1])
        return growing or self._approaching(segment, size, values) or self._unmoved(segment, values)

    def foretold(self) -> End | None:
        """Of an arm whose corrector fails where a state has grown so much: that it grows without bound."""
        if self.arm.end is None or self.arm.end.reason != "corrector" or not self._converges(FORETOLD):
            return None
        relative = self._relative(self.row)
        name, size = self._fastest(relative), float(relative.max())
        text = f"at {self.arm.course.position(self.row)}, {name} grows without bound: {size:.0e} times its scale"
        return End("bound", text, {"value": float(self.row[-1])})

    def _relative(self, z: Array) -> Array:
        """States of rows z (.., n + 1) beside their scales at the first row; 0 for unknowns that cannot grow."""
        return np.asarray(np.abs(z[..., :-1]) / self.scale * self._growing)

    @cached_property
    def _growing(self) -> NDArray[np.bool_]:
        return _may_grow(self.arm.problem)

    def _sizes(self, z: Array) -> Array:
        """Of the rows."""
        return np.asarray(self._relative(z).max(axis=-1, initial=0.0))

    def _size(self, segment: Segment) -> float:
        """Of the last row."""
        return float(self._sizes(segment.z[-1]))

    def _creeping(self, segment: Segment, size: float) -> _Stop | None:
        """A state that has grown goes on in ever so short steps, or in some between changes that do not verify."""
        if not size > OUTGROWN:
            self.crept.clear()
            return None
        self.crept = [*self.crept, *((z, len(segment.notes) if k == 0 else 0) for k, z in enumerate(segment.z))]
        self.crept = self.crept[-CREEPING - 1 :]
        failures = sum(count for _, count in self.crept)
        if len(self.crept) <= CREEPING or not (size > GROWN or failures > CREEPING * FAILING):
            return None
        moved = np.linalg.norm(np.diff(np.array([z for z, _ in self.crept]), axis=0) / segment.scale, axis=1)
        if not float(moved.mean()) < CREEP * self.arm.course.settings.max_step:
            return None
        name = self._fastest(self._relative(segment.z[-1]))
        text = f"{name} has grown to {size:.0e} times its scale, and rounding makes the branch creep on in short steps"
        return self._stop(len(segment.z) - 1, segment, "bound", text)

    def _unresolved(self, segment: Segment) -> _Stop | None:
        """A cycle of a map, mostly a growing one, whose multipliers have no digits left; orbits by shooting go on."""
        if self.arm.problem.multiplied_out:
            return None
        lost = np.flatnonzero(unresolved(self.arm.problem, segment.eigenvalues))
        if not lost.size:
            return None
        row = int(lost[0])
        size, largest = float(self._sizes(segment.z[row])), float(np.abs(segment.eigenvalues[row]).max())
        text = f"beside a multiplier of {largest:.0e} rounding decides what the others are"
        if size > OUTGROWN:
            name = self._fastest(self._relative(segment.z[row]))
            return self._stop(row, segment, "bound", f"{name} has grown to {size:.0e} times its scale; {text}")
        return self._stop(row, segment, "corrector", text)

    def _infinite(self, segment: Segment) -> _Stop | None:
        largest = np.maximum(*map(np.abs, segment.extent))  # whole rows only where an unknown may have grown
        if not self._sizes(largest) >= self._next:
            return None
        sizes = self._sizes(segment.z)
        for row in np.flatnonzero(sizes >= self._next):
            while sizes[row] >= self._next:
                self.decades.append(segment.z[row, -len(self.arm.problem.parameters) :] / self._widths)
            if self._converges():
                name = self._fastest(self._relative(segment.z[row]))
                text = f"{name} grows without bound: {sizes[row]:.0e} times its scale"
                return self._stop(int(row), segment, "bound", text)
        return None

    @property
    def _next(self) -> float:
        return POWERS[min(len(self.decades) + 1, len(POWERS) - 1)]

    @property
    def _width(self) -> float:
        return self.arm.bounds[1] - self.arm.bounds[0]

    @cached_property
    def _widths(self) -> Array:
        """Of the ranges of the varying parameters, in the order of the unknowns."""
        problem = self.arm.problem
        walls = problem.walls if in_two_parameters(problem) else [(-1, *self.arm.bounds)]
        widths = [high - low for _, low, high in sorted(walls)]
        return np.array([width if np.isfinite(width) else 1.0 for width in widths])

    def _converges(self, decades: int = DECADES) -> bool:
        if len(self.decades) < decades:
            return False
        a, b, c = self.decades[-3:]
        return float(np.abs(c - b).max()) <= min(CONVERGED, SHRINKING * float(np.abs(b - a).max()))

    def _fastest(self, relative: Array) -> str:
        problem = self.arm.problem
        names = list(problem.columns(self.last[None]))[len(problem.parameters) :]
        largest = int(np.argmax(relative))
        return names[largest] if largest < len(names) else "the state"

    def _approaching(self, segment: Segment, size: float, values: tuple[float, float]) -> _Stop | None:
        """The parameter comes ever nearer to one of its bounds, but not onto it, while a state grows.

        values : the least and the greatest of the parameter.
        """
        before, self.last = self.last, segment.z[-1].copy()
        near = (NEAR_GROWN if size > GROWN else NEAR) * self._width
        if not any(values[0] - bound < near and bound - values[1] < near for bound in self.arm.bounds):
            self.approaching = 0
            return None
        bounds = np.array(self.arm.bounds)
        rows = np.vstack([before[None], segment.z])
        distance = np.abs(rows[:, -1, None] - bounds).min(axis=1)
        steps = np.linalg.norm(np.diff(rows, axis=0) / segment.scale, axis=1)
        nearer = (distance[1:] > 0.0) & (distance[1:] <= distance[:-1]) & (distance[1:] < near)
        counted = nearer & (steps > LONG)
        if not counted.any():
            self.approaching = 0
            return None
        for row, counts in enumerate(counted):
            self.approaching = self.approaching + 1 if counts else 0
            if self.approaching == APPROACHING:
                bound = bounds[np.argmin(np.abs(bounds - segment.z[row, -1]))]
                return self._stop(row, segment, "bound", f"the branch approaches {bound:g} ever more closely")
        return None

    def _nearing(self, segment: Segment) -> _Stop | None:
        """A locus that comes ever nearer to the bound of a parameter, but not onto it, while the others hardly move."""
        problem = self.arm.problem
        walls = problem.walls if in_two_parameters(problem) else ()
        parameters = segment.z[:, [place for place, _, _ in walls]]
        widths = np.array([high - low if np.isfinite(high - low) else 1.0 for _, low, high in walls])
        for name, (place, low, high) in zip(reversed(problem.parameters[: len(walls)]), walls, strict=True):
            values = segment.z[:, place]
            distances = np.minimum(np.abs(values - low), np.abs(values - high))
            if not (np.isfinite(high - low) and distances.min() < NEAR * (high - low)):
                self.nearing.pop(name, None)
                continue
            for row, distance in enumerate(distances.tolist()):
                last, rows = self.nearing.get(name, (np.inf, parameters[:0]))
                nearer = 0.0 < distance < last and distance < NEAR * (high - low)
                rows = np.vstack([rows, parameters[row]])[-NEARING:] if nearer else parameters[:0]
                self.nearing[name] = distance, rows
                if len(rows) == NEARING and np.all(np.ptp(rows, axis=0) <= STAYING * widths):
                    bound = low if abs(values[row] - low) < abs(values[row] - high) else high
                    return self._stop(
                        row, segment, "bound", f"the curve approaches {name} = {bound:g} ever more closely"
                    )
        return None

    def _unmoved(self, segment: Segment, values: tuple[float, float]) -> _Stop | None:
        rows, last, place = len(segment.z), len(segment.z) - 1, float(self.anchor[-1])
        same = max(abs(values[0] - place), abs(values[1] - place)) <= VERTICAL * self._width
        still = same and bool(np.all(np.abs(segment.z - self.anchor) / segment.scale <= STILL))
        self.vertical = self.vertical + rows if same else 0
        self.standing = self.standing + rows if still else 0
        if not same:
            self.anchor = segment.z[-1].copy()
        if self.standing >= PATIENCE:
            advice = self.arm.problem.describe_failure(segment.z[-1])
            return self._stop(
                last, segment, "corrector", f"the branch stands still, {self.standing} rows long. {advice}"
            )
        if self.vertical >= PATIENCE and self.standing == 0:
            return self._stop(last, segment, "bound", f"the parameter has not moved in {self.vertical} rows")
        return None

    def _stop(self, row: int, segment: Segment, reason: str, text: str) -> _Stop:
        value = float(segment.z[row, -1])
        where = f"at {self.arm.problem.parameters[0]} = {value:.10g}"
        return _Stop(row, End(reason, f"{where}, {text}", {"value": value}))
