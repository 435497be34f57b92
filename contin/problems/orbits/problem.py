"""Families of periodic orbits by orthogonal collocation, as a continuation problem in one parameter."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import STOPS, Chunk, Frame, Renewal, Sample, Stop, Verified
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.columns import names_of, orbit_columns, periods, with_observables
from contin.problems.orbits.family import FamilyOfOrbits
from contin.problems.orbits.forcing import ForcingPeriod
from contin.problems.orbits.in_phase import cut_at_start, in_phase
from contin.problems.orbits.layout import Profile, make_scale, profile_of, sizes_of
from contin.problems.orbits.mesh import WORTHWHILE
from contin.problems.orbits.planar import applies, resolve
from contin.problems.scales import balance

MESH_TOLERANCE = 1e-7  # error inside an interval, relative to the states' sizes; that of T and p is far smaller
PERIOD_SCALE = 2.0  # the period counts in the metric relative to this multiple of itself
CONSTANT = 1e-9  # an orbit with less amplitude than this (relative) is an equilibrium
PROBE_TOLERANCE = 1e-10
ALIGNED = 0.99  # cosine of two tangents at one point, up to rounding
SAME_PERIOD = 1e-5  # relative
SAME_EXTENT = 1e-2  # relative: of families that are born at one point with one period there are many
TINY_STATE = 1e-6  # a state this small beside the others may be zero with rounding errors
CONTROLS = 10  # numbers that steer the kernel, see `follow`
LONGEST_CHUNK = 120
DWELLING = 0.2  # part of the period spent slowly from which growing periods are watched closely


@dataclass(frozen=True, eq=False)
class _Rows:
    """What the kernel fills."""

    z: Array
    t: Array
    tests: Array
    unstable: NDArray[np.int64]
    re: Array
    im: Array
    lengths: Array
    errors: Array
    info: Array

    @classmethod
    def of(cls, rows: int, size: int, n: int) -> _Rows:
        return cls(
            np.empty((rows, size)), np.empty((rows, size)), np.empty((rows, 4)), np.zeros(rows, np.int64),
            np.full((rows, n), np.nan), np.zeros((rows, n)), np.zeros(rows), np.zeros(rows), np.zeros(6),
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class OrbitProblem(FamilyOfOrbits):
    """u'(x) = T f(u, p), u(1) = u(0) + winding, with a phase condition; z as in `contin.problems.orbits.layout`.

    points : Gauss points an interval.  intervals : fixed number of mesh intervals, or None.  multiple : forcing periods
    in one orbit of a forced system.
    """

    points: int = 4
    intervals: int | None = None
    multiple: int = 1
    tolerance: float = MESH_TOLERANCE
    forcing: ForcingPeriod | None = None
    origin: tuple[float, Array] | None = None  # parameter and period, states of the Hopf point it was born at
    angle_periods: Array = field(default_factory=lambda: np.zeros(0))  # the engine's wrapping is not used

    def __post_init__(self) -> None:
        if self.system.is_forced and self.forcing is None:
            object.__setattr__(self, "forcing", ForcingPeriod.of(self.system))

    @property
    def maximum_chunk(self) -> int:
        return LONGEST_CHUNK

    @cached_property
    def state_periods(self) -> Array:
        """Period of each state (n,), 0 where it is not an angle."""
        return np.asarray(self.system.model.periods(self.constants()))

    def profile(self, z: Array) -> Profile:
        return profile_of(z, self.n, self.points)

    @cached_property
    def equations(self) -> Any:
        """The kernels' view of the equations."""
        from contin.kernels.collocation import Equations

        scheme = basis(self.points)
        return Equations(
            self.system.value_address, self.system.jacobian_address, 0 if self.forcing is None else self.forcing.address,  # noqa: E501
            self.multiple, self.n, self.points, self.active, scheme.values, scheme.slopes, scheme.gauss,
            scheme.gauss_weights, np.asarray(self.winding, dtype=float),
        )  # fmt: skip

    def sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric that belongs to z's mesh."""
        return sizes_of(scale, self.profile(z).h, self.n, self.points)

    def is_constant(self, z: Array, scale: Array) -> bool:
        """True where the orbit is an equilibrium."""
        u = self.profile(z).u
        return bool(np.all(np.ptp(u, axis=0) <= CONSTANT * self.sizes(z, scale))) and not self.winding.any()

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        profile, width = self.profile(z), self.width(z, bounds)
        return make_scale(profile.h, self.points, self.state_sizes(profile), PERIOD_SCALE * profile.period, width)

    def state_sizes(self, profile: Profile) -> Array:
        """Typical size of every state on an orbit: its largest modulus, an angle's amplitude."""
        largest = np.abs(profile.u).max(axis=0)
        periods = self.state_periods
        largest = np.where(periods > 0.0, periods / (2.0 * np.pi), largest)
        small = largest <= TINY_STATE * float(largest.max())
        if small.any():  # zero, up to rounding: as large as the coupling to the other states makes it
            usual = balance(np.where(small, 0.0, largest), self._coupling(profile))
            largest = np.where(small & (largest < TINY_STATE * usual), usual, largest)
        return np.asarray(largest)

    def _coupling(self, profile: Profile) -> Array:
        """Mean modulus of the Jacobian along an orbit, (n, n)."""
        p = self.full_parameters(profile.vector())
        total = np.zeros((self.n, self.n))
        for u in profile.u[:: profile.m]:
            _, jacobian = self.system.jacobian(u, p)
            total += np.nan_to_num(np.abs(jacobian[:, : self.n]), posinf=0.0)
        return total / len(profile.h)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        from contin.problems.orbits.linear import branch_tangents

        return branch_tangents(self, z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        profile = self.profile(origin.z)
        limit = min(limit, self._chunk(profile.intervals))
        out = _Rows.of(limit + 1, origin.z.size, self.n)
        out.z[0], out.t[0] = origin.z, origin.tangent
        sizes = self.sizes(origin.z, frame.scale)
        controls = np.array([
            step, settings.min_step, settings.max_step, np.cos(np.radians(settings.max_angle)), settings.newton_tolerance,  # noqa: E501
            length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5, self._error_limit(profile, sizes),  # noqa: E501
            self._period_limit(profile, frame.scale), 0.0 if self.intervals is None else WORTHWHILE,
        ])  # fmt: skip
        reason = self._kernel(0, out, frame.scale, controls, limit, bounds, before, loop)
        z, t, info = out.z, out.t, out.info
        stop, m = STOPS[reason], int(info[0]) + 1
        if stop in (Stop.EVENT, Stop.DIP):
            for row in range(max(m - 2, 0), m):
                self._measure(out, row, Frame(frame.scale, float(info[3])))
        if applies(self):
            for row in range(m):
                self._resolve(out, row)
            changed = np.flatnonzero(np.diff(out.unstable[:m]))
            if changed.size:  # the march may have counted otherwise: what happens in its last step is looked at
                m, stop = (int(changed[0]) + 2, Stop.EVENT) if changed[0] + 2 < m or stop is Stop.LIMIT else (m, stop)
        detail = ""
        if stop is Stop.NOT_FINITE:
            nearby = self.profile(z[m - 1] + frame.scale * info[1] * t[m - 1])
            p = self.full_parameters(np.array([nearby.parameter]))
            detail = next((text for u in nearby.u if (text := self.system.explain(u, p))), "")
        chunk = Chunk(
            z[:m], t[:m], out.tests[:m], out.unstable[:m], out.re[:m] + 1j * out.im[:m], out.lengths[:m], stop,
            float(info[1]), float(info[3]), int(info[4]), int(info[2]), detail,
        )  # fmt: skip
        return cut_at_start(self, chunk, loop, frame.scale)

    def in_phase(self, start: Sample, near: Array, scale: Array) -> Sample:
        return in_phase(self, start, near, scale) if self.autonomous and start.z.size == near.size else start

    def _chunk(self, intervals: int) -> int:
        """Steps in one kernel call, which cannot be interrupted: some 50 ms."""
        step = 1e-6 * intervals * (2.0 + 0.8 * self.n + 0.007 * self.n**3)  # seconds
        return int(np.clip(0.05 / step, 10, LONGEST_CHUNK))

    def _measure(self, out: _Rows, row: int, frame: Frame) -> None:
        """Tests and multipliers of a row anew: the march takes them from factors of a point nearby."""
        exact = self._probe(out.z[row], out.t[row], 0.0, out.z[row], frame, PROBE_TOLERANCE)
        if exact is not None and float(exact.tangent @ out.t[row]) > ALIGNED:
            out.tests[row], out.unstable[row] = exact.tests, exact.unstable
            out.re[row], out.im[row] = exact.eigenvalues.real, exact.eigenvalues.imag

    def _resolve(self, out: _Rows, row: int) -> None:
        """Planar orbits have a formula for their multiplier."""
        count = resolve(self, out.z[row], out.re[row], out.im[row], out.tests[row])
        out.unstable[row] = out.unstable[row] if count is None else count

    def _error_limit(self, profile: Profile, sizes: Array) -> float:
        from contin.problems.orbits.mesh import estimate

        error, _ = estimate(profile, sizes)
        return max(self.tolerance, (3.0 if self.intervals is None else 10.0) * error)

    def _period_limit(self, profile: Profile, scale: Array) -> float:
        """The period at which a march returns: soon, where the orbit already lingers somewhere."""
        position = profile.u.size
        limit = 2.0 * float(scale[position])
        if self.autonomous and dwelling(profile, self.sizes(profile.vector(), scale)) > DWELLING:
            limit = min(limit, 1.1 * profile.period)
        return limit

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        if length == 0.0 and self.autonomous and self.is_constant(base.z, frame.scale):
            return None
        return self._probe(base.z, base.tangent, length, guess, frame, min(settings.tolerance, PROBE_TOLERANCE))

    def _probe(
        self, z0: Array, tangent: Array, length: float, guess: Array, frame: Frame, tolerance: float
    ) -> Sample | None:
        out = _Rows.of(2, z0.size, self.n)
        out.z[0], out.t[0], out.z[1] = z0, tangent, guess
        out.info[3] = frame.reference
        controls = np.array([length, 0.0, 0.0, 0.0, tolerance, 0.0, 0.0, 0.0, 0.0, 0.0])
        count = self._kernel(1, out, frame.scale, controls, 0)
        out.unstable[1] = max(count, 0)
        if count >= 0:
            self._resolve(out, 1)
            count = int(out.unstable[1])
        return None if count < 0 else Sample(out.z[1], out.t[1], out.tests[1], int(count), out.re[1] + 1j * out.im[1])

    def corrected(self, sample: Sample, frame: Frame, tolerance: float) -> Array | None:
        """The orbit on the hyperplane through the sample, normal to its tangent; no measuring."""
        out = _Rows.of(2, sample.z.size, self.n)
        out.z[0], out.t[0], out.z[1] = sample.z, sample.tangent, sample.z
        controls = np.zeros(CONTROLS)
        controls[4] = tolerance
        return out.z[1] if self._kernel(3, out, frame.scale, controls, 0) == 0 else None

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""
        out = _Rows.of(1, z.size, self.n)
        out.z[0], out.t[0] = z, 0.0
        self._kernel(2, out, np.ones_like(z), np.zeros(CONTROLS), 0)
        resolve(self, z, out.re[0], out.im[0])
        return np.asarray(out.re[0] + 1j * out.im[0])

    def _kernel(
        self, mode: int, out: _Rows, scale: Array, controls: Array, limit: int, bounds: tuple[float, float] = (0.0, 0.0),  # noqa: E501
        before: Sample | None = None, loop: Sample | None = None,
    ) -> int:  # fmt: skip
        from contin.kernels import collocation_march as kernel

        scheme, n = basis(self.points), self.n
        none, size = np.empty(0), out.z.shape[1]
        intervals = (size - n - 2) // (self.points * n + 1)
        free = n - 1 if self.autonomous else n
        points, factors, scratch = kernel.new_memory(  # type: ignore[no-untyped-call]
            n, self.points, free, intervals, size, self.full_parameters(out.z[0])
        )
        return int(kernel.follow(
            mode, self.equations, points, factors, scratch, scale, self.sizes(out.z[0], scale),
            np.array(bounds, dtype=float), controls, limit, scheme.top, scheme.error,
            out.z[0] if before is None else before.z, out.t[0].copy() if before is None else before.tangent,
            np.zeros(kernel.TESTS) if before is None else before.tests,  # type: ignore[attr-defined]
            none if loop is None else loop.z, none if loop is None else loop.tangent,
            out.z, out.t, out.tests, out.unstable, out.re, out.im, out.lengths, out.errors, out.info,
        ))  # fmt: skip

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros_like(scale)
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        found = self._probe(z0, fixed, 0.0, z0, Frame(scale), 1e-12)
        if found is None:
            return None
        found.z[-1] = value
        return found.z

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        from contin.problems.orbits.events import explain

        return explain(a, b)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Verified | str:
        from contin.problems.orbits.events import verify

        return verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Verified | str]:
        from contin.problems.orbits.events import verify_compound

        return verify_compound(self, a, b, frame)

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Verified | str | None:
        return None

    def cross_corner(self, last: Sample, frame: Frame, settings: Settings) -> tuple[Sample, Verified | None] | None:
        return None

    def reverses(self, z: Array, tangent: Array, symmetries: Sequence[str]) -> bool:
        """True at an orbit at which the family meets its own image."""
        from contin.problems.orbits.symmetry import reverses

        return any(reverses(self, z, tangent, name) for name in symmetries)

    def moved(self, name: str, z: Array) -> Array:
        """Images of rows z under a declared symmetry."""
        from contin.problems.orbits.symmetry import orbits_moved

        return orbits_moved(self, name, z)

    def columns(self, z: Array) -> dict[str, Array]:
        """Parameter, period, and smallest and largest value over the orbit of every state and observable."""

        def functions(u: Array, rows: Array) -> Array:
            p = np.tile(self.full_parameters(np.zeros(1)), (len(rows), 1))
            p[:, self.active] = rows[:, -1]
            return with_observables(self.system, u, p)

        columns = {self.parameters[0]: z[:, -1].copy(), "period": periods(z, self.profile)}
        return columns | orbit_columns(z, names_of(self.system), self.profile, functions)

    def departures(self, point: SpecialPoint, parameter: str, orbits: bool) -> list[Seed]:
        """Families born at a labelled point, for the explorer; at a homoclinic orbit there may be none."""
        if point.type == "HOM":
            with suppress(InputError):
                return self.switch(point, parameter)
        return self.switch(point, parameter) if point.type in ("BPC", "PD") else []

    def switch(self, point: SpecialPoint, parameter: str) -> list[Seed]:
        from contin.problems.orbits.switch import switch

        return switch(self, point, parameter)

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        """The curve of such orbits in two parameters."""
        from contin.problems.orbits.loci.start import loci_of_orbit

        return loci_of_orbit(self, point, parameters)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        from contin.problems.orbits.renewal import renew

        return renew(self, origin, before, loop, frame, settings)

    def foretold(self, origin: Sample, before: Sample, frame: Frame) -> Renewal | None:
        """A homoclinic orbit that the family was near when its corrector failed."""
        from contin.problems.orbits.ends import foretold

        found = foretold(self, origin, before, frame)
        return None if found is None else Renewal(frame.scale, origin, before, None, found.end, found.last, found.point)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        slack = 3.0 * (a.error + b.error) + 1e-9 * float(scale[-1])
        one, other = self.profile(a.z), self.profile(b.z)
        extents = np.ptp(one.u, axis=0), np.ptp(other.u, axis=0)
        alike = np.all(np.abs(extents[0] - extents[1]) <= SAME_EXTENT * np.maximum(*extents).max())
        same_time = abs(one.period - other.period) < SAME_PERIOD * one.period
        return abs(float(a.z[-1] - b.z[-1])) <= slack and same_time and bool(alike)

    def describe_failure(self, z: Array) -> str:
        from contin.problems.orbits.mesh import estimate

        profile = self.profile(z)
        for u in profile.u:
            text = self.system.explain(u, self.full_parameters(z))
            if text:
                return str(text)
        error, _ = estimate(profile, self.state_sizes(profile))
        if error > 100.0 * self.tolerance:
            return (
                f"The mesh of {profile.intervals} intervals does not resolve the orbit (estimated error {error:.1e}): it is "  # noqa: E501
                "very stiff here (a canard?). Try settings.intervals, or start from a simulation beyond this point."
            )
        return "Try a smaller settings.step or min_step, or a larger settings.tolerance; check that the equations are smooth here."  # noqa: E501


def dwelling(profile: Profile, sizes: Array) -> float:
    """Part of the period during which the orbit moves at less than a twentieth of its mean speed."""
    steps = np.linalg.norm(np.diff(profile.u, axis=0) / sizes, axis=1)
    lengths = np.diff(profile.times)
    speed = steps / lengths
    return float(lengths[speed < 0.05 * float(steps.sum())].sum())
