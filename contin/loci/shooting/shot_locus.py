"""Curves of LPC, PD, NS and BPC of orbits found by shooting, as a continuation problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.outcome import Failure, Outcome, Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.kernels.tests_of_stability import map_tests
from contin.loci.neutral import with_told_crossings
from contin.loci.orbits import criticality, events
from contin.loci.orbits.curve_of_orbits import ANGLES
from contin.loci.orbits.special_orbits import OfSpecialOrbits
from contin.loci.shooting.curve import ShootingCurve
from contin.loci.shooting.grazing import GrazingCurve
from contin.loci.shooting.sensitivity import error_of_equations
from contin.loci.shooting.shot_curves import OfShotOrbits
from contin.loci.tolerances import ONE_CORRECTION
from contin.machine import elementary
from contin.problems.orbits.linearised.multipliers import nontrivial
from contin.problems.shooting.codimension_two import has_coefficients, with_coefficients
from contin.problems.shooting.events import COARSE, FINE
from contin.problems.shooting.linear import BorderedShooting
from contin.special.table import tests_of_orbits
from contin.systems.accuracy import accuracy_of_equations


@dataclass(frozen=True, eq=False)
class LinearisedLocus(BorderedShooting):
    """With the second derivative that says whether a fold is degenerate, and those of the branching equation."""

    problem: ShotLocusProblem | None = None
    bend: float = np.nan
    form: Array | None = None

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """See `contin.continuation.march.Telling`."""
        assert self.problem is not None
        return self.problem.stability_with(z, self.bend)


@dataclass(frozen=True, eq=False)
class ShotLocusProblem(OfShotOrbits, OfSpecialOrbits):
    """`curve` is a `ShootingCurve`, or one of touching orbits."""

    halved: ClassVar[tuple[str, ...]] = ("NS", "LPC")  # by collocation the march looks for the step to GPD itself

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Without the test of a fold's coefficient, which a linearisation has."""
        return self.stability_with(z, np.nan)

    def stability_with(self, z: Array, bend: float) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests as `contin.loci.orbits.events` names them; the multipliers that are not critical decide."""
        values, four = self.multipliers(z), np.ones(4)
        touching = self.curve.touched is not None  # no multiplier is critical, on either side of the touched surface
        others = nontrivial(self.curve.orbits, values) if touching else self.others(values, z)
        unstable = int(map_tests(np.ascontiguousarray(others.real), np.ascontiguousarray(others.imag), four))
        if touching:
            return np.full(len(tests_of_orbits(self.locus)), np.nan), unstable, values
        tests = [four[2] if others.size > 1 else 1.0, four[3], ones(others)]
        if self.locus == "LPC":
            tests.append(bend)
        elif self.locus == "PD":
            tests.append(np.nan)
        elif self.locus == "NS":
            k = self.curve.further(z)
            tests += [k - 1.0, k + 1.0, k + 0.5, k, np.nan]
        return np.array(tests), unstable, values

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> LinearisedLocus | None:
        found = self.linearised(z, tangent, scale)
        if found is None:
            return None
        return LinearisedLocus(*found[0], problem=self, bend=found[1].bend, form=found[1].form)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        return with_told_crossings(self.locus, criticality.cut_at_change(self.curve, chunk, frame.scale))

    def measured_beside(self, type_: str, sample: Sample, frame: Frame) -> Sample:
        return criticality.beside_pole(self.curve, type_, sample, frame.scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        found = super().probe(base, length, guess, frame, settings)
        if found is None:
            offset = (guess - base.z) / frame.scale
            nearer = corrector.correct(self, base.z, base.tangent, length, offset, frame.scale, ONE_CORRECTION)
            if isinstance(nearer, Failure):
                return None
            found = super().probe(base, length, nearer.z, frame, settings)
        if found is None or not criticality.is_measured(self.curve, base):
            return found
        return criticality.measured(self.curve, found, frame.scale)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        return self.connected(origin, before, frame) or super().renew(origin, before, loop, frame, settings)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return _verified(self, type_, near, frame)

    def on_finer_mesh(self, sample: Sample, frame: Frame) -> None:
        return None

    def with_coefficients(self, point: Verified, frame: Frame, finer: Any, there: Sample, metric: Frame) -> Verified:
        """By differences of the return map, on curves of LPC, PD and NS."""
        if self.locus == "BPC" or self.curve.touched is not None or not has_coefficients(point.type):
            return point
        orbits, orbit = self.curve.at(point.z), self.curve.orbit(point.z)
        sizes = orbits.sizes(orbit, self.curve.orbit(frame.scale))
        theta = ANGLES.get(point.type, 0.0)
        if point.type == "CH":
            theta = float(elementary.acos(np.clip(self.curve.further(point.z), -1.0, 1.0)))
        return with_coefficients(point, theta, orbits, orbit, sizes)

    def error_of_equations(self, z: Array, scale: Array) -> float:
        return error_of_equations(self.curve, z, scale) if isinstance(self.curve, ShootingCurve) else 0.0

    def column(self, name: str, z: Array) -> Array:
        return (self.columns(z) if name == "turns" else self._plain_columns(z))[name]

    def columns(self, z: Array) -> dict[str, Array]:
        """... and of touching orbits, where a family turns back at them."""
        columns = self._plain_columns(z)
        if isinstance(self.curve, GrazingCurve) and len(z):
            scale = self.initial_scale(z[0], self.first_bounds)
            columns["turns"] = np.array([self.curve.settled(row, scale).turns(row, scale) for row in z])
        return columns

    def _plain_columns(self, z: Array) -> dict[str, Array]:
        """Those that need no trajectories beside the orbits."""
        return super().columns(z) | self.angle_columns(z)

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        touched = self.curve.touched
        if touched is None:
            return super().remarks(z, eigenvalues)
        surface = self.system.pieces.name(touched)
        return (f"the orbits touch {surface}: nonsmooth folds where `turns` is true; other events are not looked for",)

    def shortcomings(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """None of touching orbits, which have no critical multiplier and no coefficient."""
        return () if self.curve.touched is not None else super().shortcomings(z, eigenvalues)


def ones(values: NDArray[np.complex128]) -> float:
    """Sign of the product of all (1 - multiplier), size of the smallest factor relative to 1 + |multiplier|."""
    if not values.size:
        return 1.0
    below = np.count_nonzero((values.imag == 0.0) & (values.real > 1.0))
    return float((-1.0) ** below * np.min(np.abs(values - 1.0) / (1.0 + np.abs(values))))


def _verified(problem: ShotLocusProblem, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The zero of a test function along the curve, and how much it depends on the accuracy of the trajectories."""
    found = events.verify(problem.precise(FINE), type_, near, frame)
    if not isinstance(found, Verified):
        return found
    coarse = max(COARSE, accuracy_of_equations(problem.curve.orbits.system))
    rough = events.located(problem.precise(coarse), type_, near, frame)
    apart = 0.0
    if isinstance(rough, tuple):
        apart = float(np.max(np.abs(rough[0].z[-2:] - found.z[-2:]) / frame.scale[-2:]))
    return replace(found, error=found.error + apart * float(frame.scale[-1]))
