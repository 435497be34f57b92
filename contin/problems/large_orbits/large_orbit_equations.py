"""The equations of periodic orbits of large systems, and what is kept between calls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final, Self

import numpy as np

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.sample import Frame, Sample
from contin.linalg.factor import Factoriser
from contin.linalg.recycled import Recycled
from contin.linalg.vectors import dot, norm
from contin.problems.large_orbits.layout import Layout
from contin.problems.large_orbits.linearised import Jump, OrbitLinearisation, Solvers
from contin.problems.large_orbits.multipliers import Multipliers, leading
from contin.problems.large_orbits.points import Points
from contin.problems.large_orbits.radau import A, Trajectory
from contin.problems.large_orbits.sweeps import Closed, Sweeps
from contin.problems.one_parameter import InOneParameterProblem
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.zero_on_curve import At, point_at
from contin.systems.functions.function_system import FunctionSystem

SMALL: Final = 1e-8  # amplitude (scaled) below which an orbit has no phase of its own
SAME: Final = 1e-8  # scaled distance up to which factors serve for multipliers
DECISIONS: Final = corrector.Decisions(iterations=7.0, close=0.01, patience=4.0, old=0.1, off=1e-9)
Moved = Callable[[Array], Array]


@dataclass(eq=False)
class Memory:
    """What is kept between calls: the reference of the phase, and the factors of the last point."""

    reference: Array | None = None  # states
    direction: Array | None = None  # of the phase condition, normalised in scaled unknowns
    solvers: Solvers | None = None
    factoriser: Factoriser = field(default_factory=Factoriser)
    origin: Sample | None = None  # of the last march, well away from what it leads to

    def leave(self) -> None:
        """Constants have other values: factors serve no more, what solves with them have learnt does."""
        if self.solvers is not None:
            self.solvers = replace(self.solvers, z=np.full_like(self.solvers.z, np.nan))


@dataclass(frozen=True, eq=False)
class LargeOrbitEquations(InOneParameterProblem):
    """Orbits of a large system; `base` holds all parameters, entry `active` varies.

    z = (states, T, p), states (S,) as the layout has them.
    """

    system: FunctionSystem
    layout: Layout
    memory: Memory = field(default_factory=Memory)
    kind = "orbit"
    locus = None
    adaptive = True  # tests of a discretised problem: what is found beside a point is told apart down to 1e-4
    maximum_chunk = 2
    decisions = DECISIONS  # the factors of all intervals cost some fifteen times round the orbit, a correction four

    @cached_property
    def source(self) -> JacobianSource:
        """The Jacobian of the equations."""
        return JacobianSource(self.system)

    @property
    def states(self) -> int:
        """S"""
        return self.layout.count(self.n)

    @cached_property
    def angle_periods(self) -> Array:
        return np.zeros(self.states + 1)

    @property
    def winding(self) -> Array:
        """No state is an angle here."""
        return np.zeros(self.n)

    def with_active(self, name: str, z: Array | None = None) -> Self:
        return replace(super().with_active(name, z), memory=Memory())

    def effort(self) -> dict[str, int]:
        """Factorisations of intervals, and solves with them."""
        return self.memory.factoriser.tally.counts()

    def with_layout(self, layout: Layout) -> Self:
        """The same family in other unknowns."""
        tally = self.memory.factoriser.tally
        made = replace(self, layout=layout, memory=Memory(factoriser=Factoriser(tally)))
        vars(made).update(source=self.source, points=self.points)
        return made

    def vector(self, orbit: Trajectory, value: float) -> Array:
        """z of an orbit."""
        return np.concatenate([self.layout.vector(orbit), [orbit.period, value]])

    def profile(self, z: Array) -> Trajectory:
        """The orbit over one period."""
        return self.layout.orbit(self.points, self.full_parameters(z), z[:-2], float(z[-2]))

    def beginning(self, z: Array) -> Array:
        """Its first state."""
        return np.asarray(self.profile(z).beginnings[0])

    def velocity(self, z: Array) -> Array:
        """u' where it begins (n,); with a mass matrix that of the interpolating polynomial, which is M u' = F there."""
        if self.source.mass is not None:
            orbit = self.profile(z)
            return np.asarray(orbit.slopes[-1, -1] / orbit.period)
        return self.system.value(self.beginning(z), self.full_parameters(z))

    @cached_property
    def points(self) -> Points:
        """The equations at many states."""
        return Points(self.system, self.source)

    def settle(self, z: Array, tangent: Array, scale: Array) -> None:
        """The phase of orbits near z is that of z; of one of no size, that of the orbits it sets out to."""
        p, layout = self.full_parameters(z), self.layout
        orbit = self.profile(z)
        slopes = layout.slopes(self.points, p, orbit)
        still = norm(slopes / scale[:-2]) < SMALL
        change = tangent[:-2] * scale[:-2]
        if still:
            slopes = layout.turned(self.points, p, z[:-2], change, float(z[-2]))
        weighted = slopes * layout.weights(orbit)
        if still and change.any():  # the orbits that it sets out to have that phase, at one point of time too
            weighted = weighted - change * (dot(weighted, change) / dot(change, change))
        self.memory.reference = z[:-2].copy()
        self.memory.direction = weighted / max(norm(weighted * scale[:-2]), 1e-300)

    def prepare(self, z: Array, known: Solvers | None = None) -> None:
        """Called where a march sets out from z, which the mesh is made for, with what is known of it from before."""
        self.layout.prepare(self.points, self.full_parameters(z), z[:-2], float(z[-2]))
        fits = known is not None and np.array_equal(known.h, self.profile(z).h)
        self.memory.solvers = known.copy() if known is not None and fits else None

    def _unsettled(self) -> bool:
        return self.memory.direction is None

    def residual(self, z: Array) -> Array:
        """(S + 1,), the phase condition (in scaled unknowns, times the parameter's place) last."""
        memory = self.memory
        left = self.layout.defects(self.points, self.full_parameters(z), z[:-2], self.profile(z))
        phase = 0.0 if memory.direction is None or memory.reference is None else float(
            memory.direction @ (z[:-2] - memory.reference)
        )  # fmt: skip
        return np.append(left, phase)

    def sweeps(self, z: Array) -> Sweeps | None:
        """Factors at z; None where an equation is not finite."""
        found = self.solvers(z)
        return None if found is None else found.sweeps

    def solvers(self, z: Array) -> Solvers | None:
        """The same, with what solves have learnt."""
        memory = self.memory
        if memory.solvers is not None and np.array_equal(memory.solvers.z, z):
            return memory.solvers
        orbit, p = self.profile(z), self.full_parameters(z)
        if not np.all(np.isfinite(orbit.U)):
            return None
        found = self.points.jacobians(orbit.U.reshape(-1, self.n), p)
        if found is None:
            return None
        recycled = {} if memory.solvers is None else memory.solvers.recycled
        memory.solvers = None  # what takes so much memory is let go of before the next is made
        sweeps = Sweeps.of(found, orbit.period * orbit.h, memory.factoriser, self.source.mass)
        memory.solvers = Solvers(z.copy(), orbit.h, sweeps, found, recycled=recycled)
        self.layout.remember(sweeps)
        return memory.solvers

    def by_scalars(self, z: Array, places: Sequence[int]) -> Array:
        """Derivatives (1 + k, N, 3, n) of T h (A x 1) f by the period and by k parameters."""
        known, key = self.memory.solvers, tuple(places)
        kept = {} if known is None or not np.array_equal(known.z, z) else known.forces
        if key not in kept:
            kept[key] = self._by_scalars(z, places)
        return kept[key]

    def _by_scalars(self, z: Array, places: Sequence[int]) -> Array:
        orbit, p = self.profile(z), self.full_parameters(z)
        states = orbit.U.reshape(-1, self.n)
        slopes = [self.points.values(states, p).reshape(orbit.U.shape)]
        slopes += [orbit.period * self.points.parameter_slopes(states, p, k).reshape(orbit.U.shape) for k in places]
        return np.asarray(np.einsum("ik,sjkn->sjin", A, np.array(slopes)) * orbit.h[:, None, None])

    def carried(self, z: Array, raw: Array) -> Array | None:
        """The change (N, 3, n) of the orbit at z that a change `raw` of (states, T, p) makes."""
        sweeps = self.sweeps(z)
        if sweeps is None:
            return None

        def by_scalars() -> Array:
            return np.asarray(np.einsum("k,kjin->jin", raw[-2:], self.by_scalars(z, (self.active,))))

        return self.layout.carried(sweeps, raw[:-2], by_scalars)

    def at_constants(self, base: Array) -> Self:
        """The same family at other constants, with the same memory, patterns and colours."""
        made = replace(self, base=base)
        vars(made).update(source=self.source, points=self.points)
        return made

    def bordered(
        self, z: Array, places: Sequence[int], rows: Array, scale: Array, rough: bool = False, jump: Jump | None = None
    ) -> OrbitLinearisation | None:
        """The equations with these parameters free, the phase condition and `rows` (k, S + 1 + parameters), scaled."""
        residual = self.residual(z)
        if jump is not None:
            left = self.layout.jumped(self.points, residual[:-1], jump.length * jump.direction)
            residual = np.append(left, residual[-1])
        solvers = self.solvers(z) if np.all(np.isfinite(residual)) else None
        if solvers is None:
            return None
        assert self.memory.direction is not None
        key = tuple(places)
        if key not in solvers.answers:
            rest = np.zeros(self.n)
            solvers.answers[key] = np.array([solvers.sweeps.along(rest, c) for c in self.by_scalars(z, places)])
        answers, gaps = solvers.answers[key], None
        if jump is not None:
            answers = np.insert(answers, 1, 0.0, axis=0)
            gaps = np.insert(np.zeros((len(answers) - 1, self.n)), 1, jump.direction, axis=0)
        count = len(answers)
        phase = np.append(self.memory.direction, np.zeros(count))
        size = float(scale[0]) / np.sqrt(len(scale) - count)
        closed = Closed(
            solvers.sweeps, np.vstack([phase, rows / scale]), np.append(size, scale[-count:]), answers,
            self.layout.pick, solvers.recycled.setdefault((count, gaps is not None), Recycled()), gaps,
        )  # fmt: skip
        scaled = np.append(residual[:-1] / scale[:-count], residual[-1])
        return OrbitLinearisation(scaled, closed, scale, self.layout, count > 2, rough)

    def linearisation(self, z: Array, tangent: Array, scale: Array, rough: bool = False) -> OrbitLinearisation | None:
        """`rough`: see `OrbitLinearisation`."""
        if self._unsettled():
            self.settle(z, tangent, scale)
        return self.bordered(z, (self.active,), tangent[None], scale, rough)

    def again(self, here: corrector.Linearisation, z: Array) -> OrbitLinearisation | None:
        """A linearisation of this problem with the residual at another point, for one more correction."""
        assert isinstance(here, OrbitLinearisation)
        left = self.residual(z)
        if not np.all(np.isfinite(left)):
            return None
        count = here.rows
        return replace(here, residual=np.append(left[:-1] / here.scale[:-count], left[-1]), chord=True)

    def scale_of(self, size: float, rest: Array) -> Array:
        """States of one size, the norm that of a function of time and space; period and parameter in theirs."""
        return np.append(np.full(self.states, size * np.sqrt(self.states)), rest)

    def relaid(self, layout: Layout) -> tuple[Self, Moved, Moved]:
        """The family in other unknowns; what becomes of orbits (and changes of them) and of metrics."""
        problem = self.with_layout(layout)

        def moved(row: Array) -> Array:
            return problem.vector(self.profile(row), float(row[-1]))

        def metric(scale: Array) -> Array:
            return problem.scale_of(float(scale[0]) / np.sqrt(scale.size - 2), scale[-2:])

        return problem, moved, metric

    def finer(self) -> tuple[Self, Moved, Moved]:
        """The same on intervals of half the length, as in `relaid`."""
        layout, laid = self.layout.finer()
        if laid is not None:
            return self.relaid(layout)
        return self.with_layout(layout), lambda row: row, lambda scale: scale

    def on_half_lengths(self, z: Array, tangent: Array, scale: Array) -> tuple[Self, At, Array] | None:
        """The orbit near z, on the plane normal to its tangent, on intervals of half the length; and its metric."""
        problem, moved, metric = self.finer()
        finer = metric(scale)
        along = moved(tangent * scale) / finer
        base = Sample(moved(z), along / norm(along), np.zeros(0), 0, np.zeros(0, complex))
        problem.settle(base.z, base.tangent, finer)
        there = point_at(problem, base, 0.0, base.z, Frame(finer))
        return None if there is None else (problem, there, finer)

    def multipliers(self, z: Array, exactly: bool = False) -> Multipliers:
        """Leading multipliers without the trivial one, and their vectors."""
        last = self.memory.solvers
        near = last is not None and norm((last.z - z)[:-2]) < SAME * max(norm(z[:-2]), 1e-300)
        solvers = last if near and not exactly else self.solvers(z)
        if solvers is None:
            return np.empty(0, complex), np.empty((self.n, 0), complex)
        if solvers.leading is None:
            solvers.leading = leading(solvers.sweeps, self.velocity(z))
        return solvers.leading
