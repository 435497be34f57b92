"""The march along a locus in plain Python: maps, large systems and user functions (`contin.continuation.march`)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation import march as python_march
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.loci.codim2.monitors import tests_at
from contin.loci.equilibria.bordered import BorderedCurve
from contin.problems.dense_march import DenseLinearisation, dense_linearisation

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints


@dataclass(frozen=True, eq=False)
class OfBranchPoints(DenseLinearisation):
    """With the second derivatives of the branching equation."""

    at: tuple[BorderedCurve, Array, Array] | None = None  # the curve, z, and its Jacobian there

    @cached_property
    def form(self) -> Array | None:
        """(2, 2), see `contin.loci.equilibria.bordered`."""
        return None if self.at is None else self.at[0].form(*self.at[1:])


@dataclass(frozen=True, eq=False)
class LocusMarch:
    """A `CurveOfPoints` as the Python march takes it."""

    problem: CurveOfPoints

    @property
    def angle_periods(self) -> Array:
        return np.asarray(self.problem.angle_periods)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> DenseLinearisation | None:
        f, jacobian = self.problem.curve.linearise(z)
        found = dense_linearisation(f, jacobian, tangent, scale)
        if found is None or self.problem.locus != "BP":
            return found
        at = cast(BorderedCurve, self.problem.curve), z, jacobian
        return OfBranchPoints(found.residual, found.factors, found.sign, found.log_determinant, found.met, at)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return tests_at(self.problem, z)


def march(
    problem: CurveOfPoints, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
    settings: Settings, loop: Sample | None,
) -> Chunk:  # fmt: skip
    """`Problem.march`; the borders were renewed at origin."""
    bounds = problem.walls[-1][1:]
    march = LocusMarch(problem)
    return python_march.march(
        march, origin, before, length, frame, step, limit, bounds, settings, loop, walled=problem,
        decisions=corrector.IN_TWO_PARAMETERS,
    )  # fmt: skip


def probe(
    problem: CurveOfPoints, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings
) -> Sample | None:
    """`Problem.probe`."""
    return python_march.probe(LocusMarch(problem), base, length, guess, frame, settings)


def place(
    problem: CurveOfPoints, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings
) -> Array | None:
    """The point of `probe`, without its tests."""
    found = python_march.place(LocusMarch(problem), base, length, guess, frame, settings)
    return None if found is None else found.z
