"""Families of periodic orbits by orthogonal collocation, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.abi import Array
from contin.continuation.outcome import Outcome
from contin.continuation.problem import Problem, Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.problems.moved_along import distances, remarks_on_frame
from contin.problems.neutral_pairs import remarks_on_orbits
from contin.problems.orbits.ends.ends import foretold
from contin.problems.orbits.ends.multiply_traversed import cut_where_traversed
from contin.problems.orbits.ends.vertical import recounted, remarks, stands_at_birth, width_at_birth
from contin.problems.orbits.linearised import lost_growth
from contin.problems.orbits.linearised.linear import branch_tangents
from contin.problems.orbits.march import in_kernel
from contin.problems.orbits.measured.columns import integrals, names_of, norms, orbit_columns, periods, with_observables
from contin.problems.orbits.measured.measures import standard_columns
from contin.problems.orbits.mesh import coarse
from contin.problems.orbits.mesh.adaption import unresolved
from contin.problems.orbits.mesh.finer import on_half_lengths
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.orbits.normal_forms.eigenfunctions import eigenfunctions
from contin.problems.orbits.orbit_equations import OrbitEquations
from contin.problems.orbits.renewal import renew
from contin.problems.orbits.special_orbits.events import explain, verify, verify_compound
from contin.problems.orbits.symmetric.shifted_in_time import apart, cut_at_start, in_phase
from contin.problems.orbits.symmetric.symmetry import orbits_moved, reverses
from contin.problems.tolerances import PROBE_TOLERANCE

PERIOD_SCALE = 2.0  # the period counts in the metric relative to this multiple of itself
EXACT = 1e-12  # tolerance where the parameter is fixed


@dataclass(frozen=True, eq=False)
class OrbitProblem(OrbitEquations):
    """The equations of `OrbitEquations`, followed by the compiled march."""

    @property
    def maximum_chunk(self) -> int:
        return in_kernel.LONGEST_CHUNK

    @cached_property
    def width_at_birth(self) -> float:
        """Scale of the parameter of a family that was born at a Hopf point."""
        return width_at_birth(self)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        profile, width = self.profile(z), self.width(z, bounds)
        return make_scale(profile.h, self.points, self.state_sizes(profile), PERIOD_SCALE * profile.period, width)

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """On the mesh that is asked for; for shooting where that is asked for, or the flow is piecewise smooth."""
        configured: Seed = lazy.module("discretisation").orbits_as_chosen(seed, settings)
        return configured

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        return branch_tangents(self, z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = in_kernel.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_at_start(self, cut_where_traversed(self, chunk), loop, frame.scale)

    def in_phase(self, start: Sample, near: Array, scale: Array) -> Sample:
        return in_phase(self, start, near, scale) if self.autonomous and start.z.size == near.size else start

    def apart(self, start: Array, near: Array, scale: Array) -> float:
        return apart(self, start, near, scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        if length == 0.0 and self.autonomous and self.is_constant(base.z, frame.scale):
            return None
        tolerance = min(settings.tolerance, PROBE_TOLERANCE)
        return in_kernel.probe(self, base.z, base.tangent, length, guess, frame, tolerance)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        found = on_half_lengths(self, sample, frame)
        return None if found is None else (self, *found)

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""
        return in_kernel.multipliers(self, z)

    def eigenfunctions(self, z: Array, multipliers: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """(k, times, n) at the times of `profile`."""
        return eigenfunctions(self, z, multipliers)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros_like(scale)
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        found = in_kernel.probe(self, z0, fixed, 0.0, z0, Frame(scale), EXACT)
        if found is None:
            return None
        found.z[-1] = value
        return found.z

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return explain(a, b, stands_at_birth(self, a.z) and stands_at_birth(self, b.z))

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return verify_compound(self, a, b, frame)

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        """True at an orbit at which the family meets its own image."""
        return any(reverses(self, z, tangent, name) for name in symmetries)

    def moved(self, name: str, z: Array) -> Array:
        """Images of rows z under a declared symmetry."""
        return orbits_moved(self, name, z)

    def columns(self, z: Array) -> dict[str, Array]:
        """Parameter, period, and smallest and largest value over the orbit of every state and observable."""

        def functions(u: Array, rows: Array) -> Array:
            p = np.tile(self.full_parameters(np.zeros(1)), (len(rows), 1))
            p[:, self.active] = rows[:, -1]
            return with_observables(self.system, u, p)

        columns = {self.parameters[0]: z[:, -1].copy(), "period": periods(z, self.profile)}
        columns |= orbit_columns(z, names_of(self.system), self.profile, functions)

        def integrated(k: int) -> Array:
            place = len(self.system.state_names) + k
            return integrals(z, self.profile, lambda u, rows: functions(u, rows)[:, :, place])

        columns |= distances(self.system, integrated)
        columns |= standard_columns(self.system, columns, lambda: norms(z, self.profile))
        if self.measures is not None:
            columns |= self.measures.columns([self.profile(row) for row in z], lambda k: self.full_parameters(z[k]))
        return columns

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        return renew(self, origin, before, loop, frame)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """A homoclinic orbit that the family was near when its corrector failed."""
        if before is None:
            return None
        found = foretold(self, origin, before, frame)
        return None if found is None else Renewal(frame.scale, origin, before, None, found.end, found.last, found.point)

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """That the family is vertical or neutral, its mesh too coarse (or growth lost), its frame without a phase."""
        framed = remarks_on_frame(self.system, self.profile(z[-1]).u)
        resolved = (coarse.remark(self, z), lost_growth.remark(self, z, eigenvalues))
        return (*remarks(self, z), *remarks_on_orbits(self, z, eigenvalues), *filter(None, resolved), *framed)

    def recounted(
        self, z: Array, unstable: NDArray[np.int64], eigenvalues: NDArray[np.complex128]
    ) -> NDArray[np.int64]:
        return recounted(self, z, unstable, eigenvalues)

    def describe_failure(self, z: Array) -> str:
        text = self.explain_states(z)
        if text:
            return text
        profile = self.profile(z)
        framed = remarks_on_frame(self.system, profile.u)
        if framed:
            return framed[0]
        why = "it is very stiff here (a canard?). Try settings.intervals, or start from a simulation beyond this point"
        return unresolved(profile, self.state_sizes(profile), self.tolerance, "orbit", f"{why}.") or (
            "Try a smaller settings.step or min_step, or a larger settings.tolerance; check that the equations are "
            "smooth here."
        )
