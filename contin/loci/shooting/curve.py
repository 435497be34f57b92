"""Curves of special orbits by shooting: unknowns and equations.

z = (u_1 .. u_M, T, normal, offset, [further unknown], q, p); the section (normal, offset) is carried along. The
further unknown of a curve of tori is cos(theta), which may leave [-1, 1]; that of a curve of branch points is an
unfolding: the orbit closes up to a multiple of a fixed jump, zero where a symmetry forces the branch points.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.shooting.conditions import Borders, borders, condition, matrix
from contin.loci.shooting.expansion import Expansion
from contin.machine import elementary
from contin.problems.orbits.two_parameters import CurveOfPeriodicOrbits
from contin.problems.shooting.normal_form import coefficient
from contin.problems.shooting.return_map import ReturnMap
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.records import Fields


@dataclass(frozen=True, eq=False)
class Equations:
    """Scaled residual (k,) and Jacobian (k, k + 1) by the unknowns that move; `bend`, `form`: see `Condition`."""

    residual: Array
    jacobian: Array
    bend: float = np.nan
    form: Array | None = None


class CurveByShooting(CurveOfPeriodicOrbits, ABC):
    """What all curves by shooting have in common."""

    type: str
    orbits: ShootingProblem
    critical: Fields  # see `contin.loci.orbits.criticality`

    def as_they_are(self, z: Array) -> ShootingProblem:
        """The orbits' problem at z, for what is read off their trajectories."""
        found: ShootingProblem = self.at(z)
        return found

    @property
    def _states(self) -> int:
        return self.orbits.count * self.orbits.n

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places in z of (u, T, [further], q, p)."""
        return np.append(np.arange(self._states + 1), np.arange(z.size - 2 - self.extra, z.size))

    def critical_coefficient(self, z: Array, scale: Array) -> tuple[float, float]:
        """c of PD or Re d of NS, and the size of the terms that it is made of; other curves have none."""
        return float("nan"), 1.0

    @abstractmethod
    def settled(self, z: Array, scale: Array) -> Self:
        """The same curve, its equations' auxiliary parts chosen for z, with the sense of those that it has."""

    @abstractmethod
    def linearise(self, z: Array, scale: Array) -> Equations | None:
        """None where a trajectory does not come to its end."""

    @property
    @abstractmethod
    def movable(self) -> bool:
        """True where the orbit's phase may be changed on the way."""

    @property
    @abstractmethod
    def touched(self) -> int | None:
        """Number of the surface that the orbits touch; None for special orbits of a smooth return map."""

    @abstractmethod
    def precise(self, accuracy: float) -> Self:
        """The same equations with trajectories of another accuracy."""

    @abstractmethod
    def shifted(self, fraction: float) -> Self:
        """The same curve where the orbit begins later by this part of its period."""


@dataclass(frozen=True, eq=False)
class ShootingCurve(CurveByShooting):
    """Equations of one type; `orbits` is the problem of the orbits themselves with the first parameter free."""

    type: str
    orbits: ShootingProblem
    second: int
    gauge: Borders | None = None
    critical: Fields = field(default_factory=dict)  # see `contin.loci.orbits.criticality`

    movable = True
    touched = None

    @property
    def extra(self) -> int:
        """Scalar unknowns beside the orbit."""
        return int(self.type in ("NS", "BPC"))

    def shifted(self, fraction: float) -> Self:
        """Borders are found anew when the next chunk begins."""
        return self

    def precise(self, accuracy: float) -> Self:
        return replace(self, orbits=self.orbits.precise(accuracy))

    def critical_coefficient(self, z: Array, scale: Array) -> tuple[float, float]:
        """c of PD or Re d of NS, and the size of the terms that it is made of."""
        orbits, orbit = self.at(z), self.orbit(z)
        theta = 0.0 if self.type == "PD" else float(elementary.acos(np.clip(self.further(z), -1.0, 1.0)))
        found = coefficient(ReturnMap(orbits, orbit, orbits.sizes(orbit, self.orbit(scale))), self.type, theta)
        return float(np.real(found.value)), found.size

    def expansion(self, z: Array, scale: Array) -> Expansion | None:
        return Expansion.of(self.at(z), self.second, self.orbit(z), self.orbit(scale), float(scale[-2]))

    def settled(self, z: Array, scale: Array) -> Self:
        """Borders that fit at z."""
        at = self.expansion(z, scale)
        a = None if at is None else matrix(self.type, at, self.further(z))
        if a is None or not np.all(np.isfinite(a)):  # those before may serve
            return self
        return replace(self, gauge=borders(self.type, a, self.orbits.n, self.gauge))

    def linearise(self, z: Array, scale: Array) -> Equations | None:
        known = self.gauge
        at = self.expansion(z, scale)
        special = None if at is None or known is None else condition(self.type, at, self.further(z), known)
        if at is None or special is None or known is None:
            return None
        residual, further = at.residual, np.zeros((at.rows, 0))
        if self.type == "BPC":
            residual = residual + self.further(z) * known.b[:, 0]
            further = known.b
        elif self.type == "NS":
            further = np.zeros((at.rows, 1))
        slopes, by_further = special.slopes, special.further[:, None][:, : self.extra]
        jacobian = np.block([
            [at.jacobian[:, : at.rows], further, at.jacobian[:, at.rows :]],
            [slopes[:, : at.rows], by_further, slopes[:, at.rows :]],
        ])  # fmt: skip
        return Equations(np.append(residual, special.values), jacobian, special.bend, special.form)
