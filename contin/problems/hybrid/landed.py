"""The state in which a solution lands on the surface of an event, and its derivatives, from the time of landing, about.

A flight with variations takes the solution there. Next to a singularity, as at the top of a spike, it does not arrive,
or not where the flight before it did: what is left is flown anew then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.landing import ACCURACY, BUDGET, SMALLER, first_landing
from contin.simulate.flight import DONE, STOPPED, Flight, fly
from contin.simulate.resets import CLOCKS
from contin.simulate.section import Section

if TYPE_CHECKING:
    from contin.problems.hybrid.flow import HybridFlow

    Landed = tuple[float, Array, Array, float]

POLISHED: Final = 1e-5  # of the time of an arc: the landing is that near
EARLIER: Final = (1e-6, 1e-4, 1e-2)  # ... and that much before it, in turn, what is left is flown anew


def landed_after(
    flow: HybridFlow, event: int, u: Array, p: Array, sizes: Array, accuracy: float, time: float, patience: float
) -> Landed | None:  # fmt: skip
    """Exact time, state on the surface (n,), its derivatives (n, n + m) and the rate of h there.

    accuracy : relative tolerance of the flights.  patience : how long the event is waited for.
    None where no flight arrives.
    """
    landed = _landed(flow, event, u, p, sizes, accuracy, time)
    if landed is None:
        landed = _by_clocks(flow, event, u, p, sizes, accuracy, time)
    return _late(flow, event, u, p, sizes, accuracy, time, patience) if landed is None else landed


def _flow(
    flow: HybridFlow, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> tuple[Array, Array] | None:  # fmt: skip
    """The state after some time, and its derivatives (n, n + m) by the first state and the parameters."""
    flight = _with_variations(flow, u, p, sizes, accuracy, time)
    if flight.outcome != DONE or not np.isfinite(flight.end).all():
        return None
    return flight.end[: flow.n], flight.variations


def _with_variations(
    flow: HybridFlow, u: Array, p: Array, sizes: Array, accuracy: float, time: float, to: Section | None = None
) -> Flight:  # fmt: skip
    n, m = flow.n, flow.m
    columns = np.concatenate([np.full(n, -1), n + np.arange(m)])
    return fly(
        flow.system, u, p, time, variations=np.eye(n, n + m), columns=columns, rtol=accuracy,
        atol=SMALLER * accuracy * sizes, budget=BUDGET, section=to, events=0 if to is None else 1,
    )  # fmt: skip


def _landed(
    flow: HybridFlow, event: int, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> Landed | None:  # fmt: skip
    """By one flight; None where it does not end near the surface."""
    found = _flow(flow, u, p, sizes, accuracy, time)
    return None if found is None else _on_surface(flow, event, p, time, *found)


def _on_surface(
    flow: HybridFlow, event: int, p: Array, time: float, before: Array, change: Array
) -> Landed | None:  # fmt: skip
    """From a state near the surface, and its derivatives, along a straight line; None where that is not near enough."""
    n = flow.n
    surface, field = flow.surface(event, before, p), flow.system.value(before, p)
    late = -surface.value / surface.rate if surface.rate != 0.0 else np.nan
    if not abs(late) < POLISHED * time:
        return None
    landed, gradient = before + late * field, surface.gradient
    bend = abs(flow.surface(event, landed, p).rate / surface.rate - 1.0)
    if not abs(late) * min(bend, 1.0) <= ACCURACY * time:  # in a spike h is no straight line for so long
        return None
    by_time = -(gradient[:n] @ change + np.append(np.zeros(n), gradient[n:])) / surface.rate
    return time + late, landed, change + np.outer(field, by_time), surface.rate


def _by_clocks(
    flow: HybridFlow, event: int, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> Landed | None:  # fmt: skip
    """On a plane, by flights that end there: each that stops before is followed by one with a clock of its own."""
    plane, n, total = flow.plane(event, p), flow.n, 0.0
    if plane is None:
        return None
    matrix, span = np.eye(n, n + flow.m), (1.0 + POLISHED) * time
    for _ in range(CLOCKS):
        flight = _with_variations(flow, u, p, sizes, accuracy, span, plane)
        if not np.isfinite(flight.end).all():
            return None
        change, u = flight.variations, flight.end[:n]
        matrix = np.hstack([change[:, :n] @ matrix[:, :n], change[:, :n] @ matrix[:, n:] + change[:, n:]])
        total, span = total + flight.end_time, ACCURACY * time
        if len(flight.events):
            return _on_surface(flow, event, p, total, u, matrix) if abs(total - time) < POLISHED * time else None
        if flight.outcome != STOPPED:
            return None
    return None


def _late(
    flow: HybridFlow, event: int, u: Array, p: Array, sizes: Array, accuracy: float, time: float, patience: float
) -> Landed | None:  # fmt: skip
    """`_landed` in two flights, the second from shortly before the surface.

    Where a solution escapes to infinity just beyond, two integrations differ by more than the time between: neither
    arrives where the other one does.
    """
    n = flow.n
    for part in EARLIER:
        early = part * time
        first = _flow(flow, u, p, sizes, accuracy, time - early)
        if first is None:
            continue
        left = first_landing(flow, event, first[0], p, sizes, early, patience, leaves=False)
        if left is None:
            continue
        last = _landed(flow, event, first[0], p, sizes, accuracy, left)
        if last is None:
            continue
        change = last[2][:, :n] @ first[1]
        change[:, n:] += last[2][:, n:]
        return time - early + last[0], last[1], change, last[3]
    return None
