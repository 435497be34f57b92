"""Orbits of one period in two parameters by shooting: the shooting equations with T fixed.

z is that of `CurveByShooting`; T is carried along, not solved for. See `contin.problems.orbits.same_period`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import Frame, Sample, Verified
from contin.errors import InputError
from contin.problems.shooting.loci.curve import CurveByShooting, Equations
from contin.problems.shooting.loci.expansion import Expansion
from contin.problems.shooting.loci.problem import ShotLocusProblem
from contin.problems.shooting.problem import ShootingProblem


@dataclass(frozen=True, eq=False)
class ShotPeriodCurve(CurveByShooting):
    """The equations of the orbits, less the unknown period."""

    orbits: ShootingProblem
    second: int

    type = "UZ"
    movable = True
    touched = None

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, q, p) in z."""
        return np.append(np.arange(self._states), [z.size - 2, z.size - 1])

    def settle(self, z: Array, scale: Array) -> None:
        """The section is part of z."""

    def linearise(self, z: Array, scale: Array) -> Equations | None:
        at = Expansion.of(self.at(z), self.second, self.orbit(z), self.orbit(scale), float(scale[-2]))
        return None if at is None else Equations(at.residual, np.delete(at.jacobian, at.rows - 1, axis=1))

    def precise(self, accuracy: float) -> ShotPeriodCurve:
        return replace(self, orbits=self.orbits.precise(accuracy))

    def bend(self) -> float:
        return float("nan")

    def shift(self, fraction: float) -> None:
        """Nothing depends on the phase."""


@dataclass(frozen=True, eq=False)
class ShotPeriodProblem(ShotLocusProblem):
    """See `ShotPeriodCurve`; no special points are looked for."""

    curve: ShotPeriodCurve

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """No tests; the number of unstable multipliers, and all of them."""
        values = self.multipliers(z)
        return np.empty(0), int(np.sum(np.abs(values[1:]) > 1.0)), values

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return ()

    def watch(self, type_: str) -> int | None:
        return None

    def verify(self, type_: str, near: Sample, frame: Frame) -> Verified | str:
        return ""

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Verified | str]:
        return ()

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        raise InputError(f"{point.branch}.{point.label}: no other curves start from orbits of one period")
