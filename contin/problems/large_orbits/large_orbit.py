"""Periodic orbits of large systems as a continuation problem in one parameter.

z = (states, T, p): U (N, 3, n) at the points of intervals of equal length (collocation), or x (m, n) where segments
start (shooting). Equations: collocation in each interval, or x - flow(x) = 0, and the integral phase condition
sum <U_ref', U - U_ref> = 0 (Doedel), whose reference is the point that a step starts from.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.location.sameness import slack
from contin.continuation.outcome import Outcome, Verified, unverified
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.continuation.together import Together
from contin.errors import InputError
from contin.linalg.linear import DirectLinear
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.equal_multipliers import passing_together
from contin.problems.large_orbits import branch_points, coarse_birth, events, fast_modes
from contin.problems.large_orbits.from_starts import FromStarts
from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations
from contin.problems.large_orbits.layout import Layout, OnPoints
from contin.problems.large_orbits.linearised import OrbitLinearisation, Solvers
from contin.problems.large_orbits.multipliers import tests_of
from contin.problems.large_orbits.radau import STAGES, extremes
from contin.problems.moved_along import distance_name, distances, remarks_on_frame
from contin.problems.orbits.hopf_end import cut_at_birth
from contin.problems.scales import parameter_width
from contin.problems.tolerances import ONE_FIXED

INTERVALS: Final = 20
PERIOD_SCALE: Final = 1.0
COARSE_MESH: Final = 1e-3  # error of the trivial multiplier that is told


@dataclass(frozen=True, eq=False)
class Marched:
    """A problem as a march sees it: linearisations whose tangents are as precise as its points."""

    problem: LargeOrbitProblem

    @property
    def angle_periods(self) -> Array:
        return self.problem.angle_periods

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> OrbitLinearisation | None:
        """See `LargeOrbitEquations`."""
        return self.problem.linearisation(z, tangent, scale, rough=True)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """See `LargeOrbitProblem`."""
        return self.problem.stability(z)


@dataclass(frozen=True, eq=False)
class LargeOrbitProblem(LargeOrbitEquations):
    """The equations of `LargeOrbitEquations`, followed by the march in Python."""

    def configured(self, seed: Any, settings: Settings) -> Any:
        """A seed in the unknowns that the settings want: on so many intervals, or where so many segments start."""
        layout = self._chosen(settings)
        if layout is self.layout:
            return seed
        problem, moved, metric = self.relaid(layout)
        if seed.scale is None:
            return replace(seed, problem=problem, z=moved(seed.z))
        if isinstance(self.layout, FromStarts):
            raise InputError(
                "a family that is born on one by shooting is followed by shooting, with as many segments for each "
                "period: leave settings.method and settings.intervals out"
            )
        scale = metric(seed.scale)
        parts = [None if d is None else moved(d * seed.scale) / scale for d in (seed.direction, seed.curvature)]
        length = 1.0 if parts[0] is None else norm(parts[0])
        direction = None if parts[0] is None else parts[0] / length
        curvature = None if parts[1] is None else parts[1] / elementary.square(length)
        return replace(seed, problem=problem, z=moved(seed.z), direction=direction, curvature=curvature, scale=scale)

    def _chosen(self, settings: Settings) -> Layout:
        """The layout that the settings want; the own one where they do not say."""
        own, wanted = self.layout, settings.intervals
        shooting = isinstance(own, FromStarts) if settings.method is None else settings.method == "shooting"
        if shooting and self.source.mass is not None:
            raise InputError(
                "orbits of a function with a mass matrix are computed by collocation: leave settings.method out"
            )
        if isinstance(own, FromStarts) and shooting:
            return own if wanted in (None, own.segments) else FromStarts(wanted or 1)
        if shooting:
            return FromStarts(wanted or 1)
        if isinstance(own, OnPoints):
            return own if wanted in (None, own.intervals) else OnPoints(wanted or INTERVALS)
        return OnPoints(wanted or INTERVALS)

    # stability --------------------------------------------------------------------------------------------------------

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        values, _ = self.multipliers(z)
        tests, unstable = tests_of(values)
        return tests, unstable, np.append(1.0 + 0.0j, values)

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        U = self.profile(z).U
        size = float(np.max(np.ptp(U.reshape(-1, self.n), axis=0), initial=0.0)) or float(np.abs(U).max()) or 1.0
        width = parameter_width(self.system.model, self.parameters[0], float(z[-1]), bounds)
        return self.scale_of(size, np.array([PERIOD_SCALE * z[-2], width]))

    def orbit_sizes(self, z: Array, scale: Array) -> Array:
        """Sizes of the states (n,) in a metric of z."""
        return np.full(self.n, float(scale[0]) / np.sqrt(len(scale) - 2))

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        border = np.random.default_rng(3).normal(size=z.size)
        self.settle(z, border, scale)
        tangent = python_march.null_vector(self, z, scale, border, 2)
        if tangent is None:
            raise InputError("the orbits cannot be followed from here: the equations are not finite")
        return [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        self.prepare(origin.z, frame.gauge if isinstance(frame.gauge, Solvers) else None)
        self.settle(origin.z, origin.tangent, frame.scale)
        self.memory.origin = origin
        limit = min(limit, self.maximum_chunk)
        chunk = python_march.march(
            Marched(self), origin, before, length, frame, step, limit, bounds, settings, loop, self.again,
            decisions=self.decisions,
        )  # fmt: skip
        chunk = replace(chunk, gauge=None if self.memory.solvers is None else self.memory.solvers.copy())
        return cut_at_birth(self, chunk, frame, settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        self.settle(base.z, base.tangent, frame.scale)
        return python_march.probe(self, base, length, guess, frame, settings)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        found = self.on_half_lengths(sample.z, sample.tangent, frame.scale)
        if found is None:
            return None
        problem, there, scale = found
        tests, unstable, values = problem.stability(there.z)
        tests = np.concatenate([[there.tangent[-1], sample.tests[1]], tests])
        return problem, Sample(there.z, there.tangent, tests, unstable, values), Frame(scale)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(guess.size)
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        self.settle(z0, fixed, scale)
        return python_march.with_one_fixed(self, -1, guess, value, scale, ONE_FIXED)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return events.explain(a, b)

    def together(self, a: Sample, b: Sample) -> Iterable[Together]:
        return passing_together(a, b, True, ("NS", "PD", "BPC"))

    def test_of(self, type_: str) -> int | None:
        return {"LPC": 0, "NS": 2, "PD": 3, "BPC": 4}.get(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        try:
            if type_ == "BPC":
                return branch_points.verify(self, near, frame)
            self.settle(near.z, near.tangent, frame.scale)
            return events.verify(self, type_, near, frame)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            return unverified(type_, str(error))

    # words and columns ------------------------------------------------------------------------------------------------

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives."""
        names = [*self.system.state_names, *self.system.observable_names] or ["norm"]
        ends = (f"{name}.{end}" for name in names for end in ("min", "max"))
        return (self.parameters[0], "period", *ends, *distance_name(self.system))

    def columns(self, z: Array) -> dict[str, Array]:
        """The parameter, the period, smallest and largest value over the orbit of states and of what is recorded; where
        nothing has a name, of the states' norm; and how far the frame moves over a period, where it does."""
        columns: dict[str, Array] = {self.parameters[0]: z[:, -1].copy(), "period": z[:, -2].copy()}
        values = [(row, self._observed(row)) for row in z]
        ends = np.array([extremes(v.reshape(len(v) // STAGES, STAGES, -1)) for _, v in values])
        names = self.column_names()[2:]
        for k in range(2 * ends.shape[2]):
            columns[names[k]] = ends[:, k % 2, k // 2]
        first = len(self.system.state_names)

        def integrals(k: int) -> Array:
            return np.array([self.profile(row).integral(v[:, first + k]) for row, v in values])

        return columns | distances(self.system, integrals)

    def _observed(self, z: Array) -> Array:
        U, p = self.profile(z).U.reshape(-1, self.n), self.full_parameters(z)
        parts = [U] if self.system.state_names else []
        if self.system.observable_names:
            parts.append(self.system.observables(U, np.tile(p, (len(U), 1))))
        return np.hstack(parts) if parts else np.array([[norm(u) / np.sqrt(self.n)] for u in U])

    def explain_columns(self, z: Array) -> str | None:
        """Why an observable is not finite on the orbit."""
        text: str | None = self.system.why_observables_not_finite(self.beginning(z), self.full_parameters(z))
        return text

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        """Two points of one type are one: parameter and period agree."""
        near = abs(float(a.z[-1] - b.z[-1])) <= slack(a, b, scale)
        return near and abs(float(a.z[-2] - b.z[-2])) <= 1e-5 * abs(float(a.z[-2]))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """What the trivial multiplier says of the mesh, and the phase of a moving frame, at the last row."""
        born = coarse_birth.remark(self.parameters[0], z, self._amplitude) if isinstance(self.layout, OnPoints) else ""
        frame = remarks_on_frame(self.system, self.profile(z[-1]).U.reshape(-1, self.n))
        fast = self._fast_modes(z[-1])
        return (*self._on_mesh(z), *(text for text in (born, fast) if text), *frame)

    def _fast_modes(self, z: Array) -> str:
        """A note where modes are too fast for the mesh, of systems whose eigenvalues are computed in no time."""
        if not isinstance(self.layout, OnPoints) or self.n > fast_modes.MOST or self.source.mass is not None:
            return ""
        orbit = self.profile(z)
        linear = self.source.at(self.beginning(z), self.full_parameters(z))
        if not isinstance(linear, DirectLinear):
            return ""
        return fast_modes.remark(np.linalg.eigvals(linear.matrix.toarray()), orbit.period, orbit.h)

    def _amplitude(self, z: Array) -> float:
        """Root of the sum of the states' variances."""
        U = self.profile(z).U.reshape(-1, self.n)
        return norm((U - U.mean(axis=0)).ravel()) / float(np.sqrt(len(U)))

    def _on_mesh(self, z: Array) -> Sequence[str]:
        sweeps = self.sweeps(z[-1])
        if sweeps is None:
            return ()
        velocity = self.velocity(z[-1])
        error = norm(sweeps.monodromy(velocity) - velocity) / max(norm(velocity), 1e-300)
        if not error > COARSE_MESH or norm(velocity) == 0.0:
            return ()
        more = "" if not isinstance(self.layout, OnPoints) else (
            f": the mesh is coarse; write more `intervals` in `settings` (these are {self.layout.intervals})"
        )  # fmt: skip
        return (f"the multiplier 1 of the last orbit is right to {error:.1g} only{more}",)

    def describe_failure(self, z: Array) -> str:
        text = self.system.why_not_finite(self.beginning(z), self.full_parameters(z))
        text = text or "".join(remarks_on_frame(self.system, self.profile(z).U.reshape(-1, self.n)))
        if not isinstance(self.layout, OnPoints):
            return text or "Try a smaller settings.step."
        return text or f"Try a smaller settings.step, or more settings.intervals (these are {self.layout.intervals})."
