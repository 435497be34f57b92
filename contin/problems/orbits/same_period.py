"""Orbits of one period in two parameters: u' = T f(u, p, q), u(1) = u(0) + winding, a phase condition, T fixed.

With a long period this is a quick look at a curve of homoclinic orbits, from which it differs by terms of the order of
exp(-T rate), without projections or a saddle. z = (u at the nodes, T, h_1 .. h_N, q, p); T and the mesh are carried
along, not solved for. Cost: a sparse factorisation a Newton step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import Chunk, Frame, Renewal, Sample, Verified
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.orbits.columns import names_of, orbit_columns, periods, with_observables
from contin.problems.orbits.homoclinic.linear import Factorised, factorised
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.linear import OrbitLinear
from contin.problems.orbits.loci.renewal import renew
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.orbits.two_parameters import OrbitCurveProblem

ALIKE = 1e-7  # relative distance of parameters below which two points are one


@dataclass(frozen=True, eq=False)
class PeriodCurve:
    """The equations; `orbits` gives those of the orbits, with the first parameter free."""

    orbits: OrbitProblem
    second: int
    memory: dict[str, Array] = field(default_factory=dict)  # the orbit that the phase condition refers to

    type = "UZ"
    extra = 0  # scalar unknowns beside the orbit and the parameters

    @property
    def system(self) -> Any:
        return self.orbits.system

    @property
    def base(self) -> Array:
        return self.orbits.base

    @property
    def first(self) -> int:
        return self.orbits.active

    def join(self, orbit: Array, q: float, further: float = 0.0) -> Array:
        """z from an orbit's own vector (u, T, h, p)."""
        return np.concatenate([orbit[:-1], [q, orbit[-1]]])

    def orbit(self, z: Array) -> Array:
        return np.append(z[:-2], z[-1])

    def further(self, z: Array) -> float:
        return 0.0

    def at(self, z: Array) -> OrbitProblem:
        """The orbits' problem at the second parameter's value in z."""
        base = self.orbits.base.copy()
        base[self.second] = z[-2]
        return replace(self.orbits, base=base)

    def profile(self, z: Array) -> Profile:
        return self.orbits.profile(self.orbit(z))

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, q, p) in z."""
        return np.append(np.arange(self.profile(z).u.size), [z.size - 2, z.size - 1])

    def settle(self, z: Array, scale: Array) -> None:
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
class SamePeriodProblem(OrbitCurveProblem):
    """See `PeriodCurve` for the unknowns and equations; no special points are looked for."""

    curve: PeriodCurve

    maximum_chunk = 10  # a step takes some 10 ms

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        return self.curve.join(self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first)), second)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The curve's own tangent: the null vector of its equations."""
        self.curve.settle(z, scale)
        generator = np.random.default_rng(3)
        border = np.zeros(z.size)
        where = self.curve.unknowns(z)
        border[where] = generator.normal(size=where.size)
        for _ in range(2):
            here = self.linearisation(z, border / np.linalg.norm(border), scale)
            if here is None:
                raise InputError("the curve cannot be followed from here: its equations are singular")
            border = here.solve(np.append(np.zeros(z.size - 1), 1.0))
        return [border / np.linalg.norm(border)]

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Factorised | None:
        """For the march in Python."""
        equations, jacobian = self.curve.linearise(z, scale)
        return factorised(equations, jacobian, self.curve.unknowns(z), tangent)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """No tests; the number of unstable multipliers, and all of them."""
        values = self.multipliers(z)
        return np.empty(0), int(np.sum(np.abs(values[1:]) > 1.0)), values

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        return self.curve.at(z).multipliers(self.curve.orbit(z))

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        self.curve.settle(origin.z, frame.scale)
        limit = min(limit, self.maximum_chunk)
        return python_march.march(self, origin, before, length, frame, step, limit, bounds, settings, None)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self, base, length, guess, frame, settings)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(guess.size)
        fixed[index] = 1.0
        z0 = guess.copy()
        z0[index] = value
        found = python_march.correct(self, z0, fixed, 0.0, np.zeros(guess.size), scale, 1e-11)
        if isinstance(found, str):
            return None
        z = found.z.copy()
        z[index] = value
        return z

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

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, the period, and smallest and largest value over the orbit of every state and observable."""
        curve = self.curve

        def functions(u: Array, rows: Array) -> Array:
            p = np.tile(curve.at(rows[0]).full_parameters(rows[0]), (len(rows), 1))
            p[:, curve.first], p[:, curve.second] = rows[:, -1], rows[:, -2]
            return with_observables(self.system, u, p)

        columns = self.parameter_columns(z) | {"period": periods(z, curve.profile)}
        return columns | orbit_columns(z, names_of(self.system), curve.profile, functions)

    def describe_failure(self, z: Array) -> str:
        return self.curve.at(z).describe_failure(self.curve.orbit(z))

    def switch(self, point: SpecialPoint, parameter: str) -> list[Seed]:
        """The family of orbits through the point, in one parameter."""
        orbits, orbit = self.curve.at(point.z), self.curve.orbit(point.z)
        if parameter != self.parameters[0]:
            orbits = orbits.with_active(parameter, orbit)
            orbit = np.append(orbit[:-1], orbits.base[orbits.active])
        return [Seed(orbits, orbit)]

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        raise InputError(f"{point.branch}.{point.label}: no other curves start from orbits of one period")
