"""Families of periodic orbits by shooting, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as generic
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.outcome import NOTHING, Jump, Outcome, Rejected, Verified
from contin.continuation.problem import Problem, Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.moved_along import distances
from contin.problems.neutral_pairs import remarks_on_orbits
from contin.problems.orbits.ends.ends import foretold
from contin.problems.orbits.measured.columns import names_of
from contin.problems.orbits.measured.measures import standard_columns
from contin.problems.orbits.special_orbits.events import explain
from contin.problems.shooting.before_rest import cut_before_rest
from contin.problems.shooting.boundary_end import comes_to_boundary_equilibrium
from contin.problems.shooting.corners import at_corner, cross_corner, verify_corner
from contin.problems.shooting.eigenfunctions import eigenfunctions
from contin.problems.shooting.equilibrium_on_surface import has_shrunk
from contin.problems.shooting.events import verify, verify_compound
from contin.problems.shooting.extremes import measures
from contin.problems.shooting.grazing_end import comes_to_graze
from contin.problems.shooting.halving import drives_halves_apart
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.linear import family_tangents
from contin.problems.shooting.renewal import cut_where_oblique, renew
from contin.problems.shooting.sampling import measured, why_not
from contin.problems.shooting.shot_equations import ShotEquations
from contin.problems.shooting.signature import signature
from contin.problems.shooting.sliding_end import comes_to_slide
from contin.problems.tolerances import PROBE_TOLERANCE

PERIOD_SCALE = 2.0  # the period counts in the metric relative to this multiple of itself
FINER = 0.01  # times the tolerance of trajectories, to see what that makes of a solution


@dataclass(frozen=True, eq=False)
class ShootingProblem(ShotEquations):
    """The equations of `ShotEquations`, followed by the march in Python; cost of a Newton step as there."""

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """What the family was near when its corrector failed: a connecting orbit, a surface met or slid along."""
        end = comes_to_slide(self, origin) or comes_to_boundary_equilibrium(self, origin, frame)
        end = end or comes_to_graze(self, origin)
        if end is not None:
            return Renewal(frame.scale, origin, before, None, end)
        found = None if before is None or not self.autonomous else foretold(self, origin, before, frame)
        return None if found is None else Renewal(frame.scale, origin, before, None, found.end, None, found.point)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        nodes = Nodes.of(z, self.n)
        sizes = self.state_sizes(self.profile(z))
        return make_scale(sizes, nodes.count, PERIOD_SCALE * nodes.period, self.width(z, bounds))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """That the family is neutral."""
        return remarks_on_orbits(self, z, eigenvalues)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        return family_tangents(self, z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = generic.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)
        chunk = cut_before_rest(self, chunk, frame, settings)
        return cut_where_oblique(self, chunk, frame, settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        tight = replace(settings, tolerance=min(settings.tolerance, PROBE_TOLERANCE))
        return generic.probe(self, base, length, guess, frame, tight)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        finer = self.precise(FINER * self.accuracy)
        found = finer.probe(sample, 0.0, sample.z.copy(), frame, Settings())
        return None if found is None else (finer, found, frame)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        found = explain(a, b, by_count=False)
        if found and self.system.n_switches and signature(self, a.z) != signature(self, b.z):
            return None  # a change of formulas may be all that happens: it is told from the rest up close
        return found

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return HALF_PERIOD in symmetries and drives_halves_apart(self, z, tangent)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        if type_ == "LPC" and has_shrunk(self, near.z, frame.scale):
            return NOTHING  # through amplitude zero, to the same orbits half a turn later
        return self._beside_corner([verify(self, type_, near, frame)], near, frame)[0]

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return self._beside_corner(verify_compound(self, a, b, frame), a, frame)

    def _beside_corner(self, found: list[Outcome], near: Sample, frame: Frame) -> list[Outcome]:
        """What was found; next to a corner, a test that fails is nothing to report."""
        failed = self.system.n_switches and any(isinstance(item, Rejected) for item in found)
        if not failed or not at_corner(self, near.z, near.tangent, frame.scale):
            return found
        return [NOTHING if isinstance(item, Rejected) else item for item in found]

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
        return verify_corner(self, a, b, frame)

    def cross_corner(self, last: Sample, frame: Frame, settings: Settings) -> tuple[Sample, Verified | None] | None:
        return cross_corner(self, last, frame, settings)

    def eigenfunctions(self, z: Array, multipliers: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """(k, times, n) at the times of `profile`."""
        return eigenfunctions(self, z, multipliers)

    def columns(self, z: Array) -> dict[str, Array]:
        """Parameter, period, extremes of every state and observable over the orbit, and the standard columns."""
        columns: dict[str, Array] = {self.parameters[0]: z[:, -1].copy()}
        columns["period"] = z[:, -self.n - 3].copy()
        low, high, norms = measures(self, z)
        for k, name in enumerate(names_of(self.system)):
            columns[f"{name}.min"], columns[f"{name}.max"] = low[:, k], high[:, k]

        def integrals(k: int) -> Array:
            orbits = [measured(self, row) for row in z]
            p = [np.tile(self.full_parameters(row), (len(orbit.u), 1)) for row, orbit in zip(z, orbits, strict=True)]
            rates = [self.system.observables(o.u, q)[:, k] for o, q in zip(orbits, p, strict=True)]
            return np.array([o.period * float(o.weights @ rate) for o, rate in zip(orbits, rates, strict=True)])

        columns |= distances(self.system, integrals)
        columns |= standard_columns(self.system, columns, lambda: norms)
        if self.measures is not None:
            columns |= self.measures.columns([measured(self, row) for row in z], lambda k: self.full_parameters(z[k]))
        return columns

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        return renew(self, origin, before, loop, frame)

    def describe_failure(self, z: Array) -> str:
        return why_not(self, z)
