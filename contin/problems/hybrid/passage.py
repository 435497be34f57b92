"""The map from the states after the last event of a cycle to the states after its next one, with its derivatives.

In every arc the solution flows from u until h_k(u) = 0 for the event k of the arc, and jumps, u -> g_k(u) (perhaps
again, by events that the jump itself carries over their surfaces). With the fundamental matrix X of the arc and the
time of landing by the implicit function theorem,

    du_- = X du + f dt,   dt = -grad h . X du / (grad h . f),   du_+ = Dg du_-,

and so by the parameters. States that the cycle's last jump sets to values without states in them begin with these.
Otherwise the matrix has f in its kernel: on its quotient by f it is the monodromy matrix, whose
saltation matrices are S = Dg + (f_+ - Dg f_-) grad h^T / (grad h . f_-) (Leine and Nijmeijer 2004, ch. 7).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.landing import ACCURACY, BUDGET, SMALLER, first_landing
from contin.simulate.flight import DONE, fly

if TYPE_CHECKING:
    from contin.problems.hybrid.flow import HybridFlow

POLISHED: Final = 1e-5  # of the time of an arc: the landing is that near
EARLIER: Final = (1e-6, 1e-4, 1e-2)  # ... and that much before it, in turn, what is left is flown anew


@dataclass(frozen=True)
class Arc:
    """The event that an arc ends with, those that its jump sets off at once, and how long the arc takes, about.

    length : on the orbit that the family began with.
    patience : how long its event is waited for.
    leaves : it begins on the surface of its event.
    """

    event: int
    then: tuple[int, ...]
    length: float
    patience: float
    leaves: bool


@dataclass(frozen=True, eq=False)
class Flown:
    """An arc from `begin` that takes `time` to `before`, whence it jumps to `after`; `rate` of h on landing.

    matrix (n, n + m): derivatives of `after` by `begin` and the parameters.
    """

    arc: Arc
    begin: Array
    time: float
    before: Array
    after: Array
    rate: float
    matrix: Array


@dataclass(frozen=True, eq=False)
class Passage:
    """All arcs of a cycle from the state u; the map's value is the state at the end without the winding."""

    flown: tuple[Flown, ...]
    value: Array
    matrix: Array  # (n, n + m)

    @property
    def period(self) -> float:
        return float(sum(f.time for f in self.flown))


def pass_through(
    flow: HybridFlow, arcs: tuple[Arc, ...], winding: Array, u: Array, p: Array, sizes: Array,
    accuracy: float = ACCURACY,
) -> Passage | None:  # fmt: skip
    """None where an event of the cycle does not come, or the flow has no value.

    accuracy : relative tolerance of the trajectories.
    """
    n = flow.n
    (at, matrix), found = flow.entered((arcs[-1].event, *arcs[-1].then), u, p), []
    for arc in arcs:
        flown = _fly_arc(flow, arc, at, p, sizes, accuracy)
        if flown is None:
            return None
        found.append(flown)
        by_states = flown.matrix[:, :n]
        matrix = np.hstack([by_states @ matrix[:, :n], by_states @ matrix[:, n:] + flown.matrix[:, n:]])
        at = flown.after
    return Passage(tuple(found), at - winding, matrix)


def _fly_arc(flow: HybridFlow, arc: Arc, u: Array, p: Array, sizes: Array, accuracy: float) -> Flown | None:
    n = flow.n
    if not (np.isfinite(u).all() and np.isfinite(p).all()):
        return None
    time = first_landing(flow, arc.event, u, p, sizes, arc.length, arc.patience, leaves=arc.leaves)
    if time is None:
        return None
    landed = _landed(flow, arc.event, u, p, sizes, accuracy, time)
    if landed is None:  # next to a singularity, as at the top of a spike: what it is to restart there decides
        landed = _landed_late(flow, arc, u, p, sizes, accuracy, time)
    if landed is None:
        return None
    time, before, change, rate = landed
    after = before
    for k in (arc.event, *arc.then):
        after, jump = flow.jumped(k, after, p)
        change = jump[:, :n] @ change
        change[:, n:] += jump[:, n:]
    return None if not np.isfinite(after).all() else Flown(arc, u, time, before, after, rate, change)


def _flow(
    flow: HybridFlow, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> tuple[Array, Array] | None:  # fmt: skip
    """The state after some time, and its derivatives (n, n + m) by the first state and the parameters."""
    n, m = flow.n, flow.m
    columns = np.concatenate([np.full(n, -1), n + np.arange(m)])
    flight = fly(
        flow.system, u, p, time, variations=np.eye(n, n + m), columns=columns, rtol=accuracy,
        atol=SMALLER * accuracy * sizes, budget=BUDGET,
    )  # fmt: skip
    if flight.outcome != DONE or not np.isfinite(flight.end).all():
        return None
    return flight.end[:n], flight.variations


def _landed(
    flow: HybridFlow, event: int, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> tuple[float, Array, Array, float] | None:  # fmt: skip
    """Exact time, state on the surface, its derivatives and the rate of h there; None where it is not near."""
    n, found = flow.n, _flow(flow, u, p, sizes, accuracy, time)
    if found is None:
        return None
    before, change = found
    surface, field = flow.surface(event, before, p), flow.system.value(before, p)
    late = -surface.value / surface.rate if surface.rate != 0.0 else np.nan
    if not abs(late) < POLISHED * time:
        return None
    gradient = surface.gradient
    by_time = -(gradient[:n] @ change + np.append(np.zeros(n), gradient[n:])) / surface.rate
    return time + late, before + late * field, change + np.outer(field, by_time), surface.rate


def _landed_late(
    flow: HybridFlow, arc: Arc, u: Array, p: Array, sizes: Array, accuracy: float, time: float
) -> tuple[float, Array, Array, float] | None:  # fmt: skip
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
        left = first_landing(flow, arc.event, first[0], p, sizes, early, arc.patience, leaves=False)
        if left is None:
            continue
        last = _landed(flow, arc.event, first[0], p, sizes, accuracy, left)
        if last is None:
            continue
        change = last[2][:, :n] @ first[1]
        change[:, n:] += last[2][:, n:]
        return time - early + last[0], last[1], change, last[3]
    return None
