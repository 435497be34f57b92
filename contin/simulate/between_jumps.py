"""Flights of flows with step functions, from jump to jump (`contin.simulate.stepped`)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from contin.abi import Array
from contin.lowering.system import CompiledSystem, compile_in_time
from contin.simulate.flight import DONE, SLIDING, Flight, fly
from contin.simulate.stepped import Stepped
from contin.simulate.until import fly_until, with_event

SIDES: Final = 4  # of jumps that are tried: more than one argument may be on a whole number
STUCK: Final = 100  # jumps in succession without time between them: they accumulate
STILL: Final = 1e-12  # of the time
WHY: Final = "at a jump of a step function both sides lead back to it: the solution slides along it"


@dataclass(frozen=True, eq=False)
class _Course:
    """What a flight from jump to jump needs all the time."""

    taken: Stepped
    system: CompiledSystem
    clocked: CompiledSystem | None
    p: Array
    times: Array
    rtol: float
    atol: Array
    box: float

    def wholes(self, y: Array, begin: float, end: float, last: Array | None) -> Array | None:
        """The whole parts after `begin`, where they were `last`; None where both sides of a jump lead back to it."""
        system = self.system
        values = dict(zip(system.parameter_names, self.p.tolist(), strict=False))
        values |= dict(zip(system.state_names, y.tolist(), strict=True))
        if self.clocked is None:
            return self.taken.wholes(values, begin, end, {})
        held = self.taken.wholes(values, begin, end, {}) if last is None else last
        for _ in range(SIDES):
            full = np.concatenate([self.p, held, [begin] if system.is_forced else []])
            rates = dict(zip(system.state_names, np.asarray(system.value(y, full)).tolist(), strict=True))
            found = self.taken.wholes(values, begin, end, rates)
            if np.array_equal(found, held):
                return found
            held = found
        return None


def fly_between_jumps(
    taken: Stepped, u: Array, p: Array, times: Array, budget: int, *, rtol: float, atol: Array, box: float
) -> Flight:
    """The flight from 0 to the last of `times`, from jump to jump."""
    system, leaves = compile_in_time(taken.model), taken.leaves
    clocked = None if leaves is None else compile_in_time(with_event(taken.model, leaves))
    course = _Course(taken, system, clocked, p, times, rtol, atol, box)
    values = dict(zip(system.parameter_names, p.tolist(), strict=False))
    jumps = taken.jumps(values, float(times[-1]))
    kept: list[Flight] = []
    y = u
    for begin, end in pairwise(jumps.tolist()):
        part = _flights(course, y, begin, end, budget)
        kept += part
        y, budget = part[-1].end, max(budget - sum(f.steps for f in part), 1)
        if part[-1].outcome != DONE:
            break
    return replace(
        kept[-1], t=np.concatenate([f.t for f in kept]), samples=np.vstack([f.samples for f in kept]),
        crossings=np.vstack([f.crossings for f in kept]), crossed=sum(f.crossed for f in kept),
        steps=sum(f.steps for f in kept), touched=sum(f.touched for f in kept),
    )  # fmt: skip


def _flights(course: _Course, y: Array, begin: float, end: float, budget: int) -> list[Flight]:
    """From one jump in time to the next, with a flight for each jump in the states."""
    kept: list[Flight] = []
    t, stuck, last = begin, 0, None
    while True:
        found = course.wholes(y, t, end, last)
        if found is None or stuck > STUCK:
            kept[-1:] = [replace(kept[-1] if kept else _nothing(course, y, t), outcome=SLIDING, why=WHY)]
            return kept
        last = found
        full = np.concatenate([course.p, last])
        wanted = course.times[(course.times > t if t > 0.0 else course.times >= 0.0) & (course.times <= end)]
        if course.clocked is None:
            flown = fly(
                course.system, y, full, end - t, start=t, times=wanted, rtol=course.rtol, atol=course.atol,
                box=course.box, budget=budget,
            )  # fmt: skip
            return [flown]
        flight, came = fly_until(
            course.clocked, y, full, end, begin=t, times=wanted, rtol=course.rtol, atol=course.atol, box=course.box,
            budget=budget,
        )  # fmt: skip
        stuck = stuck + 1 if flight.end_time - t <= STILL * end else 0
        kept.append(replace(flight, outcome=DONE, why="") if came else flight)  # the event is where it was to end
        y, t, budget = flight.end, flight.end_time, max(budget - flight.steps, 1)
        if not came:
            return kept


def _nothing(course: _Course, y: Array, t: float) -> Flight:
    """A flight that does not leave its start."""
    none = np.empty((0, y.size))
    return Flight(y.size, none[:, 0], none, none, t, y, np.empty((0, 2)), 0, 0, 0)
