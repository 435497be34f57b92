"""Periodic orbits of large systems as a continuation problem in one parameter.

z = (U, T, p), U (N, 3, n) by intervals of equal length. Equations: collocation in each interval, and the integral phase
condition sum <U_ref', U - U_ref> = 0 (Doedel), whose reference is the point that a step starts from.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation import march as python_march
from contin.continuation.problem import Chunk, Frame, Outcome, Sample, Verified, unverified
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.linalg.factor import Factoriser
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits import branch_points, events
from contin.problems.large_orbits.multipliers import leading, tests_of
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import STAGES, WEIGHTS, A, Trajectory
from contin.problems.large_orbits.sweeps import Closed, Sweeps
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.orbits.hopf_end import cut_at_birth
from contin.problems.scales import parameter_width
from contin.problems.sparse.jacobian import JacobianSource
from contin.systems.functions.function_system import FunctionSystem

INTERVALS: Final = 20
PERIOD_SCALE: Final = 1.0
SMALL: Final = 1e-8  # amplitude (scaled) below which an orbit has no phase of its own
SAME: Final = 1e-8  # scaled distance up to which factors serve for multipliers
COARSE_MESH: Final = 1e-3  # error of the trivial multiplier that is told
TOLERANCE: Final = 1e-11


@dataclass(eq=False)
class Memory:
    """What is kept between calls: the reference of the phase, and the factors of the last point."""

    reference: Array | None = None  # U
    direction: Array | None = None  # of the phase condition, normalised in scaled unknowns
    last: Array | None = None  # z
    sweeps: Sweeps | None = None
    factoriser: Factoriser = field(default_factory=Factoriser)
    origin: Sample | None = None  # of the last march, well away from what it leads to


@dataclass(frozen=True, eq=False)
class OrbitLinearisation:
    """Scaled residual, and M = [J; t] in scaled unknowns."""

    residual: Array
    closed: Closed
    scale: Array
    intervals: int
    sign: float = 1.0

    @cached_property
    def _null(self) -> Array:
        return self._solved(np.append(np.zeros(len(self.scale) - 1), 1.0), again=True)

    @property
    def log_determinant(self) -> float:
        """-log |M^-1 e|, with which the test for branch points is constant: multipliers tell them here."""
        length = norm(self._null)
        return -float(elementary.log(length)) if 0.0 < length < np.inf else 0.0

    def solve(self, right: Array) -> Array:
        """M x = right, in scaled unknowns."""
        if right[-1] == 1.0 and not right[:-1].any():
            return self._null
        return self._solved(right)

    def _solved(self, right: Array, again: bool = False) -> Array:
        raw = right[:-2] * self.scale[:-2]
        d, tp, _ = self.closed.solve(raw.reshape(self.intervals, STAGES, -1), right[-2:], again)
        return np.concatenate([d.ravel(), tp]) / self.scale


@dataclass(frozen=True, eq=False)
class LargeOrbitProblem(InOneParameterProblem):
    """Orbits of a large system; `base` holds all parameters, entry `active` varies."""

    system: FunctionSystem
    intervals: int
    memory: Memory = field(default_factory=Memory)

    kind = "orbit"
    locus = None
    is_map = True
    adaptive = True  # tests of a discretised problem: what is found beside a point is told apart down to 1e-4
    maximum_chunk = 2

    @cached_property
    def source(self) -> JacobianSource:
        """The Jacobian of the equations."""
        return JacobianSource(self.system)

    @cached_property
    def angle_periods(self) -> Array:
        return np.zeros(self.intervals * STAGES * self.n + 1)

    @property
    def winding(self) -> Array:
        """No state is an angle here."""
        return np.zeros(self.n)

    def with_active(self, name: str, z: Array | None = None) -> Self:
        return replace(super().with_active(name, z), memory=Memory())

    def configured(self, seed: Any, settings: Settings) -> Any:
        """A seed on as many intervals as the settings want."""
        wanted = settings.intervals
        if wanted is None or wanted == self.intervals:
            return seed
        problem = replace(self, intervals=wanted, memory=Memory())

        def moved(row: Array) -> Array:
            return problem.vector(self.profile(row).refined(wanted), float(row[-1]))

        if seed.scale is None:
            return replace(seed, problem=problem, z=moved(seed.z))
        size, rest = float(seed.scale[0]) / np.sqrt(seed.scale.size - 2), seed.scale[-2:]
        scale = problem.scale_of(size, rest)
        parts = [None if d is None else moved(d * seed.scale) / scale for d in (seed.direction, seed.curvature)]
        length = 1.0 if parts[0] is None else norm(parts[0])
        direction = None if parts[0] is None else parts[0] / length
        curvature = None if parts[1] is None else parts[1] / elementary.square(length)
        return replace(seed, problem=problem, z=moved(seed.z), direction=direction, curvature=curvature, scale=scale)

    def vector(self, orbit: Trajectory, value: float) -> Array:
        """z of an orbit."""
        return np.concatenate([orbit.U.ravel(), [orbit.period, value]])

    def profile(self, z: Array) -> Trajectory:
        """The orbit over one period."""
        return Trajectory(z[:-2].reshape(self.intervals, STAGES, self.n), float(z[-2]))

    # equations --------------------------------------------------------------------------------------------------------

    def _rates(self, U: Array, p: Array) -> Array:
        """f at the points, (N, 3, n)."""
        return self.points.values(U.reshape(-1, self.n), p).reshape(U.shape)

    @cached_property
    def points(self) -> Points:
        """The equations at many states."""
        return Points(self.system, self.source)

    def settle(self, z: Array, tangent: Array, scale: Array) -> None:
        """The phase of orbits near z is that of z; of one of no size, that of the orbits it sets out to."""
        slopes = self.profile(z).slopes.ravel()
        if norm(slopes / scale[:-2]) < SMALL:
            slopes = self.profile(tangent * scale).slopes.ravel()
        weighted = (slopes.reshape(self.intervals, STAGES, self.n) * WEIGHTS[:, None]).ravel() / self.intervals
        self.memory.reference = z[:-2].copy()
        self.memory.direction = weighted / max(norm(weighted * scale[:-2]), 1e-300)

    def _unsettled(self) -> bool:
        return self.memory.direction is None

    def residual(self, z: Array) -> Array:
        """(N 3 n + 1,), the phase condition (in scaled unknowns, times the parameter's place) last."""
        memory = self.memory
        orbit, p = self.profile(z), self.full_parameters(z)
        with np.errstate(all="ignore"):
            f = self._rates(orbit.U, p)
        step = orbit.period * orbit.h
        g = orbit.U - orbit.beginnings[:, None] - step * np.einsum("ik,jkn->jin", A, f)
        phase = 0.0 if memory.direction is None or memory.reference is None else float(
            memory.direction @ (z[:-2] - memory.reference)
        )  # fmt: skip
        return np.append(g.ravel(), phase)

    def sweeps(self, z: Array) -> Sweeps | None:
        """Factors at z; None where an equation is not finite."""
        memory = self.memory
        if memory.last is not None and np.array_equal(memory.last, z):
            return memory.sweeps
        orbit, p = self.profile(z), self.full_parameters(z)
        found = self.points.jacobians(orbit.U.reshape(-1, self.n), p)
        if found is None:
            return None
        memory.last, memory.sweeps = z.copy(), Sweeps.of(found, orbit.period * orbit.h, memory.factoriser)
        return memory.sweeps

    def by_scalars(self, z: Array, places: Sequence[int]) -> Array:
        """Derivatives (1 + k, N, 3, n) of T h (A x 1) f by the period and by k parameters."""
        orbit, p = self.profile(z), self.full_parameters(z)
        states = orbit.U.reshape(-1, self.n)
        slopes = [self._rates(orbit.U, p)]
        slopes += [orbit.period * self.points.parameter_slopes(states, p, k).reshape(orbit.U.shape) for k in places]
        return np.asarray(np.einsum("ik,sjkn->sjin", A, np.array(slopes)) * orbit.h)

    def image(self, z: Array, d: Vector) -> Vector | None:
        """T h (A x J) d for d (N, 3, n), real or complex; None where an equation is not finite."""
        orbit = self.profile(z)
        found = self.points.jacobians(orbit.U.reshape(-1, self.n), self.full_parameters(z))
        if found is None:
            return None
        moved = np.array([J @ row for J, row in zip(found, d.reshape(-1, self.n), strict=True)]).reshape(d.shape)
        return np.asarray(orbit.period * orbit.h * np.einsum("ik,jkn->jin", A, moved))

    def at_constants(self, base: Array) -> Self:
        """The same family at other constants, with the same memory, patterns and colours."""
        made = replace(self, base=base)
        vars(made).update(source=self.source, points=self.points)
        return made

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> OrbitLinearisation | None:
        if self._unsettled():
            self.settle(z, tangent, scale)
        residual = self.residual(z)
        if not np.all(np.isfinite(residual)):
            return None
        sweeps = self.sweeps(z)
        if sweeps is None:
            return None
        columns = -self.by_scalars(z, (self.active,))
        assert self.memory.direction is not None
        rows = np.array([np.append(self.memory.direction, [0.0, 0.0]), tangent / scale])
        size = float(scale[0]) / np.sqrt(len(scale) - 2)
        closed = Closed.of(sweeps, columns, rows, np.array([size, scale[-2], scale[-1]]))
        return OrbitLinearisation(np.append(residual[:-1] / scale[:-2], residual[-1]), closed, scale, self.intervals)

    # stability --------------------------------------------------------------------------------------------------------

    def multipliers(self, z: Array, exactly: bool = False) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Leading multipliers without the trivial one, and their vectors."""
        memory = self.memory
        near = memory.last is not None and norm((memory.last - z)[:-2]) < SAME * max(norm(z[:-2]), 1e-300)
        sweeps = memory.sweeps if near and not exactly else self.sweeps(z)
        if sweeps is None:
            return np.empty(0, complex), np.empty((self.n, 0), complex)
        beginning = self.profile(z).U[-1, 2]
        return leading(sweeps, self.system.value(beginning, self.full_parameters(z)))

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        values, _ = self.multipliers(z)
        tests, unstable = tests_of(values)
        return tests, unstable, np.append(1.0 + 0.0j, values)

    # the engine's contract --------------------------------------------------------------------------------------------

    def scale_of(self, size: float, rest: Array) -> Array:
        """States of one size, the norm that of a function of time and space; period and parameter in theirs."""
        count = self.intervals * STAGES * self.n
        return np.append(np.full(count, size * np.sqrt(count)), rest)

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
        self.settle(origin.z, origin.tangent, frame.scale)
        self.memory.origin = origin
        limit = min(limit, self.maximum_chunk)
        chunk = python_march.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_at_birth(self, chunk, frame, settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        self.settle(base.z, base.tangent, frame.scale)
        return python_march.probe(self, base, length, guess, frame, settings)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(guess.size)
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        self.settle(z0, fixed, scale)
        return python_march.with_one_fixed(self, -1, guess, value, scale, TOLERANCE)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return events.explain(a, b)

    def watch(self, type_: str) -> int | None:
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
        return (self.parameters[0], "period", *(f"{name}.{end}" for name in names for end in ("min", "max")))

    def columns(self, z: Array) -> dict[str, Array]:
        """The parameter, the period, smallest and largest value over the orbit's points of states and of what is
        recorded; where nothing has a name, of the states' norm."""
        columns: dict[str, Array] = {self.parameters[0]: z[:, -1].copy(), "period": z[:, -2].copy()}
        low, high = [], []
        for row in z:
            values = self._observed(row)
            low.append(values.min(axis=0))
            high.append(values.max(axis=0))
        for k, name in enumerate(self.column_names()[2:]):
            columns[name] = np.array(high if k % 2 else low)[:, k // 2]
        return columns

    def _observed(self, z: Array) -> Array:
        U, p = self.profile(z).U.reshape(-1, self.n), self.full_parameters(z)
        parts = [U] if self.system.state_names else []
        if self.system.observable_names:
            parts.append(self.system.observables(U, np.tile(p, (len(U), 1))))
        return np.hstack(parts) if parts else np.array([[norm(u) / np.sqrt(self.n)] for u in U])

    def explain_columns(self, z: Array) -> str | None:
        """Why an observable is not finite on the orbit."""
        text: str | None = self.system.explain_observables(self.profile(z).U[0, 0], self.full_parameters(z))
        return text

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        """Two points of one type are one: parameter and period agree."""
        slack = 3.0 * (a.error + b.error) + 1e-9 * float(scale[-1])
        return abs(float(a.z[-1] - b.z[-1])) <= slack and abs(float(a.z[-2] - b.z[-2])) <= 1e-5 * abs(float(a.z[-2]))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """What the trivial multiplier says of the mesh, at the last row."""
        sweeps = self.sweeps(z[-1])
        if sweeps is None:
            return ()
        velocity = self.system.value(self.profile(z[-1]).U[-1, 2], self.full_parameters(z[-1]))
        error = norm(sweeps.monodromy(velocity) - velocity) / max(norm(velocity), 1e-300)
        if not error > COARSE_MESH or norm(velocity) == 0.0:
            return ()
        return (
            f"the multiplier 1 of the last orbit is right to {error:.1g} only: the mesh is coarse; write more "
            f"`intervals` in `settings` (these are {self.intervals})",
        )

    def describe_failure(self, z: Array) -> str:
        text = self.system.explain(self.profile(z).U[0, 0], self.full_parameters(z))
        return text or f"Try a smaller settings.step, or more settings.intervals (these are {self.intervals})."
