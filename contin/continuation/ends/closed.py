"""Closed curves of orbits: their rows are on meshes that change, so they are told by what no mesh changes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import in_two_parameters
from contin.continuation.segment import Segment

BESIDE = 0.3  # of a step's length: how far from its chord the start may be for the step to have passed it
WIDELY = 3.0  # ... and where only the parameters are looked at, which may change less than the orbit does
SAME = 1e-4  # relative differences of parameters, period and extents of one orbit on two meshes


def until_closed(segments: Iterable[Segment], arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm, to the point where it is back at its start; then `arm.end` says so.

    Only curves of orbits in two parameters are looked at: other closed branches are seen by the march itself.
    """
    name = arm.problem.parameters[0]
    if not (arm.problem.adaptive and in_two_parameters(arm.problem)):
        yield from segments
        return
    loop = _Loop(arm, start)
    for segment in segments:
        closed = loop.closed(segment)
        if closed is None:
            yield segment
            continue
        arm.end = End("closed", f"closed loop: back at the start, {name} = {start[-1]:.10g}")
        yield closed
        return


@dataclass(eq=False)
class _Loop:
    """Passing the start in the sense in which the arm left it."""

    arm: Arm
    start: Array

    def __post_init__(self) -> None:
        self.problem: Any = self.arm.problem  # of orbits: with a system, in two parameters
        problem: Any = self.problem
        self.places = [index for index, _, _ in reversed(problem.walls)][:2]  # of both parameters
        self.first = self._marks(self.start[None])[0]
        ranges = np.abs(self.arm.scale[self.places])
        extents = np.abs(self.first[2:])
        self.sizes = np.append(ranges, np.maximum(extents, 1e-3 * extents.max(initial=0) or 1.0))
        self.last = self.start  # row
        self.away: Array | None = None  # the first step

    def _marks(self, z: Array) -> Array:
        """(rows, k) of both parameters, the period if there is one, and the smallest and largest states."""
        columns = self.problem.columns(z)
        states = [f"{name}.{end}" for name in self.problem.system.state_names for end in ("min", "max")]
        names = [*self.problem.parameters, "period", *states]
        return np.column_stack([columns[name] for name in names if name in columns])

    def closed(self, segment: Segment) -> Segment | None:
        """The segment up to the start, where one of its steps passes that."""
        target = self.first / self.sizes
        near = self._come_near(segment.z)
        for row, z in enumerate(segment.z):
            last, self.last = self.last, z
            if self.away is not None and not near[row]:
                continue
            before = self._marks(last[None])[0] / self.sizes
            step = self._marks(z[None])[0] / self.sizes - before
            if self.away is None:
                self.away = step
            elif float(step @ self.away) > 0.0 and _pass(before[None], step[None], target, BESIDE)[0]:
                there = self._solved(segment, row, step)
                if there is not None:
                    return replace(segment.cut(row + 1), z=np.vstack([segment.z[:row], there]))
        return None

    def _come_near(self, rows: Array) -> NDArray[np.bool_]:
        """True for rows to which the parameters, which cost nothing, do not rule out that a step passes the start."""
        ends = np.vstack([self.last[self.places], rows[:, self.places]]) / self.sizes[:2]
        return _pass(ends[:-1], np.diff(ends, axis=0), self.first[:2] / self.sizes[:2], WIDELY, around=1.0)

    def _solved(self, segment: Segment, row: int, step: Array) -> Array | None:
        """The point of the curve at the start's value of the parameter that moves most; None if it is another one."""
        axis = int(np.argmax(np.abs(step[:2])))
        place = self.places[axis]
        z = self.problem.at_unknown(place, segment.z[row], float(self.start[place]), segment.scale)
        if z is None:
            return None
        gaps = (self._marks(z[None])[0] - self.first) / self.sizes
        return np.asarray(z) if float(np.abs(gaps).max()) < SAME else None


def _pass(a: Array, step: Array, target: Array, beside: float, around: float = 0.0) -> NDArray[np.bool_]:
    """Of chords in rows, where the target is beside one, or the part `around` of its length before or after it."""
    length = np.einsum("ij,ij->i", step, step)
    t = np.einsum("ij,ij->i", target - a, step) / np.maximum(length, 1e-300)
    away = a + t[:, None] * step - target
    near = np.sqrt(np.einsum("ij,ij->i", away, away)) <= beside * np.sqrt(length)
    return np.asarray((-around < t) & (t <= 1.0 + around) & near)
