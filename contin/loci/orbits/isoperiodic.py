"""Orbits of one period in two parameters: u' = T f(u, p, q), u(1) = u(0) + winding, a phase condition, T fixed.

With a long period this is a quick look at a curve of homoclinic orbits, from which it differs by terms of the order of
exp(-T rate), without projections or a saddle. z = (u at the nodes, T, h_1 .. h_N, q, p); T and the mesh are carried
along, not solved for. Cost: a sparse factorisation a Newton step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.loci.orbits.renewal import on_half_lengths, renew
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.linearised.tangent_solver import Factorised, factorised
from contin.problems.orbits.marched_in_python import MarchedInPython
from contin.problems.orbits.two_parameters import CurveOfPeriodicOrbits, OfOnePeriod


@dataclass(frozen=True, eq=False)
class PeriodCurve(CurveOfPeriodicOrbits):
    """The equations of the orbits, less the one for the period."""

    orbits: OrbitProblem
    second: int
    gauge: Array | None = None  # z of the orbit that the phase condition refers to

    type = "UZ"

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, q, p) in z."""
        return np.append(np.arange(self.profile(z).u.size), [z.size - 2, z.size - 1])

    def settled(self, z: Array, scale: Array) -> Self:
        """With z as the orbit that the phase condition refers to."""
        return replace(self, gauge=z.copy())

    def linearise(self, z: Array, scale: Array) -> tuple[Array, Any]:
        """Scaled equations (k,) and their sparse Jacobian (k, k + 1) by `unknowns`."""
        from scipy import sparse

        reference = z if self.gauge is None or self.gauge.size != z.size else self.gauge
        orbits, orbit = self.at(z), self.orbit(z)
        own = OrbitLinear(orbits, orbit, self.orbit(scale), self.orbit(reference))
        across = orbits.with_active(self.system.parameter_names[self.second], orbit)
        other = OrbitLinear(across, z[:-1], scale[:-1], reference[:-1])
        by_first, by_second = own.jacobian.tocsc(), other.jacobian.tocsc()
        columns = [by_first[:, : own.nu], by_second[:, -1:], by_first[:, -1:]]
        return own.residual, sparse.hstack(columns, format="csc")


@dataclass(frozen=True, eq=False)
class SamePeriodProblem(OfOnePeriod, MarchedInPython):
    """See `PeriodCurve` for the unknowns and equations."""

    curve: PeriodCurve

    maximum_chunk = 10  # a step takes some 10 ms

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        return self.curve.join(self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first)), second)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Factorised | None:
        equations, jacobian = self.curve.linearise(z, scale)
        return factorised(equations, jacobian, self.curve.unknowns(z), tangent)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Self, Sample, Frame] | None:
        near, metric = on_half_lengths(self.curve, sample, frame)
        found = self.probe(near, 0.0, near.z.copy(), metric, Settings())
        return None if found is None else (self, found, metric)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        end = self.at_birth(origin, before, frame.scale)
        if end is not None:
            return Renewal(frame.scale, origin, before, None, end)
        return renew(self, origin, before, frame, settings)
