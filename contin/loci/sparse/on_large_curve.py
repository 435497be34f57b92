"""A curve of special points of a large system, as what looks for points of codimension two takes it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.sparse.curve import CurveLinearisation, LargeCurve
from contin.problems.two_parameters import TwoParameterProblem


@dataclass(frozen=True, eq=False)
class OnLargeCurve(TwoParameterProblem):
    """See `LargeCurve`; `second_bounds` is the range of the second parameter, that of the first is the engine's."""

    curve: LargeCurve

    @property
    def n(self) -> int:
        return self.curve.n

    @property
    def maximum_chunk(self) -> int:
        return self.curve.origin.maximum_chunk

    @cached_property
    def angle_periods(self) -> Array:
        periods = np.zeros(self.curve.size - 1)
        periods[: self.n] = self.curve.origin.angle_periods
        return periods

    @cached_property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(self.curve.size, bool)

    @cached_property
    def growing(self) -> NDArray[np.bool_]:
        mask = np.ones(self.curve.size, bool)
        mask[-2:] = False
        return mask

    def residual(self, z: Array) -> Array:
        """The curve's equations (N - 1,), unscaled."""
        return self.curve.residual(z)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> CurveLinearisation | None:
        return self.curve.linearisation(z, tangent, scale)
