"""Which values of an orbit are unknowns: those at all points (collocation), or where segments start (shooting)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contin.abi import Array, Vector
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import STAGES, WEIGHTS, A, Trajectory
from contin.problems.large_orbits.sweeps import Jumps, Sweeps


class Layout(ABC):
    """An orbit's states as a vector (S,), and the equations that belong to them."""

    @abstractmethod
    def count(self, n: int) -> int:
        """S"""

    @abstractmethod
    def vector(self, orbit: Trajectory) -> Array:
        """The unknowns (S,) of an orbit that is known at all points, or of a change of one."""

    @abstractmethod
    def orbit(self, points: Points, p: Array, states: Array, period: float) -> Trajectory:
        """The orbit at all points; NaN where there is none."""

    @abstractmethod
    def prepare(self, points: Points, p: Array, states: Array, period: float) -> None:
        """Called where a march sets out: the mesh is that of this orbit."""

    @abstractmethod
    def remember(self, sweeps: Sweeps) -> None:
        """Solvers of the linearised equations along the last orbit."""

    @abstractmethod
    def defects(self, points: Points, p: Array, states: Array, orbit: Trajectory) -> Array:
        """What is left of the equations (S,)."""

    @abstractmethod
    def jumped(self, points: Points, left: Array, jump: Array) -> Array:
        """The same where the orbit begins a jump (n,) away from where it ends."""

    @abstractmethod
    def slopes(self, points: Points, p: Array, orbit: Trajectory) -> Array:
        """Derivatives of the unknowns (S,) by the time in periods."""

    @abstractmethod
    def turned(self, points: Points, p: Array, states: Array, change: Array, period: float) -> Array:
        """The same of a small change (S,) of an equilibrium."""

    @abstractmethod
    def weights(self, orbit: Trajectory) -> Array:
        """Weights (S,) with which a sum over unknowns is the integral over a period, about."""

    @abstractmethod
    def pick(self, d: Vector, beginning: Vector, jumps: Jumps | None) -> Vector:
        """Unknowns (S,) of d (N, 3, n), which sets out from `beginning`, with what is added between intervals."""

    @abstractmethod
    def sides(self, right: Array, n: int) -> tuple[Array | None, Jumps | None]:
        """A right side of the equations (S,) as one of stages (N, 3, n), or as jumps between intervals."""

    @abstractmethod
    def carried(self, sweeps: Sweeps, states: Array, right: Callable[[], Array]) -> Array:
        """The change of all points (N, 3, n) by one (S,) of the unknowns and a right side of stages, where it acts."""

    @abstractmethod
    def finer(self) -> tuple[Layout, Callable[[Trajectory], Array] | None]:
        """The same on intervals of half the length; what makes its unknowns of an orbit, None: they are the same."""

    @abstractmethod
    def doubled(self) -> Layout:
        """Of two periods, whose unknowns are those of both."""


@dataclass(frozen=True, eq=False)
class OnPoints(Layout):
    """U (intervals, 3, n) on equal intervals: collocation."""

    intervals: int

    def count(self, n: int) -> int:
        return self.intervals * STAGES * n

    def vector(self, orbit: Trajectory) -> Array:
        moved = orbit if len(orbit.U) == self.intervals and orbit.lengths is None else orbit.refined(self.intervals)
        return moved.U.ravel()

    def orbit(self, points: Points, p: Array, states: Array, period: float) -> Trajectory:
        return Trajectory(states.reshape(self.intervals, STAGES, -1), period)

    def prepare(self, points: Points, p: Array, states: Array, period: float) -> None:
        return

    def remember(self, sweeps: Sweeps) -> None:
        return

    def defects(self, points: Points, p: Array, states: Array, orbit: Trajectory) -> Array:
        with np.errstate(all="ignore"):
            f = points.values(orbit.U.reshape(-1, orbit.U.shape[2]), p).reshape(orbit.U.shape)
        step = orbit.period * orbit.h[:, None, None]
        moved = points.weighed(orbit.U - orbit.beginnings[:, None])
        return np.asarray(moved - step * np.einsum("ik,jkn->jin", A, f)).ravel()

    def jumped(self, points: Points, left: Array, jump: Array) -> Array:
        rows = left.reshape(self.intervals, STAGES, -1).copy()
        rows[0] -= points.weighed(jump)
        return rows.ravel()

    def slopes(self, points: Points, p: Array, orbit: Trajectory) -> Array:
        return orbit.slopes.ravel()

    def turned(self, points: Points, p: Array, states: Array, change: Array, period: float) -> Array:
        return self.orbit(points, p, change, period).slopes.ravel()

    def weights(self, orbit: Trajectory) -> Array:
        return np.repeat(np.outer(orbit.h, WEIGHTS).ravel(), orbit.U.shape[2])

    def pick(self, d: Vector, beginning: Vector, jumps: Jumps | None) -> Vector:
        return d.ravel()

    def sides(self, right: Array, n: int) -> tuple[Array | None, Jumps | None]:
        return right.reshape(self.intervals, STAGES, n), None

    def carried(self, sweeps: Sweeps, states: Array, right: Callable[[], Array]) -> Array:
        return states.reshape(self.intervals, STAGES, -1)

    def finer(self) -> tuple[Layout, Callable[[Trajectory], Array] | None]:
        fine = OnPoints(2 * self.intervals)
        return fine, fine.vector

    def doubled(self) -> Layout:
        return OnPoints(2 * self.intervals)
