"""The solution of a flow at given times, by the integrator that its formulas and the method ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.lowering.system import compile_in_time
from contin.model.kinds import has_steps
from contin.model.model import Model
from contin.records import Fields
from contin.simulate.between_jumps import fly_between_jumps
from contin.simulate.flight import DONE, fly
from contin.simulate.held import finite_at_start, held_states
from contin.simulate.natural import absolute_tolerances
from contin.simulate.resets import Jump, fly_with_events
from contin.simulate.stepped import stepped
from contin.simulate.stiff import NONSMOOTH, integrate_stiff
from contin.simulate.until import fly_until, with_clock

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

STIFF: Final = ("Radau", "LSODA", "BDF")
EVENT: Final = "event"
NO_EVENT: Final = "no event"


@dataclass(frozen=True, eq=False)
class Path:
    """States (T, n) at the times t, where it ended and why."""

    t: Array
    states: Array
    end: float
    steps: int = 0
    crossings: int = 0
    outcome: str = DONE
    why: str = ""
    jumps: tuple[Jump, ...] = ()


def path_of(
    model: Model, system: CompiledSystem, u: Array, p: Array, times: Array, method: str, until: str | None, *,
    rtol: float, atol: float | None, box: float, budget: int,
) -> Path:  # fmt: skip
    """The solution at `times`; states that are no numbers stay out of the integration."""
    duration = float(times[-1])
    if not u.size or duration == 0.0:
        return Path(times, np.tile(u, (times.size, 1)), duration)
    if isinstance(model, Model) and model.events:
        return _with_events(model, system, u, p, times, method, until, rtol=rtol, atol=atol, box=box, budget=budget)
    if not model.mass and not finite_at_start(system, u, p):
        held = held_states(system, u, p, duration)
        if not held.moving.all():
            if until is not None:
                raise InputError("until: a state of this model is infinite or not a number")
            rest = path_of(
                (few := held.reduced(model)), compile_in_time(few), u[held.moving], p, times, method, None,
                rtol=rtol, atol=atol, box=box, budget=budget,
            )  # fmt: skip
            return replace(rest, states=held.filled(rest.t, u, rest.states))
    errors = absolute_tolerances(system, u, p, 1e-3 * rtol, atol)
    if method in STIFF:
        if until is not None:
            raise InputError("until: events are located by the method DOP853 only")
        t, states, steps, outcome, why = integrate_stiff(system, u, p, times, method, rtol, errors, box)
        rough = system.n_switches or (isinstance(model, Model) and has_steps(model))
        why = NONSMOOTH if outcome == DONE and rough else why
        return Path(t, states, float(t[-1]) if len(t) else 0.0, steps, 0, outcome, why)
    options = {"rtol": rtol, "atol": errors, "box": box, "budget": budget}
    flight, outcome, why = _flown(model, system, u, p, times, until, options)
    t, states = flight.t, flight.u
    if outcome == EVENT:
        t, states = np.append(t, flight.end_time), np.vstack([states, flight.end[None, : system.n]])
    return Path(t, states, flight.end_time, flight.steps, flight.crossed, outcome, why)


def _with_events(
    model: Model, system: CompiledSystem, u: Array, p: Array, times: Array, method: str, until: str | None, *,
    rtol: float, atol: float | None, box: float, budget: int,
) -> Path:  # fmt: skip
    if method in STIFF:
        raise InputError(f"method {method}: `events` of the model are located by the method DOP853 only")
    if until is not None:
        raise InputError("until: is not looked for beside `events` of the model; leave one of the two out")
    if has_steps(model):
        raise InputError("events are not located beside step functions (floor, ceil, mod) of states or the time")
    if not finite_at_start(system, u, p):
        raise InputError("events need states and rates that are finite at the start")
    errors = absolute_tolerances(system, u, p, 1e-3 * rtol, atol)
    flight, jumps = fly_with_events(model, u, p, times, rtol=rtol, atol=errors, box=box, budget=budget)
    return Path(
        flight.t, flight.u, flight.end_time, flight.steps, flight.crossed, flight.outcome, flight.why, jumps
    )  # fmt: skip


def _flown(
    model: Model, system: CompiledSystem, u: Array, p: Array, times: Array, until: str | None, options: Fields
) -> tuple[Any, str, str]:
    """(flight, outcome, why) of the compiled integrator."""
    if until is None:
        taken = stepped(model) if isinstance(model, Model) else None
        if taken is not None:
            flight = fly_between_jumps(taken, u, p, times, **options)
            return flight, flight.outcome, flight.why
        flight = fly(system, u, p, float(times[-1]), times=times, **options)
        return flight, flight.outcome, flight.why
    if has_steps(model):
        raise InputError("until: events are not located beside step functions (floor, ceil, mod) of states or the time")
    clocked = compile_in_time(with_clock(model, until))
    flight, came = fly_until(clocked, u, p, float(times[-1]), times=times, **options)
    if came:
        return flight, EVENT, until
    if flight.outcome != DONE:
        return flight, flight.outcome, flight.why
    return flight, NO_EVENT, f"the event {until} did not come until t = {flight.end_time:.6g}"
