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
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.landed import landed_after
from contin.problems.hybrid.landing import ACCURACY, first_landing

if TYPE_CHECKING:
    from contin.problems.hybrid.flow import HybridFlow


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
    landed = landed_after(flow, arc.event, u, p, sizes, accuracy, time, arc.patience)
    if landed is None:
        return None
    time, before, change, rate = landed
    after = before
    for k in (arc.event, *arc.then):
        after, jump = flow.jumped(k, after, p)
        change = jump[:, :n] @ change
        change[:, n:] += jump[:, n:]
    return None if not np.isfinite(after).all() else Flown(arc, u, time, before, after, rate, change)
