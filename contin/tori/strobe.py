"""The map whose invariant circles are looked for: a flow seen after a time T, or a map itself.

phi(u, T, p): of an autonomous flow the state after T, which is an unknown; of a periodically forced one the state after
`multiple` periods of the forcing, from t = 0; of a map its image (T = 1). Trajectories may be piecewise smooth: their
variations jump at crossings.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.simulate.flight import DONE, fly, forcing_period
from contin.systems.iterate import IteratedSystem

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

RTOL: Final = 1e-11
RELATIVE_STEP: Final = 1e-5  # of a parameter, in the central difference of the forcing's period


@dataclass(frozen=True, eq=False)
class Strobe:
    """`base` holds all parameters, of which number `active` varies; `turn`: periods of states (0: no angle)."""

    system: CompiledSystem | IteratedSystem
    base: Array
    active: int
    turn: Array
    multiple: int = 1  # periods of the forcing; of a map 1

    @property
    def n(self) -> int:
        return int(self.system.n)

    @property
    def is_map(self) -> bool:
        return self.system.kind == "map"

    @property
    def forced(self) -> bool:
        return not self.is_map and bool(self.system.is_forced)

    @property
    def free_time(self) -> bool:
        """Whether the time T is an unknown."""
        return not self.is_map and not self.forced

    def parameters(self, value: float) -> Array:
        p = self.base.copy()
        p[self.active] = value
        return p

    def time(self, value: float) -> float:
        """T where it is no unknown."""
        if isinstance(self.system, IteratedSystem) or not self.forced:
            return 1.0
        return self.multiple * forcing_period(self.system, self.parameters(value))

    def time_slope(self, value: float) -> float:
        """dT/d(parameter) where T is no unknown."""
        if not self.forced:
            return 0.0
        h = RELATIVE_STEP * (abs(value) or 1.0)
        return (self.time(value + h) - self.time(value - h)) / (2.0 * h)

    def speed(self, u: Array, value: float, t: float = 0.0) -> Array:
        """f(u) of a flow."""
        p = self.parameters(value)
        return np.asarray(self.system.value(u, np.append(p, t) if self.system.is_forced else p))

    def image(self, u: Array, time: float, value: float) -> Array:
        """phi(u)."""
        if self.is_map:
            return np.asarray(self.system.value(u, self.parameters(value)))
        return self.path(u, time, value, np.empty(0))[1]

    def derivatives(self, u: Array, time: float, value: float) -> tuple[Array, Array, Array, Array]:
        """phi (n,), its derivatives by u (n, n), by T (n,), and by the parameter at fixed T (n,)."""
        n, p = self.n, self.parameters(value)
        if isinstance(self.system, IteratedSystem) or self.is_map:
            image, matrix = self.system.jacobian(u, p)
            return np.asarray(image), matrix[:, :n], np.zeros(n), matrix[:, n + self.active]
        _check_time(time)
        first = np.hstack([np.eye(n), np.zeros((n, 1))])
        columns = np.array([-1] * n + [n + self.active], np.int64)
        flight = fly(self.system, u, p, time, variations=first, columns=columns, rtol=RTOL)
        if flight.outcome != DONE:
            raise NoSolutionError(flight.why)
        end, moved = flight.end[:n], flight.variations
        return end, moved[:, :n], self.speed(end, value, time), moved[:, n]

    def path(self, u: Array, time: float, value: float, times: Array) -> tuple[Array, Array]:
        """States at `times` (K, n) and at the end of a flow."""
        assert not isinstance(self.system, IteratedSystem)  # which is a map
        _check_time(time)
        flight = fly(self.system, u, self.parameters(value), time, times=times, rtol=RTOL)
        if flight.outcome != DONE:
            raise NoSolutionError(flight.why)
        return flight.u, flight.end[: self.n]

    def circles(self, points: Array, value: float) -> Array:
        """(k, points, n): of a map's k-th iterate the points of all its circles, of a map those of its one."""
        if not isinstance(self.system, IteratedSystem):
            return points[None]
        p = self.parameters(value)
        return np.swapaxes(np.array([list(self.system.orbit(u, p)) for u in points]), 0, 1)

    def difference(self, a: Array, b: Array) -> Array:
        """a - b, angles modulo their periods."""
        apart = a - b
        whole = np.where(self.turn > 0.0, self.turn, 1.0)
        return np.where(self.turn > 0.0, apart - whole * np.round(apart / whole), apart)


def _check_time(time: float) -> None:
    """NoSolutionError for a period to which Newton's method cannot lead: it is positive."""
    if not time > 0.0:
        raise NoSolutionError(f"Newton's method leads to a period that is not positive ({time:.2g})")
