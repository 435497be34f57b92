"""Curves of orbits by shooting: metric, linearisation, columns."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.loci.shooting.curve import CurveByShooting, Equations
from contin.problems.orbits.marched_in_python import MarchedInPython
from contin.problems.orbits.measured.columns import names_of
from contin.problems.orbits.two_parameters import OfPeriodicOrbits
from contin.problems.shooting.extremes import measures
from contin.problems.shooting.linear import BorderedShooting
from contin.problems.shooting.shot_orbits import FINER


@dataclass(frozen=True, eq=False)
class ShotCurveEquations(MarchedInPython, OfPeriodicOrbits):
    """See `contin.loci.shooting.curve` for the unknowns and equations.

    Cost of a Newton step: the orbit's trajectories three times (LPC, PD), five times (NS, BPC) or once (touching
    orbits, one period), each with n + 2 variations, and a dense solve of size M n + 3 (NS, BPC: M n + 5).
    """

    curve: CurveByShooting
    maximum_chunk = 10

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> BorderedShooting | None:
        found = self.linearised(z, tangent, scale)
        return None if found is None else BorderedShooting(*found[0])

    def linearised(
        self, z: Array, tangent: Array, scale: Array
    ) -> tuple[tuple[Array, Array, NDArray[np.intp], int], Equations] | None:
        """What makes a `BorderedShooting`, and the equations that it is of."""
        found = self.curve.linearise(z, scale)
        if found is None or not np.all(np.isfinite(found.jacobian)):
            return None
        where = self.curve.unknowns(z)
        return (found.residual, np.vstack([found.jacobian, tangent[where]]), where, z.size), found

    def precise(self, accuracy: float) -> Self:
        """The same curve with trajectories of another accuracy."""
        return replace(self, curve=self.curve.precise(accuracy))

    def refined(self, sample: Sample, frame: Frame) -> tuple[Self, Sample, Frame] | None:
        finer = self.precise(FINER * self.curve.orbits.accuracy)
        found = finer.probe(sample, 0.0, sample.z.copy(), frame, Settings())
        return None if found is None else (finer, found, frame)

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, period, and smallest and largest value over the orbit of every state and observable."""
        curve = self.curve
        columns = self.parameter_columns(z)
        columns["period"] = z[:, curve.orbits.count * curve.orbits.n].copy()
        both = [measures(curve.as_they_are(row), curve.orbit(row)[None])[:2] for row in z]
        for k, name in enumerate(names_of(self.system)):
            columns[f"{name}.min"] = np.array([low[0, k] for low, _ in both])
            columns[f"{name}.max"] = np.array([high[0, k] for _, high in both])
        return columns
