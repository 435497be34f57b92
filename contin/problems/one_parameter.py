"""Solutions of a system in one of its parameters: what follows from the parameters' values alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np

from contin.abi import Array
from contin.problems.of_system import ProblemOfSystem

if TYPE_CHECKING:
    from contin.systems.protocol import System


@dataclass(frozen=True, eq=False)
class InOneParameterProblem(ProblemOfSystem):
    """`base` holds all parameter values (m,); entry `active` varies, and is the last unknown."""

    system: System
    base: Array
    active: int

    @cached_property
    def n(self) -> int:
        return int(self.system.n)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return (self.system.parameter_names[self.active],)

    def with_active(self, name: str, z: Array | None = None) -> Self:
        """The same system with another parameter free; the present one is frozen at its value in z."""
        base = self.base.copy()
        if z is not None:
            base[self.active] = z[-1]
        return replace(self, base=base, active=list(self.system.parameter_names).index(name))

    def full_parameters(self, z: Array) -> Array:
        """All parameter values at z."""
        p = self.base.copy()
        p[self.active] = z[-1]
        return p

    def rows_of_parameters(self, z: Array) -> Array:
        """All parameter values at rows z."""
        p = np.empty((len(z), self.base.size))
        p[:] = self.base
        p[:, self.active] = z[:, -1]
        return p
