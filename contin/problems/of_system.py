"""What follows from the values of a system's parameters alone, in one varying parameter or in two."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.abi import Array
from contin.continuation.choices import Choices
from contin.continuation.problem import Problem
from contin.problems.surfaces.of_parameters import choices_of

if TYPE_CHECKING:
    from contin.systems.protocol import System


class ProblemOfSystem(Problem):
    """`base` holds the values (m,) of all parameters of `system`."""

    if TYPE_CHECKING:  # fields of some, properties of others

        @property
        def system(self) -> System: ...
        @property
        def base(self) -> Array: ...

    def constants(self) -> dict[str, float]:
        return {name: float(v) for name, v in zip(self.system.parameter_names, self.base, strict=True)}

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        """The model's own range of a parameter, at the present parameter values."""
        return self.system.model.parameter_range(parameter, self.constants())

    @property
    def formulas(self) -> object:
        return self.system.model

    def choices(self, z: Array) -> Choices:
        return choices_of(self, z)
