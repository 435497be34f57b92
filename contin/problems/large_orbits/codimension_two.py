"""Coefficients of points of codimension two of large orbits: those of the return map, as of small ones.

The map's matrix is made column by column, a round for each state, so that there are coefficients up to `MOST` states;
its higher derivatives are one round each. They are computed on two meshes, the point being located on each
(`of_return_maps` has the errors), and where derivatives of the equations are differences, with wider ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.linalg.vectors import norm
from contin.normalforms.jet import DerivativeJet, Jet
from contin.normalforms.result import NO_FORM
from contin.problems.large_orbits.cycle import LargeCycle
from contin.problems.large_orbits.normal_form import WIDER, UnresolvedShearError, drifts
from contin.problems.large_orbits.radau import A
from contin.problems.orbits.normal_forms.of_return_maps import MeasuredMap, coefficients_of
from contin.problems.orbits.normal_forms.return_map import ReturnMap
from contin.special.table import special_type
from contin.systems.functions.circles import RADIUS
from contin.systems.functions.tensors import contracted

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations
    from contin.systems.functions.function_system import FunctionSystem

MOST: Final = 500  # states up to which the return map's matrix is made
FEW: Final = 6  # states up to which all derivatives of order 2 and 3 at a point cost less than the forms that are asked
NOT_MANY: Final = f"they are computed up to {MOST} states"

Orbit = tuple["LargeOrbitEquations", Array]  # the family, and z of one of its orbits


def why_none(type_: str, family: LargeOrbitEquations) -> str | None:
    """Why points of this type have no coefficients; None where they have."""
    if not special_type(type_).powers:
        return "there are none"
    if family.source.mass is not None:
        return "they are not computed beside a mass matrix"
    return None if family.n <= MOST else NOT_MANY


def with_coefficients(point: Verified, theta: float, coarse: Orbit, fine: Orbit) -> Verified:
    """The point with coefficients and their errors, or the remark why they could not be computed.

    theta : the angle of the critical multiplier.
    """
    try:
        form = _form(point.type, theta, coarse, fine)
    except (*NO_FORM, UnresolvedShearError) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    return replace(point, normal_form=form)


@dataclass(frozen=True, eq=False)
class LargeFlow:
    """`AlongCycle` of a large orbit: its states have one size."""

    cycle: LargeCycle
    size: float
    _tensors: dict[tuple[str, int], list[Array] | None] = field(default_factory=dict)

    is_forced = False

    @property
    def field_at_start(self) -> Array:
        return np.asarray(self.cycle.velocity / self.size)

    def once_round(self, start: Array, right: Array | None) -> tuple[Array, Array]:
        forced = None if right is None else np.asarray(self.cycle.step * np.einsum("ik,jkn->jin", A, right))
        found = self.cycle.sweeps.along(start, forced)
        return found, found[-1, 2]

    @property
    def system(self) -> FunctionSystem:
        """With the differences that derivatives are taken by."""
        return self.cycle.problem.system if self.cycle.system is None else self.cycle.system

    def tensors(self, where: str, states: Array, order: int) -> list[Array] | None:
        """All derivatives of an order at each of the states (K, n), kept; None where forms are cheaper."""
        if self.cycle.problem.n > FEW or order not in (2, 3):
            return None
        if (where, order) not in self._tensors:
            p = self.cycle.problem.full_parameters(self.cycle.z)
            found = [self.system.tensor(u, p, order) for u in states]
            known = [one for one in found if one is not None]
            self._tensors[where, order] = known if len(known) == len(found) else None
        return self._tensors[where, order]

    def apply(self, *functions: Array) -> Array:
        orbit, scaled = self.cycle.orbit, [self.size * w for w in functions]
        known = self.tensors("along", orbit.U.reshape(-1, orbit.U.shape[2]), len(functions))
        if known is None:
            return np.asarray(self.cycle.apply(*scaled) / self.size)
        rows = zip(*(w.reshape(len(known), -1) for w in scaled), strict=True)
        found = np.array([contracted(T, d) for T, d in zip(known, rows, strict=True)])
        return np.asarray(found.reshape(scaled[0].shape) / self.size)

    def apply_at_start(self, *functions: Array) -> Array:
        start, scaled = self.cycle.orbit.beginnings[:1], [self.size * w for w in functions]
        known = self.tensors("start", start, len(functions))
        if known is not None:
            return np.array([contracted(known[0], d) for d in zip(*scaled, strict=True)]) / self.size
        p = np.tile(self.cycle.problem.full_parameters(self.cycle.z), (len(scaled[0]), 1))
        u, still = np.tile(start, (len(p), 1)), np.zeros(p.shape)
        return np.asarray(self.system.derivatives(u, p, *(np.hstack([w, still]) for w in scaled)) / self.size)


@dataclass(frozen=True, eq=False)
class MapOfLarge:
    """The return map of an orbit, and the multipliers' eigenfunctions.

    like : that of the orbit on another mesh, whose coordinates these are near to.
    """

    problem: LargeOrbitEquations
    z: Array
    size: float
    like: MapOfLarge | None = None
    _cycles: dict[complex, LargeCycle] = field(default_factory=dict)

    @cached_property
    def flow(self) -> LargeFlow:
        return LargeFlow(LargeCycle(self.problem, self.z, 1.0, np.zeros(self.problem.n)), self.size)

    @cached_property
    def returns(self) -> ReturnMap:
        return ReturnMap(self.flow, like=None if self.like is None else self.like.returns)

    @cached_property
    def jet(self) -> DerivativeJet:
        return self.returns.jet()

    def with_wider_stencils(self, system: FunctionSystem) -> DerivativeJet:
        """The jet with other differences; the matrix is as it is."""
        other = LargeFlow(replace(self.flow.cycle, system=system), self.size)
        return DerivativeJet(
            self.jet.A, ReturnMap(other, like=self.returns).derivative, kind="map", scale=self.jet.scale
        )  # fmt: skip

    def at(self, rho: complex) -> LargeCycle:
        """The cycle with the vector of the multiplier at rho."""
        if rho not in self._cycles:
            values, vectors = self.problem.multipliers(self.z, exactly=True)
            k = int(np.argmin(np.abs(values - rho)))
            self._cycles[rho] = LargeCycle.with_critical(self.problem, self.z, values[k], vectors[:, k])
        return self._cycles[rho]

    def length(self, rho: complex, drift: bool) -> float:
        """Of the eigenfunction across the cycle at the section, in that of a unit vector there."""
        real = abs(rho.imag) < np.finfo(float).eps * 8.0
        at = complex(float(np.sign(rho.real))) if real else rho
        cycle = self.at(at)
        if at == 1.0:
            v = replace(cycle, drifts=drift).across_fold()[0]
        else:
            v = cycle.normalised(cycle.equation(float(at.real) if real else at, "critical").null[0])
        return float(norm(self.returns.coordinates(v[-1, 2] / self.size)))


def _form(type_: str, theta: float, coarse: Orbit, fine: Orbit) -> dict[str, object]:
    U = coarse[0].profile(coarse[1]).U
    size = float(np.max(np.ptp(U.reshape(-1, U.shape[2]), axis=0)))
    first = MapOfLarge(*coarse, size)
    maps = first, MapOfLarge(*fine, size, first)

    def drift() -> bool:
        return drifts(maps[0].at(1.0 + 0.0j).shear, maps[1].at(1.0 + 0.0j).shear)

    def measured(each: MapOfLarge) -> MeasuredMap:
        period = each.flow.cycle.period
        return MeasuredMap(each.jet, period, lambda rho, _: each.length(rho, abs(rho - 1.0) < 1e-8 and drift()))

    wider = _wider(coarse[0].system)

    def rounded(_: Jet) -> Sequence[Jet]:
        return [] if wider is None else [first.with_wider_stencils(wider)]

    system = coarse[0].system
    circles = RADIUS if system.lines.analytic and system.model.written is None else 0.0
    return coefficients_of(type_, theta, (measured(maps[0]), measured(maps[1])), rounded, circles)


def _wider(system: FunctionSystem) -> FunctionSystem | None:
    """The system with wider differences for derivatives that are such; None where none are."""
    if system.lines.analytic or system.model.written is not None:
        return None
    made = copy(system)
    made.lines = replace(system.lines, wider=WIDER)
    return made
