"""Curves of LPC, PD and NS of periodic orbits in two parameters, as a continuation problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin import lazy
from contin.abi import Array
from contin.continuation.march import until_dip
from contin.continuation.outcome import Failure, Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.loci.neutral import with_told_crossings
from contin.loci.orbits import criticality
from contin.loci.orbits.curve_of_orbits import ANGLES
from contin.loci.orbits.renewal import on_finer_mesh, renew
from contin.loci.orbits.special_orbits import OfSpecialOrbits
from contin.loci.tolerances import ONE_CORRECTION
from contin.machine import elementary
from contin.problems.orbits.hopf_end import cut_at_birth
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.normal_forms.codimension_two import has_coefficients, with_coefficients
from contin.problems.orbits.special_orbits.curve import OrbitCurve
from contin.problems.orbits.special_orbits.sensitivity import error_of_equations
from contin.problems.tolerances import PROBE_TOLERANCE

REACH = 2.0  # scaled length, in the longest steps, after which mesh and metric are looked at again
FIRST_TEST = 2  # of other multipliers, after those of folds and branch points
LEAST = 10  # ... but not before so many steps


@dataclass(frozen=True, eq=False)
class OrbitLocusProblem(OfSpecialOrbits):
    """See `contin.problems.orbits.special_orbits.curve` for the unknowns and equations."""

    curve: OrbitCurve

    @property
    def maximum_chunk(self) -> int:
        """Steps in one kernel call, which cannot be interrupted: some 50 ms."""
        return max(10, min(160, 1500 // elementary.square(self.curve.orbits.n)))

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """Of orbits born at an equilibrium: by shooting where that is asked for, or the flow is piecewise smooth."""
        configured: Seed = lazy.module("discretisation").loci_as_chosen(seed, settings)
        return configured

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The curve's own tangent."""
        guide = np.zeros(z.size)
        guide[-1] = 1.0
        found = self.curve.settled(z, scale).correct(z, guide, 0.0, z, scale, np.inf)
        if isinstance(found, Failure):
            raise InputError(f"the curve of {self.locus} cannot be followed from here: its equations are singular")
        return [found.tangent]

    def _set_out(self, sample: Sample, frame: Frame) -> tuple[OrbitCurve, Sample]:
        """The curve with borders that fit at a point, and the point with its tests and tangent anew."""
        curve, found = self.curve.gauged(frame.gauge).settled(sample.z, frame.scale).carried(sample, frame.scale)
        if isinstance(found, Failure):
            if not sample.tests.size:
                raise InputError(f"the curve of {self.locus} cannot be followed from here: {found.value}")
            return curve, sample
        return curve, replace(found, z=sample.z, tangent=sample.tangent if sample.tests.size else found.tangent)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        limit = min(limit, self.maximum_chunk, max(LEAST, int(REACH / settings.max_step)))
        curve, start = self._set_out(origin, frame)
        chunk, turned = curve.march(start, before, length, frame.scale, step, limit, self.walls, settings)
        if turned is not None and self.locus == "LPC" and self.curve.orbits.multiple % 2 == 0:
            chunk = self._through_halves(chunk, turned, before, length, frame, settings)
        chunk = criticality.cut_at_change(self.curve, chunk, frame.scale)
        chunk = cut_at_birth(self, chunk, frame, settings) if self.curve.orbits.autonomous else chunk
        turns = self.test_of("CPC") if self.locus == "LPC" else None

        def counts(row: int, test: int) -> bool:
            """A curve turns round where its orbits shrink to a point: see `events.located`."""
            return test != turns or not self.has_shrunk(chunk.z[row], frame.scale)

        return until_dip(with_told_crossings(self.locus, chunk), before, length, FIRST_TEST, counts)

    def _through_halves(
        self, chunk: Chunk, turned: tuple[int, float], before: Sample | None, length: float, frame: Frame,
        settings: Settings,
    ) -> Chunk:  # fmt: skip
        """Folds of doubled orbits end where the two halves become one: they cross the curve of the doublings there.

        On a mesh the two curves miss each other by its error, and the one of folds turns off along the other. So the
        step that leads to the same orbits with their halves exchanged is taken as it is.
        """
        row, step = turned
        base = chunk.sample(row - 1)
        if row > 1:
            before, length = chunk.sample(row - 2), float(chunk.lengths[row - 1])
        curve, start = self._set_out(base, frame)
        one, _ = curve.march(start, before, length, frame.scale, step, 1, self.walls, settings, straight=True)
        if len(one) < 2 or not self.passes_half(base.z, one.z[-1], frame.scale):
            return chunk
        return one if row == 1 else chunk.cut(row, Stop.LIMIT, step)

    def measured_beside(self, type_: str, sample: Sample, frame: Frame) -> Sample:
        return criticality.beside_pole(self.curve, type_, sample, frame.scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        tolerance = min(settings.tolerance, PROBE_TOLERANCE)
        curve = self.curve.gauged(frame.gauge)
        found = curve.correct(base.z, base.tangent, length, guess, frame.scale, tolerance)
        if isinstance(found, Failure):
            nearer = curve.correct(base.z, base.tangent, length, guess, frame.scale, ONE_CORRECTION, exact=False)
            if isinstance(nearer, Failure):
                return None
            found = curve.correct(base.z, base.tangent, length, nearer.z, frame.scale, tolerance)
        if isinstance(found, Failure):
            return None
        wanted = criticality.is_measured(self.curve, base)
        return criticality.measured(self.curve, found, frame.scale) if wanted else found

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(guess.size)
        fixed[index] = 1.0
        z0 = guess.copy()
        z0[index] = value
        found = self.curve.correct(z0, fixed, 0.0, z0, scale, 1e-12, exact=False)
        if isinstance(found, Failure):
            return None
        z = found.z.copy()
        z[index] = value
        return z

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        end = self.at_birth(origin, before, frame.scale)
        if end is not None:
            return Renewal(frame.scale, origin, before, loop, end)
        if self.locus == "LPC" and before is not None and self.passes_half(before.z, origin.z, frame.scale):
            return Renewal(frame.scale, origin, before, loop, self.joined(origin.z))
        return self.connected(origin, before, frame) or renew(self, origin, before, frame, settings)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame] | None:
        finer, near, metric = self.on_finer_mesh(sample, frame)
        found = finer.probe(near, 0.0, near.z.copy(), metric, Settings())
        return None if found is None else (finer, found, metric)

    def on_finer_mesh(self, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame]:
        return on_finer_mesh(self, sample, frame)

    def with_coefficients(self, point: Verified, frame: Frame, finer: Any, there: Sample, metric: Frame) -> Verified:
        """By the return map; of types that have their coefficients from it, on curves of LPC, PD and NS."""
        if self.locus == "BPC" or not has_coefficients(point.type, self.system):
            return point
        theta = self.curve.theta(point.z) if point.type == "CH" else ANGLES.get(point.type, 0.0)
        return with_coefficients(point, theta, self._linear(point.z, frame), finer._linear(there.z, metric))

    def _linear(self, z: Array, frame: Frame) -> OrbitLinear:
        """The equations of the orbit alone."""
        curve = self.curve
        return OrbitLinear(curve.at(z), curve.orbit(z), curve.orbit(frame.scale), curve.orbit(z))

    def error_of_equations(self, z: Array, scale: Array) -> float:
        curve = self.curve
        return error_of_equations(curve.at(z), self.locus, curve.orbit(z), curve.orbit(scale), curve.theta(z))
