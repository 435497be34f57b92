"""What the search for points of codimension two asks of a curve of points of one type in two parameters."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.two_parameters import TwoParameterProblem
from contin.records import Fields

LONGEST = 1000  # rows in one kernel call, of systems with


@dataclass(frozen=True, eq=False)
class CurveOfPoints(TwoParameterProblem):
    """A curve of points of one type in two parameters; `curve` holds its equations and knows the layout of z.

    `second_bounds` is the range of the second parameter, the last unknown but one; that of the first is the engine's.
    """

    curve: Any  # ExtendedCurve, or BorderedCurve for large systems
    state_periods: Array
    memory: Fields = field(default_factory=dict)  # what the first point decided: the kind of branch points
    maximum_chunk = LONGEST

    @cached_property
    def n(self) -> int:
        return int(self.curve.n)

    @cached_property
    def angle_periods(self) -> Array:
        periods = np.zeros(self.curve.size - 1)
        periods[: self.n] = self.state_periods
        return periods

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return np.asarray(self.curve.identifying)

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.asarray(self.curve.growing)

    @abstractmethod
    def of_type(self, type_: str, p: Array) -> CurveOfPoints:
        """The curve of another type in the same two parameters, the others being those of p."""


def scalar_columns(locus: str, scalar: Array) -> dict[str, Array]:
    """Of Hopf curves kappa = omega^2, of tori cos(theta), and where the pair is real; of others nothing."""
    if locus == "HB":
        return {"kappa": scalar.copy(), "neutral": np.asarray(scalar < 0.0)}
    if locus == "NS":
        return {"cos.theta": scalar.copy(), "neutral": np.asarray(np.abs(scalar) > 1.0)}
    return {}
