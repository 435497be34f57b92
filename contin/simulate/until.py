"""Trajectories that stop where a condition becomes true.

The condition is given to the integrator as a switching surface: a further state e' = (1 if condition else -1) costs
nothing, its crossings are landed on exactly, and the first turn of its slope from -1 to 1 is the event.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.model.expression import Expression, if_, number, symbol
from contin.model.parts import TIME, State
from contin.records import Fields
from contin.simulate.condition import condition
from contin.simulate.flight import CROSSINGS, Flight, fly

if TYPE_CHECKING:
    from contin.model.model import Model

CLOCK: Final = "event clock"  # no name in a model contains a blank
PARTS: Final = 64  # of the time, looked at one after the other
ALWAYS: Final = 1e-12  # relative: a clock that ran back all the time


def with_clock(model: Model, until: str) -> Any:
    """The flow with the further state e' = (1 if the condition holds else -1)."""
    names = {n: symbol(n) for n in (*model.state_names, *model.parameter_names)}
    if model.kind == "flow":
        names[TIME] = symbol(TIME)
    holds = condition(until, {**model.observables, **model.definitions, **names}, model.functions, "until")
    if set("=!") & set(until.replace("<=", "").replace(">=", "")):
        raise InputError(f"until: {until!r}: a single value is crossed, not met; write < or >")
    return with_event(model, holds)


def with_event(model: Model, holds: Expression) -> Any:
    """The flow with the further state e' = (1 if the condition `holds` else -1)."""
    return model.replace(
        states=(*model.states, State(CLOCK, number(0))),
        equations=(*model.equations, if_(holds, number(1), number(-1))),
        symmetries=(), starts=(), averaging=None, rotation={}, expect=(), observables={},
    )  # fmt: skip


def fly_until(
    clocked: Any, u: Array, p: Array, duration: float, *, times: Array, rtol: float, atol: Array, box: float,
    budget: int, begin: float = 0.0,
) -> tuple[Flight, bool]:  # fmt: skip
    """(flight, whether the event came): from `begin` to the end, `duration`, or to the event; states without
    the clock.

    clocked : the compiled system of `with_clock`. The event is where the condition becomes true; one that holds from
    the beginning must first become false.
    """
    errors = np.append(atol, 1e-3 * rtol * (duration - begin))  # of the clock: it runs for the time of the flight
    boxes = np.append(np.full(len(atol), box), np.inf)
    options: Fields = {"rtol": rtol, "atol": errors, "box": boxes}
    y, t, steps, crossed, before = np.append(np.asarray(u, dtype=float), 0.0), begin, 0, 0, 1.0
    kept_t, kept_u = [times[:0]], [np.empty((0, y.size))]
    length, came = (duration - begin) / PARTS, False
    while True:
        last = t + length >= duration * (1.0 - 1e-12)
        y[-1] = 0.0
        wanted = times[(times > t if t > begin else times >= begin) & ((times <= t + length) | last)]
        flight = fly(clocked, y, p, duration - t if last else length, start=t, times=wanted, budget=budget, **options)
        if flight.crossed > CROSSINGS:
            length *= 0.5  # not all crossings are known
            continue
        when, before = _turn(clocked, flight, y, p, t, before, options)
        if when is not None:
            came = True
            wanted = wanted[wanted <= when]
            if when > t:
                flight = fly(clocked, y, p, when - t, start=t, times=wanted, **options)
            else:  # at the very beginning of this part of the time
                kept = int(np.searchsorted(flight.t, t, side="right"))
                flight = replace(flight, t=flight.t[:kept], samples=flight.samples[:kept], end_time=t, end=y.copy())
        kept_t.append(flight.t)
        kept_u.append(flight.u)
        steps, crossed = steps + flight.steps, crossed + flight.crossed
        budget -= flight.steps
        if came or last or flight.outcome != "done":
            break
        y, t = flight.end.copy(), flight.end_time
    n = clocked.n - 1
    whole = replace(
        flight, n=n, t=np.concatenate(kept_t), samples=np.vstack(kept_u)[:, :n], end=flight.end[:n], steps=steps,
        crossed=crossed,
    )  # fmt: skip
    return whole, came


def _turn(
    clocked: Any, flight: Flight, y: Array, p: Array, t: float, before: float, options: Fields
) -> tuple[float | None, float]:
    """When the clock turned from -1 to 1 in this flight, if it did; and its last slope."""
    span = flight.end_time - t
    ran = float(flight.end[-1] - y[-1])
    if span <= 0.0:
        return None, before
    if ran <= -span * (1.0 - ALWAYS):
        return None, -1.0
    inner = np.unique(flight.crossings[:, 0]) if flight.crossed else np.empty(0)
    inner = inner[(inner > t) & (inner < flight.end_time)]
    places = np.concatenate([[t], inner, [flight.end_time]])
    clock = np.full(len(places), float(y[-1]))
    if len(inner):
        clock[1:-1] = fly(clocked, y, p, span, start=t, times=inner, **options).u[: len(inner), -1]
    clock[-1] = flight.end[-1]
    slopes = np.sign(np.diff(clock))
    for place, slope, earlier in zip(places[:-1], slopes, [before, *slopes[:-1]], strict=True):
        if slope > 0.0 > earlier:
            return float(place), 1.0
    return None, float(slopes[-1])
