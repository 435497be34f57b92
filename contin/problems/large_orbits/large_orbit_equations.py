"""The equations of periodic orbits of large systems by Radau collocation, and what is kept between calls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.problem import Frame, Sample
from contin.linalg.factor import Factoriser
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits.multipliers import leading
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import STAGES, WEIGHTS, A, Trajectory
from contin.problems.large_orbits.sweeps import Closed, Sweeps
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.special_points import At, point_at
from contin.systems.functions.function_system import FunctionSystem

SMALL: Final = 1e-8  # amplitude (scaled) below which an orbit has no phase of its own
SAME: Final = 1e-8  # scaled distance up to which factors serve for multipliers
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
class LargeOrbitEquations(InOneParameterProblem):
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

    def vector(self, orbit: Trajectory, value: float) -> Array:
        """z of an orbit."""
        return np.concatenate([orbit.U.ravel(), [orbit.period, value]])

    def profile(self, z: Array) -> Trajectory:
        """The orbit over one period."""
        return Trajectory(z[:-2].reshape(self.intervals, STAGES, self.n), float(z[-2]))

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

    def scale_of(self, size: float, rest: Array) -> Array:
        """States of one size, the norm that of a function of time and space; period and parameter in theirs."""
        count = self.intervals * STAGES * self.n
        return np.append(np.full(count, size * np.sqrt(count)), rest)

    def on_intervals(self, count: int) -> tuple[Self, Callable[[Array], Array], Callable[[Array], Array]]:
        """The family on another number of intervals; what becomes of orbits (and changes of them) and of metrics."""
        problem = replace(self, intervals=count, memory=Memory())

        def moved(row: Array) -> Array:
            return problem.vector(self.profile(row).refined(count), float(row[-1]))

        def metric(scale: Array) -> Array:
            return problem.scale_of(float(scale[0]) / np.sqrt(scale.size - 2), scale[-2:])

        return problem, moved, metric

    def on_half_lengths(self, z: Array, tangent: Array, scale: Array) -> tuple[Self, At, Array] | None:
        """The orbit near z, on the plane normal to its tangent, on intervals of half the length; and its metric."""
        problem, moved, metric = self.on_intervals(2 * self.intervals)
        finer = metric(scale)
        along = moved(tangent * scale) / finer
        base = Sample(moved(z), along / norm(along), np.zeros(0), 0, np.zeros(0, complex))
        problem.settle(base.z, base.tangent, finer)
        there = point_at(problem, base, 0.0, base.z, Frame(finer))
        return None if there is None else (problem, there, finer)

    def multipliers(self, z: Array, exactly: bool = False) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Leading multipliers without the trivial one, and their vectors."""
        memory = self.memory
        near = memory.last is not None and norm((memory.last - z)[:-2]) < SAME * max(norm(z[:-2]), 1e-300)
        sweeps = memory.sweeps if near and not exactly else self.sweeps(z)
        if sweeps is None:
            return np.empty(0, complex), np.empty((self.n, 0), complex)
        beginning = self.profile(z).U[-1, 2]
        return leading(sweeps, self.system.value(beginning, self.full_parameters(z)))
