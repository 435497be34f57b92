"""What all curves in two parameters have in common, whatever the points on them are."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import InputError
from contin.model.advice import place_of_parameter
from contin.problems.of_system import ProblemOfSystem
from contin.problems.scales import parameter_width

if TYPE_CHECKING:
    from contin.systems.protocol import System

UNBOUNDED = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False)
class TwoParameterProblem(ProblemOfSystem):
    """The part of `Problem` and `InTwoParameters` that follows from z = (..., q, p) alone.

    A subclass adds the metric, the march and the events of its curve, the equations `curve`: these tell the type of
    their points, the system, all parameter values (base) and the places of the two that vary (first, second).
    """

    curve: Any
    second_bounds: tuple[float, float] = field(default=UNBOUNDED, kw_only=True)
    first_bounds: tuple[float, float] = field(default=UNBOUNDED, kw_only=True)

    kind = "locus"

    @property
    def locus(self) -> str:
        return str(self.curve.type)

    @property
    def system(self) -> System:
        system: System = self.curve.system
        return system

    @property
    def base(self) -> Array:
        return np.asarray(self.curve.base)

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        names = self.system.parameter_names
        return names[self.curve.first], names[self.curve.second]

    # -- ranges -------------------------------------------------------------------------------------------------------

    def within(self, first: tuple[float, float], second: tuple[float, float]) -> Self:
        """The same curve with ranges of both parameters."""
        return replace(self, first_bounds=first, second_bounds=second)

    @property
    def walls(self) -> Sequence[tuple[int, float, float]]:
        return [(-2, *self.second_bounds), (-1, *self.first_bounds)]

    def widths(self, z: Array, first: tuple[float, float]) -> tuple[float, float]:
        """Scales of the first and the second parameter: the widths of their ranges; of an endless one, their size."""
        names = [self.system.parameter_names[k] for k in (self.curve.first, self.curve.second)]
        ranges = zip(names, (z[-1], z[-2]), (first, self.second_bounds), strict=True)
        one, two = (parameter_width(self.system.model, name, float(value), ends) for name, value, ends in ranges)
        return one, two

    def place(self, z: Array) -> str:
        """The parameters that vary at z, in words."""
        return ", ".join(f"{k} = {v:.8g}" for k, v in zip(self.parameters, z[[-1, -2]], strict=False))

    def parameter_columns(self, z: Array) -> dict[str, Array]:
        """The parameters of rows of unknowns."""
        return {name: z[:, -1 - k].copy() for k, name in enumerate(self.parameters)}

    # -- solving with one parameter fixed -----------------------------------------------------------------------------

    @abstractmethod
    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        """Solve with unknown `index` fixed at `value`, to full precision."""

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return self.at_unknown(-1, guess, value, scale)


class OnAdaptiveMesh:
    """Unknowns follow a mesh, so that their number changes: masks over them name none but the last."""

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(1, bool)

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.zeros(2, bool)


def indices(system: System, parameters: Sequence[str]) -> tuple[int, int]:
    """Places of two parameters among those of the system."""
    names = list(parameters)
    if len(names) != 2 or names[0] == names[1]:
        raise InputError(f"a curve of special points needs two parameters; got {', '.join(names)}")
    first, second = (place_of_parameter(name, system.parameter_names) for name in names)
    return first, second
