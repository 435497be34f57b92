"""What a curve of special orbits is solved with on one mesh: the kernel's memory, borders, and the sense of normals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_march import new_memory
from contin.kernels.special_orbits.memory import Borders, new_curve_memory
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

KINDS: Final = {"LPC": 0, "PD": 1, "NS": 2, "BPC": 3}


@dataclass(eq=False)
class Normals:
    """Unit normals of a curve of folds in the plane of the parameters, at the points where they are known."""

    rows: Array = field(default_factory=lambda: np.empty((0, 5)))  # place (3), normal (2)
    count: int = 0

    def room_for(self, more: int) -> Array:
        """The rows, of which at least `more` are free."""
        if len(self.rows) < self.count + more:
            self.rows = np.concatenate([self.rows, np.empty((self.count + 2 * more, 5))])
        return self.rows


@dataclass(frozen=True, eq=False)
class Gauge:
    """What the equations near a stretch of a curve are written with: borders, and the sense of its normals there.

    side : determinant and form of `contin.kernels.special_orbits.sides` at the point that was measured last.
    """

    mesh: Array
    borders: tuple[Array, ...]  # as those of `kernels.special_orbits.memory.Borders`
    normals: Array  # rows of `Normals`
    side: Array = field(default_factory=lambda: np.zeros(5))


@dataclass(eq=False)
class Work:
    """Memory of the kernel for one mesh, with borders that it carries on along the curve. No answer is kept in it."""

    mesh: Array
    points: Any
    factors: Any
    scratch: Any
    memory: Any
    borders: Any
    weights: Array  # of differences between the neighbours of the inner nodes, repeated for every state
    normals: Normals = field(default_factory=Normals)
    side: float = 0.0

    @property
    def nodes(self) -> int:
        """Number of node values, the place of the period in z."""
        return int(self.memory.y.shape[1]) - 3

    @classmethod
    def of(cls, type_: str, orbits: OrbitEquations, p: Array, mesh: Array) -> Work:
        """Memory for curves of a type; `orbits` is the problem of the orbits, p all parameters."""
        n, m, count = orbits.n, orbits.points, len(mesh)
        free = n - 1 if orbits.autonomous else n
        size = (count * m + 1) * n + count + 2
        points, factors, scratch = new_memory(n, m, free, count, size, p)  # type: ignore[no-untyped-call]
        memory = new_curve_memory(KINDS[type_], n, m, free, count, p.size)  # type: ignore[no-untyped-call]
        borders = Borders(np.zeros(2), np.zeros(2), np.zeros((2, n + 2)), np.zeros((n, 2)), np.zeros((n, 2)))
        times = Profile(m, np.empty((count * m + 1, n)), 1.0, mesh, 0.0).times
        weights = np.repeat(1.0 / (times[2:] - times[:-2]), n)
        return cls(mesh, points, factors, scratch, memory, borders, weights)

    def take(self, gauge: Gauge) -> None:
        """Go on with what was chosen elsewhere: the kernel writes into copies."""
        for own, chosen in zip(self.borders, gauge.borders, strict=True):
            own[:] = chosen
        self.normals = Normals(gauge.normals, len(gauge.normals))
        self.side = float(gauge.side[0])
        self.memory.form[:] = gauge.side[1:].reshape(2, 2)

    def gauge(self) -> Gauge:
        """What the kernel has left."""
        known = self.normals
        side = np.append(self.side, self.memory.form)
        return Gauge(self.mesh, tuple(border.copy() for border in self.borders), known.rows[: known.count].copy(), side)
