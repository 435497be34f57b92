"""What carries a state and disturbances of it along: flows (smooth, piecewise, with jumps) and maps.

A disturbance of a flow jumps at switching surfaces by the saltation matrix, and at `events` by
S = Dg + (f_+ - Dg f_-) grad h^T / (grad h . f_-) (Leine and Nijmeijer 2004, ch. 7).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.problems.hybrid.flow import HybridFlow
from contin.simulate.flight import DONE, fly
from contin.simulate.resets import Jump, fly_with_events

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

SMALLER: Final = 1e-3  # absolute tolerances, in natural sizes, beside relative ones


@dataclass(frozen=True, eq=False)
class Carried:
    """The state (n,) and disturbances (n, k) at the end of an interval; `why` in words where there is none.

    touched : surfaces met with no speed, where disturbances are not defined.
    """

    u: Array
    columns: Array
    steps: int = 0
    touched: int = 0
    why: str = ""


class Carrier(Protocol):
    """Something that moves."""

    def carry(self, u: Array, columns: Array, begin: float, length: float) -> Carried:
        """From the state u at time `begin` over `length`."""
        ...


@dataclass(frozen=True, eq=False)
class FlowCarrier:
    """A flow without jumps."""

    system: CompiledSystem
    p: Array
    rtol: float
    atol: Array

    def carry(self, u: Array, columns: Array, begin: float, length: float) -> Carried:
        flight = fly(
            self.system, u, self.p, length, start=begin, variations=columns, rtol=self.rtol, atol=self.atol
        )
        n = self.system.n
        return Carried(flight.end[:n], flight.variations, flight.steps, flight.touched, flight.why)


@dataclass(frozen=True, eq=False)
class MapCarrier:
    """A map; the time counts iterates."""

    system: CompiledSystem
    p: Array

    def carry(self, u: Array, columns: Array, begin: float, length: float) -> Carried:
        full = np.append(self.p, begin) if self.system.is_forced else self.p
        value, jacobian = self.system.jacobian(u, full)
        why = "" if np.isfinite(value).all() else f"left all bounds at iterate {int(begin) + 1}"
        return Carried(np.asarray(value), np.asarray(jacobian)[:, : self.system.n] @ columns, 1, 0, why)


@dataclass(frozen=True, eq=False)
class JumpCarrier:
    """A flow with `events`; a forced one has the phase of the forcing as its last state, which nothing disturbs."""

    flow: HybridFlow
    p: Array
    rtol: float
    atol: Array

    def carry(self, u: Array, columns: Array, begin: float, length: float) -> Carried:
        times = np.array([0.0, length])
        flight, jumps = fly_with_events(
            self.flow.model, u, self.p, times, rtol=self.rtol, atol=self.atol, box=1e100, budget=10_000_000
        )
        if flight.outcome != DONE:
            return Carried(u, columns, flight.steps, 0, flight.why)
        steps, touched, at = flight.steps, flight.touched, 0.0
        for time, together in groupby(jumps, key=lambda jump: jump.time):
            if time > at:
                arc = self._arc(u, columns, time - at)
                steps, touched, columns = steps + arc.steps, touched + arc.touched, arc.columns
                if arc.why:
                    return arc
            chain = list(together)
            if any(len(jump.events) > 1 for jump in chain):
                why = f"several events at t = {begin + time:.6g}, which a disturbance parts: no linear growth there"
                return Carried(u, columns, steps, touched, why)
            columns = self._jumped(chain, columns)
            at, u = time, chain[-1].after
        if length > at:
            arc = self._arc(u, columns, length - at)
            return Carried(arc.u, arc.columns, steps + arc.steps, touched + arc.touched, arc.why)
        return Carried(u, columns, steps, touched)

    def _arc(self, u: Array, columns: Array, length: float) -> Carried:
        return FlowCarrier(self.flow.system, self.p, self.rtol, self.atol).carry(u, columns, 0.0, length)

    def _jumped(self, chain: list[Jump], columns: Array) -> Array:
        """The disturbances behind jumps without time between them: the flow led to the first, each to the next."""
        n, flow, first, last = self.flow.n, self.flow, chain[0].before, chain[-1].after
        surface = flow.surface(chain[0].events[0], first, self.p)
        late = -(surface.gradient[:n] @ columns) / surface.rate
        change = columns + np.outer(flow.system.value(first, self.p), late)
        for jump in chain:
            change = flow.jumped(jump.events[0], jump.before, self.p)[1][:, :n] @ change
        return np.asarray(change - np.outer(flow.system.value(last, self.p), late))
