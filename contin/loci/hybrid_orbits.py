"""Curves in two parameters of folds, branch points, period doublings and tori of periodic orbits with jumps.

They are curves of such points of the map's fixed points (`contin.loci.equilibria`); every orbit on them is looked at
for events that its cycle does not have, and the curve ends where the cycle changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.loci.equilibria.march import place
from contin.problems.hybrid.closing import is_shut, shut
from contin.problems.hybrid.grazing import curve_ending, cut_where_events_change, unexpected_on_curve
from contin.problems.hybrid.hybrid_orbits import OF_MAPS, OF_ORBITS, HybridOrbits, judged, renamed, solved_twice
from contin.problems.hybrid.sampling import HybridProfile, orbit_columns
from contin.problems.two_parameters import TwoParameterProblem

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

OF_CURVES: Final = OF_ORBITS | {"CP": "CPC"}  # points on curves of fixed points, and what they are of orbits
OF_POINTS: Final = OF_MAPS | {"CPC": "CP"}
OWN: Final = ("cos.theta", "neutral", "unfolding")  # columns of the curve of fixed points that are told


@dataclass(frozen=True, eq=False)
class HybridLocus(TwoParameterProblem):
    """`fixed` is the curve of fixed points, whose equations are `curve`; `orbits` gives the orbits on it."""

    orbits: HybridOrbits
    fixed: LocusProblem

    maximum_chunk = 10

    @property
    def locus(self) -> str:
        return OF_ORBITS.get(self.fixed.locus, self.fixed.locus)

    @property
    def system(self) -> CompiledSystem:
        """The flow without its events."""
        return self.orbits.system

    @property
    def angle_periods(self) -> Array:
        return self.fixed.angle_periods

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return self.fixed.identifying

    @property
    def growing(self) -> NDArray[np.bool_]:
        return self.fixed.growing

    @property
    def has_stability(self) -> bool:
        return True

    def within(self, first: tuple[float, float], second: tuple[float, float]) -> Self:
        return replace(self, fixed=self.fixed.within(first, second), first_bounds=first, second_bounds=second)

    # the orbit of a point ---------------------------------------------------------------------------------------------

    def at(self, z: Array) -> tuple[HybridOrbits, Array]:
        """The family through a point in the first parameter, and the point as one of it."""
        base = self.fixed.base.copy()
        base[self.curve.second] = z[-2]
        inner = replace(self.orbits.inner, base=base, active=self.curve.first)
        return replace(self.orbits, inner=inner), np.append(z[: self.fixed.n], z[-1])

    def profile(self, z: Array) -> HybridProfile:
        """The orbit over one period."""
        family, orbit = self.at(z)
        return family.profile(orbit)

    def orbit_at(self, z: Array) -> HybridProfile:
        return self.profile(z)

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        family, orbit = self.at(z)
        return family.multipliers(orbit)

    def unexpected(self, z: Array) -> tuple[int, int] | None:
        """(event, arc) of the first event on the orbit that its cycle does not have."""
        family, orbit = self.at(z)
        return unexpected_on_curve(family, orbit, *self.curve.linearise(z))

    def is_shut(self, z: Array) -> bool:
        """See `contin.problems.hybrid.closing`."""
        return is_shut(*self.at(z))

    def shut(self, z: Array) -> Array:
        """See `contin.problems.hybrid.closing`."""
        family, orbit = self.at(z)
        closed = shut(family, orbit)
        return z if closed is orbit else np.append(closed[:-1], z[self.fixed.n :])

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        return self.fixed.initial_scale(z, bounds)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        return self.fixed.tangents(z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = self.fixed.march(origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_where_events_change(self, chunk, frame, settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return self.fixed.probe(base, length, guess, frame, settings)

    def placed(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Array | None:
        """The point of `probe`, without its tests."""
        return place(self.fixed.near(base.z, frame), base, length, guess, frame, settings)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame] | None:
        """On more accurate trajectories."""
        system = self.orbits.map.finer()
        orbits = replace(self.orbits, inner=replace(self.orbits.inner, system=system))
        finer = replace(self, orbits=orbits, fixed=replace(self.fixed, curve=replace(self.curve, system=system)))
        found = solved_twice(finer, sample, frame)
        return None if found is None else (finer, found, frame)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        return self.fixed.at_unknown(index, guess, value, scale)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        last = None if before is None else before.z[[-1, -2]]
        then = None if before is None else self.at(before.z)
        end = curve_ending(self.at(origin.z), then, self.parameters, origin.z[[-1, -2]], last)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    # special points ---------------------------------------------------------------------------------------------------

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        found = self.fixed.explain(a, b)
        return None if found is None else tuple(OF_CURVES.get(type_, type_) for type_ in found)

    def test_of(self, type_: str) -> int | None:
        return self.fixed.test_of(OF_POINTS.get(type_, type_))

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return self._of_orbit(self.fixed.verify(OF_POINTS.get(type_, type_), near, frame), frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return [self._of_orbit(item, frame) for item in self.fixed.verify_compound(a, b, frame)]

    def _of_orbit(self, found: Outcome, frame: Frame) -> Outcome:
        if not isinstance(found, Verified):
            return found
        here = Sample(found.z, np.zeros_like(found.z), np.empty(0), found.unstable, found.eigenvalues)
        again = replace(self.fixed, curve=replace(self.curve, system=self.orbits.map.rougher()))
        found = judged(found, again.verify(found.type, here, frame))
        type_ = OF_CURVES.get(found.type, found.type)
        form = renamed(dict(found.normal_form))
        return replace(found, type=type_, eigenvalues=self.multipliers(found.z), normal_form=form)

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return self.fixed.reverses(z, tangent, scale, symmetries)

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        return self.fixed.remarks(z, eigenvalues)

    # words and columns ------------------------------------------------------------------------------------------------

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, period, and smallest and largest value over the orbit of every state and observable."""
        columns = self.parameter_columns(z) | orbit_columns(self.system, [self.at(row) for row in z])
        own = self.fixed.columns(z)
        return columns | {name: own[name] for name in OWN if name in own}

    def describe_failure(self, z: Array) -> str:
        family, orbit = self.at(z)
        return family.describe_failure(orbit)
