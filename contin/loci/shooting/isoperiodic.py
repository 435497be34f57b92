"""Orbits of one period in two parameters by shooting: the shooting equations with T fixed.

z is that of `CurveByShooting`; T is carried along, not solved for. See `contin.loci.orbits.isoperiodic`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.shooting.curve import CurveByShooting, Equations
from contin.loci.shooting.expansion import Expansion
from contin.loci.shooting.shot_curves import OfShotOrbits
from contin.problems.orbits.two_parameters import OfOnePeriod
from contin.problems.shooting.shot_orbits import ShootingProblem


@dataclass(frozen=True, eq=False)
class ShotPeriodCurve(CurveByShooting):
    """The equations of the orbits, less the unknown period."""

    orbits: ShootingProblem
    second: int
    gauge: None = None

    type = "UZ"
    movable = True
    touched = None

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, q, p) in z."""
        return np.append(np.arange(self._states), [z.size - 2, z.size - 1])

    def settled(self, z: Array, scale: Array) -> Self:
        """The section is part of z."""
        return self

    def linearise(self, z: Array, scale: Array) -> Equations | None:
        at = Expansion.of(self.at(z), self.second, self.orbit(z), self.orbit(scale), float(scale[-2]))
        return None if at is None else Equations(at.residual, np.delete(at.jacobian, at.rows - 1, axis=1))

    def precise(self, accuracy: float) -> Self:
        return replace(self, orbits=self.orbits.precise(accuracy))

    def shifted(self, fraction: float) -> Self:
        """Nothing depends on the phase."""
        return self


@dataclass(frozen=True, eq=False)
class ShotPeriodProblem(OfOnePeriod, OfShotOrbits):
    """See `ShotPeriodCurve`."""

    curve: ShotPeriodCurve
