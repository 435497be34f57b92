"""Where a solution meets the surface of an event for the first time, in the event's direction.

h along the solution is sampled, for the integrator's steps know nothing of it, and in parts of these steps where many
are between two samples (a spike). Between two samples it may touch zero, or cross it twice: where a parabola through
three samples says so, the extremum is located and looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.simulate.between_samples import resolving
from contin.simulate.flight import DONE, STOPPED, Flight, fly
from contin.simulate.resets import CLOCKS, SENSES
from contin.simulate.section import Section

if TYPE_CHECKING:
    from contin.problems.hybrid.flow import HybridFlow

ACCURACY: Final = 1e-12  # relative tolerance of trajectories
SMALLER: Final = 1e-3  # ... of it, in the states' sizes: their absolute tolerance
BUDGET: Final = 200_000  # steps
FIRST: Final = 1.25  # how long to wait for an event at first, in multiples of how long it took before
SAMPLES: Final = 256  # of that time
IN_A_STEP: Final = 4  # looks within a step
ON_SURFACE: Final = 0.02  # part of that time within which a solution that starts beside its surface may leave it
AT_ONCE: Final = 1e-9  # ... and one that starts on it
NEAR: Final = 0.5  # of the change of h between samples: an extremum that near zero is looked at
TOWARDS_END: Final = np.ldexp(1.0, -np.arange(1, 5))  # parts of what is left to a solution's end, ...
NEARER: Final = 24  # ... so many times: from 16 times nearer it is integrated anew
ROUNDS: Final = 60


@dataclass(frozen=True, eq=False)
class Path:
    """States (K, n) of the solution at times (K,), and h of an event there."""

    flow: HybridFlow
    event: int
    p: Array
    sizes: Array
    t: Array
    u: Array
    h: Array

    def at(self, i: int, later: float) -> tuple[float, float]:
        """(h, rate) some time after sample i."""
        if later == 0.0:
            found = self.flow.surface(self.event, self.u[i], self.p)
            return found.value, found.rate
        flight = _fly(self.flow, self.u[i], self.p, self.sizes, np.array([later]))
        if flight.outcome != DONE:
            return np.nan, np.nan
        found = self.flow.surface(self.event, flight.end, self.p)
        return found.value, found.rate


def first_landing(
    flow: HybridFlow, k: int, u: Array, p: Array, sizes: Array, length: float, patience: float, *,
    exactly: bool = False, leaves: bool = True,
) -> float | None:  # fmt: skip
    """The time at which event k happens first after the state u; None where it does not within `patience`, or longer.

    length : how long this takes, or took on an orbit of the same family.  exactly : and not longer than `patience`.
    leaves : a solution that starts on the surface, or beside it by less than it moves in a small part of that time,
        leaves it first: a jump that ends on its own surface ends there only to rounding.
    """
    begun, leave = flow.surface(k, u, p), AT_ONCE * length
    if leaves and begun.rate != 0.0 and abs(begun.value) < ON_SURFACE * length * abs(begun.rate):
        leave = max(leave, 4.0 * abs(begun.value / begun.rate))
    met = _on_plane(flow, k, u, p, sizes, leave, patience)
    if met is not None:
        return met
    start, state = 0.0, u
    last = patience if exactly else min(FIRST * length, patience)
    while True:
        t = np.linspace(max(start, leave), last, SAMPLES + 1)
        ends: list[float] = [0.0]
        flight = _fly(flow, state, p, sizes, (t - start).astype(np.float64), ends)
        closer = start + resolving(flight.t, np.unique(ends), IN_A_STEP) if len(flight.t) == len(t) else t
        if len(closer) > len(t):
            t = closer
            flight = _fly(flow, state, p, sizes, (t - start).astype(np.float64))
        times, states, complete = start + flight.t, flight.u, len(flight.t) == len(t)
        found = _first(Path(flow, k, p, sizes, times, states, flow.heights(k, states, p)))
        if found is None and not complete:  # beyond the surface it may escape to infinity
            seen, last_seen = (float(flight.t[-1]), flight.u[-1]) if len(times) else (0.0, state)
            nearer = _towards_end(flow, k, last_seen, p, sizes, flight.end_time - seen)
            times, states = np.append(times, start + seen + nearer[0]), np.vstack([states, nearer[1]])
            found = _first(Path(flow, k, p, sizes, times, states, flow.heights(k, states, p)))
        if found is not None or exactly or not complete or last >= patience:
            return found
        start, state, last, leave = last, states[-1], 2.0 * last, 0.0


def _on_plane(
    flow: HybridFlow, k: int, u: Array, p: Array, sizes: Array, leave: float, patience: float
) -> float | None:  # fmt: skip
    """The first landing after `leave` on a surface that is a plane: the integrator looks for it, and ends there.

    It does not go on to where a spike escapes to infinity. None where there is none, or samples of the way show that
    the solution touched the plane, or crossed it twice, within a step.
    """
    plane = flow.plane(k, p)
    if plane is None:
        return None
    ends: list[float] = [0.0]
    flight = _fly(flow, u, p, sizes, np.array([patience]), ends, plane)
    end = flight.end_time
    met = end if len(flight.events) else _within_rounding(flow, flight, p, sizes, plane)
    if met is None or not end > leave:
        return None
    times = resolving(np.linspace(leave, end, SAMPLES + 1), np.unique(ends), IN_A_STEP)[:-1]
    flight = _fly(flow, u, p, sizes, times)
    if len(flight.t) < len(times):
        return None
    found = _first(Path(flow, k, p, sizes, times, flight.u, flow.heights(k, flight.u, p)))
    return met if found is None else None


def _within_rounding(flow: HybridFlow, flight: Flight, p: Array, sizes: Array, plane: Section) -> float | None:
    """When a solution that stopped meets the plane, where it does so at its last time to rounding; else None.

    A spike crosses its surface in less time than a clock that runs for long can tell: it gets a clock of its own.
    """
    time, span = flight.end_time, np.array([ACCURACY * flight.end_time])
    for _ in range(CLOCKS):
        if flight.outcome != STOPPED or not np.isfinite(flight.end).all():
            return None
        flight = _fly(flow, flight.end, p, sizes, span, None, plane)
        time += flight.end_time
        if len(flight.events):
            return time
    return None


def _towards_end(flow: HybridFlow, k: int, u: Array, p: Array, sizes: Array, left: float) -> tuple[Array, Array]:
    """Times (K,) from the state u on and states (K, n) of a solution that escapes after about `left`, up to where h of
    the event k changes its sign.

    Two integrations of one solution escape at times that differ by their errors; those of what is left fall with it.
    """
    times, states, begun, side = [np.empty(0)], [np.empty((0, flow.n))], 0.0, np.sign(flow.heights(k, u[None], p)[0])
    for _ in range(NEARER):
        if not left > 0.0:
            break
        left = _fly(flow, u, p, sizes, np.array([2.0 * left])).end_time
        flight = _fly(flow, u, p, sizes, left * (1.0 - TOWARDS_END))
        if not len(flight.t):
            break
        times.append(begun + flight.t)
        states.append(flight.u)
        if np.any(flow.heights(k, flight.u, p) * side <= 0.0):
            break
        begun, u, left = begun + float(flight.t[-1]), flight.u[-1], left - float(flight.t[-1])
    return np.concatenate(times), np.vstack(states)


def _fly(
    flow: HybridFlow, u: Array, p: Array, sizes: Array, times: Array, steps: list[float] | None = None,
    to: Section | None = None,
) -> Flight:  # fmt: skip
    return fly(
        flow.system, u, p, float(times[-1]), times=times, rtol=ACCURACY, atol=SMALLER * ACCURACY * sizes, budget=BUDGET,
        steps=steps, section=to, events=0 if to is None else 1,
    )  # fmt: skip


def _first(path: Path) -> float | None:
    """The first crossing in the event's direction."""
    wanted = SENSES[path.flow.model.events[path.event].direction]
    h = path.h
    product = h[:-1] * h[1:]
    inner = h[1:-1] * h[:-2] > 0.0
    turns = inner & (h[1:-1] * h[2:] > 0.0) & (np.abs(h[1:-1]) <= np.abs(h[:-2])) & (np.abs(h[1:-1]) <= np.abs(h[2:]))
    for i in np.flatnonzero((product <= 0.0) | np.append(turns, False)).tolist():
        if product[i] <= 0.0:
            if h[i + 1] != 0.0 and np.sign(h[i + 1]) in wanted and h[i] != 0.0:
                return float(path.t[i] + _root(path, i, 0.0, float(path.t[i + 1] - path.t[i])))
            continue
        beyond = _touch(path, i)
        if beyond is None:
            continue
        low, high = beyond, float(path.t[i + 2] - path.t[i])
        if -np.sign(h[i]) in wanted:
            return float(path.t[i] + _root(path, i, 0.0, low))
        return float(path.t[i] + _root(path, i, low, high))
    return None


