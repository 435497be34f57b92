"""Orbits of one period in two parameters: u' = T f(u, p, q), u(1) = u(0) + winding, a phase condition, T fixed.

With a long period this is a quick look at a curve of homoclinic orbits, from which it differs by terms of the order of
exp(-T rate), without projections or a saddle. z = (u at the nodes, T, h_1 .. h_N, q, p); T and the mesh are carried
along, not solved for. Cost: a sparse factorisation a Newton step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import Frame, Renewal, Sample, Verified
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.orbits.homoclinic.linear import Factorised, factorised
from contin.problems.orbits.linear import OrbitLinear
from contin.problems.orbits.loci.renewal import renew
from contin.problems.orbits.marched_in_python import MarchedInPython
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.orbits.two_parameters import CurveOfPeriodicOrbits, OfPeriodicOrbits

ALIKE = 1e-7  # relative distance of parameters below which two points are one


@dataclass(frozen=True, eq=False)
class PeriodCurve(CurveOfPeriodicOrbits):
    """The equations of the orbits, less the one for the period."""

    orbits: OrbitProblem
    second: int
    memory: dict[str, Array] = field(default_factory=dict)  # the orbit that the phase condition refers to

    type = "UZ"

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, q, p) in z."""
        return np.append(np.arange(self.profile(z).u.size), [z.size - 2, z.size - 1])

    def settle(self, z: Array, scale: Array) -> None:
        """The orbit that the phase condition refers to."""
        self.memory["phase"] = z.copy()

    def linearise(self, z: Array, scale: Array) -> tuple[Array, Any]:
        """Scaled equations (k,) and their sparse Jacobian (k, k + 1) by `unknowns`."""
        from scipy import sparse

        known = self.memory.get("phase", z)
        reference = known if known.size == z.size else z
        orbits, orbit = self.at(z), self.orbit(z)
        own = OrbitLinear(orbits, orbit, self.orbit(scale), self.orbit(reference))
        across = orbits.with_active(self.system.parameter_names[self.second], orbit)
        other = OrbitLinear(across, z[:-1], scale[:-1], reference[:-1])
        by_first, by_second = own.jacobian.tocsc(), other.jacobian.tocsc()
        columns = [by_first[:, : own.nu], by_second[:, -1:], by_first[:, -1:]]
        return own.residual, sparse.hstack(columns, format="csc")


@dataclass(frozen=True, eq=False)
class SamePeriodProblem(MarchedInPython, OfPeriodicOrbits):
    """See `PeriodCurve` for the unknowns and equations; no special points are looked for."""

    curve: PeriodCurve

    maximum_chunk = 10  # a step takes some 10 ms

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        return self.curve.join(self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first)), second)

    def settle(self, z: Array, scale: Array) -> None:
        self.curve.settle(z, scale)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Factorised | None:
        equations, jacobian = self.curve.linearise(z, scale)
        return factorised(equations, jacobian, self.curve.unknowns(z), tangent)

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

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        return renew(self, origin, before, frame, settings)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        return bool(np.all(np.abs(a.z[[-1, -2]] - b.z[[-1, -2]]) <= ALIKE * scale[[-1, -2]]))

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        raise InputError(f"{point.branch}.{point.label}: no other curves start from orbits of one period")
