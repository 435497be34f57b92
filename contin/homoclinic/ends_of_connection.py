"""What tells of the ends of an orbit that connects cycles or equilibria needs to know of the equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contin.bvp.boundary_problem import BoundaryProblem

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.model.model import Model


@dataclass(frozen=True, eq=False)
class EndsOfConnection(BoundaryProblem):
    """`flow` is the system whose orbits these are, `cycles` the ends (1, 2) that are cycles."""

    flow: CompiledSystem | None = None
    cycles: tuple[int, ...] = ()

    @property
    def model(self) -> Model:
        assert self.flow is not None
        return self.flow.model