def _touch(path: Path, i: int) -> float | None:
    """How long after sample i h is farthest beyond zero, of which samples i to i + 2 see nothing; None: it is not."""
    a, b, c = np.abs(path.h[i : i + 3]).tolist()
    bend = a - 2.0 * b + c
    if bend <= 0.0 or b - 0.125 * elementary.square(c - a) / bend > NEAR * max(a - b, c - b):
        return None
    side, low, high = np.sign(path.h[i]), 0.0, float(path.t[i + 2] - path.t[i])
    for _ in range(ROUNDS):
        middle = 0.5 * (low + high)
        value, rate = path.at(i, middle)
        if value * side < 0.0:
            return middle
        if rate * side < 0.0:
            low = middle
        else:
            high = middle
        if high - low <= 4.0 * np.spacing(path.t[i + 2]):
            return None
    return None


def _root(path: Path, i: int, low: float, high: float) -> float:
    """The zero of h between two times after sample i, where its signs differ: Newton's method, kept in the bracket."""
    first = path.at(i, low)[0] if low > 0.0 else float(path.h[i])
    side, tau = np.sign(first), 0.5 * (low + high)
    for _ in range(ROUNDS):
        value, rate = path.at(i, tau)
        if value * side > 0.0:
            low = tau
        else:
            high = tau
        step = -value / rate if rate != 0.0 else np.inf
        if abs(step) <= 4.0 * np.spacing(path.t[i] + tau):
            break
        newton = tau + step
        tau = newton if low < newton < high else 0.5 * (low + high)
        if high - low <= 4.0 * np.spacing(path.t[i] + tau):
            break
    return tau
