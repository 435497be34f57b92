"""What curves of orbits in two parameters (special periodic orbits, connecting orbits) answer alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.two_parameters import TwoParameterProblem


@dataclass(frozen=True, eq=False)
class OrbitCurveProblem(TwoParameterProblem):
    """Curves whose unknowns follow a mesh: their number changes, so masks over them name none but the last."""

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(1, bool)

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.zeros(2, bool)

    def reverses(self, z: Array, tangent: Array, symmetries: Sequence[str]) -> bool:
        return False

    def remarks(self, z: Array) -> Sequence[str]:
        return ()
