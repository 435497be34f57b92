"""Trajectories whose states jump at events: from event to event.

The functions `when` are given to the integrator as switching surfaces (a further state whose rate changes sign with
them), so that their zeros are landed on exactly; each is a state of its own too, so that the steps are short enough
for it to be seen. Only a solution that flows through zero, or a jump of another event
that carries `when` through it, makes an event; touching zero makes none. An event's own jump never fires it again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.lowering.system import CompiledSystem, compile_in_time
from contin.model.evaluate import evaluate
from contin.model.expression import add, compare, if_, mul, number
from contin.model.parts import TIME, Event, State
from contin.model.printing import to_text
from contin.simulate.flight import CROSSINGS, DONE, STOPPED, Flight, fly
from contin.symbolic.calculus.derivatives import derivative

if TYPE_CHECKING:
    from contin.model.model import Model

CLOCK: Final = "event clock"  # no name in a model contains a blank
HEIGHT: Final = "height"
RESOLVED: Final = 1e-7  # of its size: the error of a `when` as a state
PARTS: Final = 64  # of the time, where no event says how long it takes to the next
AT_ONCE: Final = 1e-12  # relative: events at the same time
CLOCKS: Final = 8  # in succession, each for what the one before it could not tell
TRIED: Final = 100_000  # steps of one
STEEPER: Final = 1e3  # times its mean slope since the last jump: a `when` that is steeper on landing is in a spike
CHAIN: Final = 100  # events that fire each other without time between
RUN: Final = 8  # intervals that shrink in succession:
NEAR: Final = 1e-6  # events accumulate where the rest is this part of the first
SENSES: Final = {"up": (1.0,), "down": (-1.0,), "both": (1.0, -1.0)}


@dataclass(frozen=True, eq=False)
class Jump:
    """At `time` the events of these numbers (from 0) took the states from `before` (n,) to `after` (n,)."""

    time: float
    events: tuple[int, ...]
    before: Array
    after: Array


@dataclass(frozen=True, eq=False)
class _WithClock:
    """The flow with its clock; observables are `when` of each event and its rate along the flow."""

    model: Model
    system: CompiledSystem
    p: Array
    rtol: float
    atol: Array
    box: Array

    @property
    def events(self) -> tuple[Event, ...]:
        return self.model.events

    def seen(self, y: Array, t: Array) -> tuple[Array, Array]:
        """(when, rate), each (T, events), at the states y (T, n + 1 + events)."""
        rows = np.tile(self.p, (len(t), 1))
        rows = np.column_stack([rows, t]) if self.system.is_forced else rows
        both = np.asarray(self.system.observables(np.ascontiguousarray(y), rows)).reshape(len(t), -1)
        count = len(self.events)
        return both[:, :count], both[:, count:]

    def fly(self, y: Array, t: float, end: float, times: Array, budget: int) -> Flight:
        return fly(
            self.system, y, self.p, end - t, start=t, times=times, rtol=self.rtol, atol=self.atol, box=self.box,
            budget=budget,
        )  # fmt: skip

    def begun(self, y: Array, t: float, length: float) -> Array:
        """The clock and the heights where a flight begins; how accurate these are to be is set by how they move."""
        when, rate = (a[0] for a in self.seen(y[None, :], np.array([t])))
        self.atol[-len(when) :] = RESOLVED * np.maximum(np.abs(when), np.abs(rate) * length)
        return np.concatenate([[0.0], when])

    def values(self, y: Array, t: float) -> dict[str, float]:
        found = dict(zip(self.model.parameter_names, self.p.tolist(), strict=False))
        return {**found, TIME: t, **dict(zip(self.model.state_names, y.tolist(), strict=False))}


@dataclass(frozen=True, eq=False)
class _Sides:
    """On which side of zero each `when` is; `allowed`: how long an event just landed on may take to leave its surface,
    -1 of all others; `reach`: the largest |when| that were looked at, up to an event."""

    signs: Array
    allowed: Array
    reach: Array


def fly_with_events(
    model: Model, u: Array, p: Array, times: Array, *, rtol: float, atol: Array, box: float, budget: int
) -> tuple[Flight, tuple[Jump, ...]]:
    """The flight from 0 to the last of `times`, and its jumps. At the time of a jump the state is the one before it."""
    duration = float(times[-1])
    system = compile_in_time(clocked(model))
    count = len(model.events)
    errors = np.concatenate([atol, [1e-3 * rtol * duration], np.full(count, np.inf)])
    boxes = np.append(np.full(u.size, box), np.full(1 + count, np.inf))
    flow = _WithClock(model, system, p, rtol, errors, boxes)
    y, t, length = np.append(u, np.zeros(1 + count)), 0.0, duration / PARTS
    sides = _first_sides(flow, y)
    kept_t, kept_u, steps, crossed = [times[:0]], [np.empty((0, y.size))], 0, 0
    jumps: list[Jump] = []
    why = ""
    while True:
        end = duration if t + length >= duration * (1.0 - AT_ONCE) else t + length
        y[u.size :] = flow.begun(y, t, length)
        sides = replace(sides, reach=np.maximum(sides.reach, np.abs(y[u.size + 1 :])))
        wanted = times[(times > t if t > 0.0 else times >= 0.0) & (times <= end)]
        flight = flow.fly(y, t, end, wanted, max(budget - steps, 1))
        if flight.crossed > CROSSINGS:
            length *= 0.5  # not all crossings are known
            continue
        before = sides
        when, fired, sides, why = _next_event(flow, flight, y, t, sides)
        if fired:
            flight = _cut(flow, flight, y, t, when, wanted)
        elif not why and flight.outcome == STOPPED and not system.is_forced:
            flight, fired, sides = _within_rounding(flow, flight, before)
        if is_last := bool(fired) and flight.end_time >= duration * (1.0 - AT_ONCE):  # no time is left but rounding
            flight = _up_to_the_end(flight, wanted)
        kept_t.append(flight.t)
        kept_u.append(flight.u)
        steps, crossed = steps + flight.steps, crossed + flight.crossed
        if why or (not fired and (flight.outcome != DONE or end >= duration)):
            break
        y, t = flight.end.copy(), flight.end_time
        if not fired:
            length = min(2.0 * length, duration / PARTS)
            continue
        begun = jumps[-1].time if jumps else 0.0
        happened, y, sides, why = _jumped(flow, y, t, fired, t - begun, sides.reach)
        jumps += happened
        why = why or _accumulation(jumps)
        if why or steps >= budget or is_last:
            why = why or ("" if is_last else f"{budget} steps were not enough")
            flight = replace(flight, end=y, end_time=t)
            break
        length = min(max(1.01 * (t - begun), 1e-9 * duration), duration / PARTS)
    n = u.size
    outcome, why = (STOPPED, why) if why else (flight.outcome, flight.why)
    whole = replace(
        flight, n=n, t=np.concatenate(kept_t), samples=np.vstack(kept_u)[:, :n], end=flight.end[:n], steps=steps,
        crossed=max(crossed - len(jumps), 0), outcome=outcome, why=why,
    )  # fmt: skip
    return whole, tuple(jumps)


def clocked(model: Model) -> Model:
    """The flow with a state whose rate changes where a `when` changes its sign, and what tells of events."""
    rates = dict(zip(model.state_names, model.equations, strict=True))
    observables = {}
    for k, event in enumerate(model.events):
        observables[f"when {k}"] = event.when
    along = []
    for event in model.events:
        terms = [mul(derivative(event.when, name), rate) for name, rate in rates.items()]
        along.append(add(derivative(event.when, TIME), *terms))
    observables |= {f"rate {k}": rate for k, rate in enumerate(along)}
    zero = number(0)
    clock = add(*(if_(compare(">", e.when, zero), number(k + 1), zero) for k, e in enumerate(model.events)))
    return model.replace(
        states=(*model.states, State(CLOCK, zero), *(State(f"{HEIGHT} {k}", zero) for k in range(len(along)))),
        equations=(*model.equations, clock, *along), observables=observables, events=(),
        symmetries=(), starts=(), averaging=None, rotation={}, expect=(), labels={}, limits=(), totals=(),
    )  # fmt: skip


def _first_sides(flow: _WithClock, y: Array) -> _Sides:
    when, rate = flow.seen(y[None, :], np.zeros(1))
    signs = np.where(when[0] != 0.0, np.sign(when[0]), np.sign(rate[0]))
    return _free(signs, np.zeros(signs.size))


def _free(signs: Array, reach: Array) -> _Sides:
    """No event was landed on just now."""
    return _Sides(signs, np.full(signs.size, -1.0), reach)


def _next_event(
    flow: _WithClock, flight: Flight, y: Array, t: float, sides: _Sides
) -> tuple[float, tuple[int, ...], _Sides, str]:
    """(time, events that fire first in this flight, sides at its end or at the event, why it cannot go on)."""
    end, fresh = flight.end_time, bool((sides.allowed >= 0.0).any())
    if end <= t:
        return end, (), sides, ""
    if not flight.crossed and not fresh:  # it may begin where the last one ended on a surface, so the sides decide
        when, _ = flow.seen(flight.end[None, :], np.array([end]))
        if (sides.signs != 0.0).all() and np.array_equal(np.sign(when[0]), sides.signs):
            return end, (), sides, ""
    inner = np.unique(flight.crossings[:, 0])
    places = np.concatenate([[t], inner[(inner > t) & (inner < end)], [end]])
    middles = 0.5 * (places[1:] + places[:-1])
    flown = flow.fly(y, t, end, middles, 1_000_000_000)
    when, _ = flow.seen(flown.samples, flown.t)
    signs = np.sign(when)
    if not len(signs):
        return end, (), sides, ""
    last = np.where(sides.signs == 0.0, signs[0], sides.signs)
    for k in np.flatnonzero((sides.allowed >= 0.0) & (signs[0] != last)):
        if places[1] - t > sides.allowed[k]:
            return t, (), sides, f"after its jump {_named(flow, int(k))} comes again at once, without end"
        signs[0, k] = last[k]
    beside = (flown.t - t)[:, None] <= sides.allowed  # another event may cut so short a time into pieces
    signs = np.where(beside, last, signs)
    when_first, reach = end, sides.reach
    fired: list[int] = []
    for place, found, heights in zip(places, signs, np.abs(when), strict=False):
        now = np.where(found == 0.0, last, found)  # an interval as short as rounding, or a solution along the surface
        if fired and place - when_first > AT_ONCE * max(abs(place), end - t):
            break
        new = [k for k, e in enumerate(flow.events) if now[k] != last[k] and now[k] in SENSES[e.direction]]
        if new and not fired:
            when_first = float(place)
        fired += [k for k in new if k not in fired]
        last, reach = now, reach if fired else np.fmax(reach, heights)
    return when_first, tuple(sorted(fired)), _free(last, reach), ""


def _cut(flow: _WithClock, flight: Flight, y: Array, t: float, when: float, wanted: Array) -> Flight:
    """The flight up to the event."""
    if when > t:
        return flow.fly(y, t, when, wanted[wanted <= when], 1_000_000_000)
    return replace(
        flight, t=flight.t[:0], samples=flight.samples[:0], end_time=t, end=y.copy(), crossed=0, steps=0, outcome=DONE,
        why="",
    )  # fmt: skip


def _within_rounding(flow: _WithClock, flight: Flight, sides: _Sides) -> tuple[Flight, tuple[int, ...], _Sides]:
    """Of a flight that stopped: up to the event that comes at its last time to rounding, if one does.

    A spike that grows like exp(v) crosses its surface in less time than a clock that runs for long can tell: from its
    last state it is integrated on with a clock of its own.
    """
    y, n, none = flight.end.copy(), len(flow.model.states), np.empty(0)
    span, steps, end = AT_ONCE * flight.end_time, flight.steps, flight.end_time
    for _ in range(CLOCKS):
        y[n:] = flow.begun(y, 0.0, span)
        rest = flow.fly(y, 0.0, span, none, TRIED)
        when, fired, after, _ = _next_event(flow, rest, y, 0.0, sides)
        if fired:
            rest = _cut(flow, rest, y, 0.0, when, none)
        steps, end, y = steps + rest.steps, end + rest.end_time, rest.end.copy()
        if fired:
            return replace(flight, end=y, end_time=end, steps=steps, outcome=DONE, why=""), fired, after
        if rest.outcome != STOPPED or not np.isfinite(y).all():
            break
    return flight, (), sides


def _up_to_the_end(flight: Flight, wanted: Array) -> Flight:
    """With the wanted times that are later by rounding alone."""
    late = wanted[len(flight.t) :]
    samples = np.vstack([flight.samples, np.tile(flight.end, (len(late), 1))])
    return replace(flight, t=np.concatenate([flight.t, late]), samples=samples)


def _jumped(
    flow: _WithClock, y: Array, t: float, fired: tuple[int, ...], interval: float, reach: Array
) -> tuple[list[Jump], Array, _Sides, str]:
    """The jumps at t, the state after them, the sides there, and why it cannot go on.

    interval : since the last jump.  reach : the largest |when| that were looked at.
    """
    n, at = len(flow.model.states), np.array([t])
    landed, slope = (a[0] for a in flow.seen(y[None, :], at))
    jumps: list[Jump] = []
    before, ever, last = landed, set(fired), slope
    while fired:
        after = _after(flow, y, t, fired)
        if isinstance(after, str):
            return jumps, y, _free(np.sign(before), reach), after
        jumps.append(Jump(t, fired, y[:n].copy(), after[:n].copy()))
        y = after
        if not np.isfinite(y).all():
            return jumps, y, _free(np.sign(before), reach), "a jump leads to no finite state"
        when, last = (a[0] for a in flow.seen(y[None, :], at))
        small = _rounding(landed, slope, interval, t, reach)
        carried = [
            k for k, e in enumerate(flow.events)
            if k not in fired and abs(when[k]) > small[k] and abs(before[k]) > small[k]
            and np.sign(when[k]) != np.sign(before[k]) and np.sign(when[k]) in SENSES[e.direction]
        ]  # fmt: skip
        fired, before = tuple(carried), when
        ever |= set(fired)
        if len(jumps) > CHAIN:
            return jumps, y, _free(np.sign(when), reach), "events fire each other without end"
    small = _rounding(landed, slope, interval, t, reach)
    on = np.array([k in ever and abs(before[k]) <= small[k] for k in range(before.size)])
    if bool((on & (np.abs(last) <= AT_ONCE * np.abs(slope))).any()):
        k = int(np.flatnonzero(on & (np.abs(last) <= AT_ONCE * np.abs(slope)))[0])
        why = f"the jump leaves the solution on its own surface: {_named(flow, k)} stays zero, or touches it"
        return jumps, y, _free(np.sign(before), reach), why
    with np.errstate(divide="ignore", invalid="ignore"):
        leave = 8.0 * small / np.abs(last) + 8.0 * np.spacing(t)
    return jumps, y, _Sides(np.where(on, np.sign(last), np.sign(before)), np.where(on, leave, -1.0), reach), ""


def _rounding(landed: Array, slope: Array, interval: float, t: float, reach: Array) -> Array:
    """How near zero `when` is on its surface after landing there, to what the time t since the last jump resolves.

    It moves by about `reach` in this time: in a spike's last moment its slope says nothing of that.
    """
    near = max(1e-9 * interval, 8.0 * float(np.spacing(t)))
    moved = np.minimum(np.abs(slope) * interval, np.where(reach > 0.0, STEEPER * reach, np.inf))
    return np.asarray(10.0 * np.abs(np.where(np.abs(landed) < near * np.abs(slope), landed, 0.0)) + AT_ONCE * moved)


def _after(flow: _WithClock, y: Array, t: float, fired: tuple[int, ...]) -> Array | str:
    """The state after these events at once, from the values before; in words where they disagree."""
    values: Mapping[str, float] = flow.values(y, t)
    set_by: dict[str, float] = {}
    for k in fired:
        for name, formula in flow.events[k].jumps.items():
            value = float(evaluate(formula, values))
            if name in set_by and set_by[name] != value:
                return f"two events at the same time set {name} to {set_by[name]:.6g} and to {value:.6g}"
            set_by[name] = value
    after = y.copy()
    for name, value in set_by.items():
        after[flow.model.state_names.index(name)] = value
    return after


def _accumulation(jumps: list[Jump]) -> str:
    """In words, where the events come faster and faster with a limit (Zeno); else empty."""
    times = np.array([j.time for j in jumps[-1000:]])
    gaps = np.diff(times)
    if len(gaps) < RUN or not (gaps[-RUN:] > 0.0).all():
        stuck = len(gaps) >= CHAIN and float(gaps[-CHAIN:].max()) <= 4.0 * np.spacing(times[-1])
        return f"{CHAIN} events without time between them" if stuck else ""
    with np.errstate(divide="ignore", invalid="ignore"):  # events at the same time
        ratios = gaps[1:] / gaps[:-1]
    growing = np.flatnonzero(~(ratios < 1.0))
    begin = int(growing[-1]) + 1 if len(growing) else 0
    if len(gaps) - begin < RUN:
        return ""
    rest = gaps[-1] * ratios[-1] / (1.0 - ratios[-1])
    if not rest <= NEAR * gaps[begin]:
        return ""
    return (
        f"infinitely many events before t = {times[-1] + rest:.9g}: each interval is {ratios[-1]:.4g} times the one "
        "before; what comes then the equations do not say"
    )


def _named(flow: _WithClock, k: int) -> str:
    return f"event {k + 1} ({to_text(flow.events[k].when)[:60]})"
