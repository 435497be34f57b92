"""Where points are in the box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.diagram.phase.lines import Box, unit


@dataclass(frozen=True)
class Places:
    """The box and the names of its two parameters."""

    parameters: tuple[str, str]
    box: Box

    def holds(self, point: SpecialPoint) -> bool:
        return all(low <= point.values[n] <= high for n, (low, high) in zip(self.parameters, self.box, strict=True))

    def of(self, point: SpecialPoint) -> Array:
        """(2,) where a point is, as parts of the sides."""
        return np.asarray(unit(np.array([point.values[name] for name in self.parameters]), self.box))

    def words(self, point: SpecialPoint) -> str:
        return ", ".join(f"{name} = {point.values[name]:.6g}" for name in self.parameters)

    def pair(self, axis: int, place: float, value: float) -> str:
        """In words: parameter `axis` at a place, the other one at a value."""
        return f"{self.parameters[axis]} = {place:.6g}, {self.parameters[1 - axis]} = {value:.6g}"
