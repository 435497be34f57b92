"""Periodic orbits with jumps as fixed points of the map of a cycle of events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contin.abi import Array
from contin.problems.equilibria.fixed_points import OfFixedPoints

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.problems.hybrid.flow import HybridFlow
    from contin.problems.hybrid.passage import Passage
    from contin.problems.hybrid.return_system import ReturnSystem




@dataclass(frozen=True, eq=False)
class CycleOfEvents(OfFixedPoints):
    """Fixed points (`inner`) of the map of a cycle of events, as periodic orbits."""

    kind = "orbit"
    multiplied_out = True
    maximum_chunk = 10

    @property
    def map(self) -> ReturnSystem:
        found: ReturnSystem = self.inner.system  # type: ignore[assignment]
        return found

    @property
    def flow(self) -> HybridFlow:
        return self.map.flow

    @property
    def system(self) -> CompiledSystem:
        """The flow without its events."""
        return self.flow.described

    @property
    def angle_periods(self) -> Array:
        return self.inner.angle_periods

    def passage(self, z: Array) -> Passage | None:
        """The cycle from the solution z."""
        return self.map.passage(z[:-1], self.inner.full_parameters(z))
