"""The shooting equations at a point, scaled, and how their Jacobian changes along a direction.

x = (u_1 .. u_M, T, q, p) divided by the metric. Second derivatives are never wanted but as D^2 F[d, .], along one
direction d: the central difference of the Jacobian, whose columns are variations with their jumps at the crossings.
That needs no second variational equation, and its error touches Newton's matrix only: what is solved is made of first
derivatives. Where surfaces are crossed simultaneously, in one order on one side of the orbit and in another on the
other side, the error is of first order in the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.shooting.layout import sizes_of
from contin.problems.shooting.segments import Segments
from contin.problems.shooting.shot_orbits import ShootingProblem

STEP = 1e-4  # (scaled) of the differences: their error, STEP^2, is that of the trajectories' accuracy over STEP
SMALL_STEPS = (1e-6, 1e-7, 1e-8)  # ... where surfaces are crossed, or only just not: a step stays on its side of them


@dataclass(frozen=True, eq=False)
class Expansion:
    """At an orbit's own vector (u, T, normal, offset, p) with a metric like it; `orbits` has the second parameter."""

    orbits: ShootingProblem
    second: int
    orbit: Array
    scale: Array
    width: float  # scale of the second parameter
    segments: Segments

    @classmethod
    def of(cls, orbits: ShootingProblem, second: int, orbit: Array, scale: Array, width: float) -> Expansion | None:
        """None where a trajectory does not come to its end."""
        segments = Segments.of(orbits, orbit, (second,))
        return None if segments is None else cls(orbits, second, orbit, scale, width, segments)

    @property
    def rows(self) -> int:
        """M n + 1, the number of equations."""
        return int(self.segments.nodes.u.size) + 1

    @cached_property
    def sizes(self) -> Array:
        """The states' sizes, (n,)."""
        return sizes_of(self.scale, self.orbits.n)

    @cached_property
    def units(self) -> Array:
        """Scale of x, (rows + 2,)."""
        return np.concatenate([self.scale[: self.rows], [self.width, self.scale[-1]]])

    @cached_property
    def _row_units(self) -> Array:
        return self.segments.row_units(self.scale)

    @cached_property
    def residual(self) -> Array:
        return self.segments.residual / self._row_units

    @cached_property
    def jacobian(self) -> Array:
        """(rows, rows + 2)"""
        return self._scaled(self.segments)

    def _scaled(self, segments: Segments) -> Array:
        own = segments.jacobian
        raw = np.column_stack([own[:, :-1], segments.by_others[:, 0], own[:, -1]])
        return np.asarray(raw * self.units / self._row_units[:, None])

    def along(self, direction: Array) -> Array | None:
        """D^2 F[direction, .], (rows, rows + 2); None where a trajectory fails."""
        size = float(np.linalg.norm(direction))
        if size == 0.0:
            return np.zeros_like(self.jacobian)
        here = crossed(self.segments)
        found = None
        for step in SMALL_STEPS if here else (STEP, *SMALL_STEPS):
            ahead, behind = (self._moved(sense * step / size * direction * self.units) for sense in (1.0, -1.0))
            if ahead is None or behind is None:
                continue
            found = np.asarray((self._scaled(ahead) - self._scaled(behind)) * (size / (2.0 * step)))
            if crossed(ahead) == crossed(behind) == here:
                break
        return found

    def _moved(self, raw: Array) -> Segments | None:
        """The trajectories at another point."""
        orbit = self.orbit.copy()
        orbit[: self.rows] += raw[: self.rows]
        orbit[-1] += raw[-1]
        base = self.orbits.base.copy()
        base[self.second] += raw[-2]
        return Segments.of(self.orbits.at_base(base), orbit, (self.second,))

    # -- the return map -----------------------------------------------------------------------------------------------

    @cached_property
    def transitions(self) -> Array:
        """Fundamental matrices of the segments in scaled states, (M, n, n)."""
        return np.asarray(self.segments.transitions * self.sizes / self.sizes[:, None])

    @cached_property
    def _field(self) -> tuple[Array, Array, Array] | None:
        """Scaled field at the first node, its derivative by x (n, rows + 2), and the scaled normal over normal . f."""
        if not self.orbits.autonomous:
            return None
        n, nodes = self.orbits.n, self.segments.nodes
        p = self.orbits.full_parameters(self.orbit)
        value, raw = (np.asarray(a) for a in self.orbits.system.jacobian(nodes.u[0], p))
        slope = np.zeros((n, self.rows + 2))
        slope[:, :n] = raw[:, :n]
        slope[:, -2], slope[:, -1] = raw[:, n + self.second], raw[:, n + self.orbits.active]
        return (
            value / self.sizes,
            slope * self.units / self.sizes[:, None],
            nodes.normal * self.sizes / (float(nodes.normal @ value)),
        )

    @cached_property
    def projector(self) -> NDArray[np.float64]:
        """P = 1 - f n^T / (n . f): onto the section along the flow, so that P times the monodromy matrix is the
        derivative of the return map, with 0 in the place of the trivial multiplier; of a forced system 1."""
        one = np.eye(self.orbits.n)
        return one if self._field is None else one - np.outer(self._field[0], self._field[2])

    def projector_along(self, w: Array, y: Array) -> Array:
        """The derivative by x of w^T P y, (rows + 2,)."""
        if self._field is None:
            return np.zeros(self.rows + 2)
        _, slope, normal = self._field
        return np.asarray(-float(normal @ y) * (w @ self.projector @ slope))


def crossed(segments: Segments) -> list[int]:
    """The surfaces that are crossed in a period, as often as they are; not in order, which may be none."""
    return sorted(int(surface) for flight in segments.flights for surface in flight.crossings[:, 1])
