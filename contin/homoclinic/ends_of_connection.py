"""What tells of the ends of an orbit that connects cycles or equilibria needs to know of the equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.model.model import Model


@dataclass(frozen=True, eq=False)
class EndsOfConnection(BoundaryProblem):
    """`flow` is the system whose orbits these are, `cycles` the ends (1, 2) that are cycles, `units` the states'."""

    flow: CompiledSystem | None = None
    cycles: tuple[int, ...] = ()
    units: Array | None = None

    def length(self, offsets: Array) -> Array:
        """Of offsets (.., n) between states, in their units."""
        return np.asarray(np.linalg.norm(offsets if self.units is None else offsets / self.units, axis=-1))

    @property
    def model(self) -> Model:
        assert self.flow is not None
        return self.flow.model
