"""Families of periodic orbits by shooting, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as generic
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.problem import (
    NOTHING,
    Chunk,
    Failure,
    Frame,
    Jump,
    Outcome,
    Rejected,
    Renewal,
    Sample,
    Verified,
)
from contin.continuation.settings import Settings
from contin.kernels.tests_of_stability import map_tests
from contin.model.evaluate import evaluate
from contin.problems.neutral_pairs import is_suspect, paired, remarks_on_orbits
from contin.problems.orbits.ends.ends import foretold
from contin.problems.orbits.family import FamilyOfOrbits
from contin.problems.orbits.measured.columns import names_of
from contin.problems.orbits.measured.measures import Measures, standard_columns
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import state_sizes
from contin.problems.orbits.special_orbits.events import explain
from contin.problems.shooting.corners import at_corner, cross_corner, verify_corner
from contin.problems.shooting.eigenfunctions import eigenfunctions
from contin.problems.shooting.equilibrium_on_surface import has_shrunk
from contin.problems.shooting.events import verify, verify_compound
from contin.problems.shooting.fixed_space import FixedSpace, fixed_space
from contin.problems.shooting.halving import drives_halves_apart
from contin.problems.shooting.layout import Nodes, make_scale, sizes_of
from contin.problems.shooting.linear import BorderedShooting, family_tangents
from contin.problems.shooting.renewal import cut_where_oblique, renew
from contin.problems.shooting.sampling import measured, measures, sampled, why_not
from contin.problems.shooting.segments import Segments
from contin.problems.shooting.signature import signature
from contin.symbolic.calculus.derivatives import derivative

ACCURACY = 1e-11  # relative tolerance of the trajectories along a branch
PERIOD_SCALE = 2.0  # the period counts in the metric relative to this multiple of itself
BUDGET = 200_000  # steps of one segment
PROBE_TOLERANCE = 1e-10
RESOLUTION = 1e-6  # distance from a connecting orbit at which a curve of orbits is taken to have come to it
PAIRED = 1e-10  # two multipliers are m and 1/m to this: the flow keeps an area, and |m| = 1 is no rounding error


@dataclass(frozen=True, eq=False)
class ShootingProblem(FamilyOfOrbits):
    """phi_T(u, p) = u + winding in M segments, with a phase; z as in `contin.problems.shooting.layout`.

    count : segments M.  multiple : forcing periods in one orbit.  accuracy : relative tolerance of the trajectories;
    `budget` : most steps of one segment.  held : by number of the segment, the flow with some surfaces held there.
    fixed : fixed space of the symmetries that keep every point of the orbits; None where they are free to leave it.

    Cost of a Newton step: M trajectories with n + 1 variations, and a dense solve of size M n + 2.
    """

    multiplied_out = True

    count: int = 1
    multiple: int = 1
    accuracy: float = ACCURACY
    budget: int = BUDGET
    held: Mapping[int, Any] = field(default_factory=dict)
    fixed: FixedSpace | None = None
    measures: Measures | None = None  # columns that are asked for beside those of every family

    maximum_chunk = 20

    @cached_property
    def angle_periods(self) -> Array:
        """Of the unknowns z without the last, (N - 1,)."""
        states = np.asarray(self.system.model.periods(self.constants()), dtype=float)
        return np.concatenate([np.tile(states, self.count), np.zeros(self.n + 2)])

    def precise(self, accuracy: float) -> ShootingProblem:
        """The same orbits with trajectories of another accuracy."""
        return replace(self, accuracy=accuracy)

    def free(self) -> ShootingProblem:
        """The same orbits, and those beside them that break their symmetries."""
        return self if self.fixed is None else replace(self, fixed=None)

    def restricted(self, z: Array) -> ShootingProblem:
        """Orbits with the symmetries that keep every node of z."""
        nodes = Nodes.of(z, self.n)
        return replace(self, fixed=fixed_space(self, nodes.u, self.full_parameters(z)))

    def at_base(self, base: Array) -> ShootingProblem:
        """The same orbits with other parameter values."""
        return replace(self, base=base)

    def forcing_period(self, parameter: float) -> tuple[float, float]:
        """Period of the orbit of a forced system, and its derivative by the active parameter."""
        formula = self.system.forcing_period
        values = self.constants() | {self.parameters[0]: float(parameter)}
        slope = derivative(formula, self.parameters[0])
        return self.multiple * float(evaluate(formula, values)), self.multiple * float(evaluate(slope, values))

    def sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric."""
        return sizes_of(scale, self.n)

    def period_place(self, z: Array) -> int:
        return len(z) - self.n - 3

    @property
    def resolution(self) -> float:
        """Nearer to a connecting orbit there is little more to see than its period, which grows without bound."""
        return RESOLUTION

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The connecting orbit that the family was near when its corrector failed."""
        found = None if before is None or not self.autonomous else foretold(self, origin, before, frame)
        return None if found is None else Renewal(frame.scale, origin, before, None, found.end, None, found.point)

    def profile(self, z: Array) -> Profile:
        """The orbit sampled over one period."""
        return sampled(self, z)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        nodes = Nodes.of(z, self.n)
        sizes = self.state_sizes(self.profile(z))
        return make_scale(sizes, nodes.count, PERIOD_SCALE * nodes.period, self.width(z, bounds))

    def state_sizes(self, profile: Profile) -> Array:
        """Typical size of every state on an orbit, (n,)."""
        return state_sizes(self, profile)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Any:
        """The bordered equations, None where a trajectory does not come to its end."""
        segments = self.segments(z)
        return None if segments is None else BorderedShooting.of(segments, tangent, scale)

    def segments(self, z: Array) -> Segments | None:
        """The trajectories of z's segments; the last ones are kept, for they are asked for twice."""
        kept = self._kept
        if kept and np.array_equal(kept[0][0], z):
            return kept[0][1]
        found = Segments.of(self, z)
        kept[:] = [(z.copy(), found)]
        return found

    @cached_property
    def _kept(self) -> list[tuple[Array, Segments | None]]:
        return []

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """(pairs, flips), multipliers outside the unit circle, multipliers (the trivial one first)."""
        values = self.multipliers(z)
        others = values[1:] if self.autonomous else values
        if is_suspect(others, True):
            others = paired(others, np.full(len(others), PAIRED), True)
        tests = np.ones(4)
        unstable = map_tests(np.ascontiguousarray(others.real), np.ascontiguousarray(others.imag), tests)
        return tests[2:], int(unstable), values

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""
        segments = self.segments(z)
        if segments is None:
            return np.full(self.n, np.nan, complex)
        return segments.multipliers()

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
        return cut_where_oblique(self, chunk, frame.scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        tight = replace(settings, tolerance=min(settings.tolerance, PROBE_TOLERANCE))
        return generic.probe(self, base, length, guess, frame, tight)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(len(scale))
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        found = generic.correct(self, z0, fixed, 0.0, np.zeros(len(scale)), scale, 1e-11)
        if isinstance(found, Failure):
            return None
        z = found.z.copy()
        z[-1] = value
        return z

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
