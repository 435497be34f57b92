"""Solutions that are fixed points of another map: cycles of maps, and periodic orbits by their return map."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

from contin.abi import Array
from contin.continuation.choices import Choices
from contin.continuation.problem import Problem
from contin.problems.equilibria.equilibrium import EquilibriumProblem


@dataclass(frozen=True, eq=False)
class OfFixedPoints(Problem):
    """`inner` is the problem of the fixed points, with the same parameters."""

    inner: EquilibriumProblem

    locus = None
    is_map = True

    @property
    def n(self) -> int:
        return self.inner.n

    @property
    def base(self) -> Array:
        return self.inner.base

    @property
    def active(self) -> int:
        return self.inner.active

    @property
    def parameters(self) -> tuple[str, ...]:
        return self.inner.parameters

    def with_active(self, name: str, z: Array | None = None) -> Self:
        """The same solutions with another parameter free."""
        return replace(self, inner=self.inner.with_active(name, z))

    def constants(self) -> dict[str, float]:
        return self.inner.constants()

    @property
    def formulas(self) -> object:
        return self.inner.formulas

    def choices(self, z: Array) -> Choices:
        return self.inner.choices(z)

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return self.inner.default_range(parameter)
