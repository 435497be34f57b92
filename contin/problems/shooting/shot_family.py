"""Orbits that are shot: how many segments, how accurate, in which fixed space; no trajectory is computed here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from contin.abi import Array
from contin.model.evaluate import evaluate
from contin.problems.orbits.family import FamilyOfOrbits
from contin.problems.orbits.measured.measures import Measures
from contin.problems.shooting.fixed_space import FixedSpace
from contin.problems.shooting.layout import sizes_of
from contin.symbolic.calculus.derivatives import derivative

ACCURACY = 1e-11  # relative tolerance of the trajectories along a branch
BUDGET = 200_000  # steps of one segment
RESOLUTION = 1e-6  # distance from a connecting orbit at which a curve of orbits is taken to have come to it


@dataclass(frozen=True, eq=False)
class ShotFamily(FamilyOfOrbits):
    """phi_T(u, p) = u + winding in M segments, with a phase; z as in `contin.problems.shooting.layout`.

    count : segments M.  multiple : forcing periods in one orbit.  accuracy : relative tolerance of the trajectories;
    `budget` : most steps of one segment.  held : by number of the segment, the flow with some surfaces held there.
    fixed : fixed space of the symmetries that keep every point of the orbits; None where they are free to leave it.

    Cost of a Newton step: M trajectories with n + 1 variations, and a dense solve of size M n + 2.
    """

    multiplied_out = True

    count: int = 1
    multiple: int = 1
    accuracy: float = ACCURACY
    budget: int = BUDGET
    held: Mapping[int, Any] = field(default_factory=dict)
    fixed: FixedSpace | None = None
    measures: Measures | None = None  # columns that are asked for beside those of every family

    maximum_chunk = 20

    @cached_property
    def angle_periods(self) -> Array:
        """Of the unknowns z without the last, (N - 1,)."""
        states = np.asarray(self.system.model.periods(self.constants()), dtype=float)
        return np.concatenate([np.tile(states, self.count), np.zeros(self.n + 2)])

    def precise(self, accuracy: float) -> Self:
        """The same orbits with trajectories of another accuracy."""
        return replace(self, accuracy=accuracy)

    def free(self) -> Self:
        """The same orbits, and those beside them that break their symmetries."""
        return self if self.fixed is None else replace(self, fixed=None)

    def at_base(self, base: Array) -> Self:
        """The same orbits with other parameter values."""
        return replace(self, base=base)

    def forcing_period(self, parameter: float) -> tuple[float, float]:
        """Period of the orbit of a forced system, and its derivative by the active parameter."""
        formula = self.system.forcing_period
        values = self.constants() | {self.parameters[0]: float(parameter)}
        slope = derivative(formula, self.parameters[0])
        return self.multiple * float(evaluate(formula, values)), self.multiple * float(evaluate(slope, values))

    def sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric."""
        return sizes_of(scale, self.n)

    def period_place(self, z: Array) -> int:
        return len(z) - self.n - 3

    @property
    def resolution(self) -> float:
        """Nearer to a connecting orbit there is little more to see than its period, which grows without bound."""
        return RESOLUTION
