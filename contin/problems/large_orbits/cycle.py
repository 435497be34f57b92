"""A large orbit as the coefficients of its normal forms ask for it (`contin.normalforms.cycles.Cycle`).

M w' = A w + g, w(T) = rho w(0), is (P - rho) w = -(what g leads to from a beginning at rest), P the monodromy matrix:
bordered where rho is a multiplier, and solved by GMRES, as the orbit's own equations are. The functional <p, .> of the
left null vector p of P - rho is carried to all points by one way round back in time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.krylov import gmres
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.large_orbits.multipliers import critical_index
from contin.problems.large_orbits.radau import WEIGHTS, A, Trajectory
from contin.systems.functions.function_system import FunctionSystem

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations
    from contin.problems.large_orbits.linearised import Solvers
    from contin.problems.large_orbits.sweeps import Sweeps


@dataclass(frozen=True, eq=False)
class Monodromy:
    """[P - rho, b; c^H, 0] with k borders b, c (n, k)."""

    sweeps: Sweeps
    rho: complex
    b: Vector
    c: Vector

    def _solved(self, apply: Callable[[Vector], Vector], right: Vector, guess: Vector | None) -> Vector:
        known = right.astype(np.result_type(right, self.b, self.c, self.rho))
        x = gmres(apply, lambda r: r, known, guess=guess)[0]
        return x + gmres(apply, lambda r: r, known - apply(x), 1e-3)[0]  # once more, for what is nearly singular

    def solve(self, right: Vector) -> Vector:
        """(w, g) for a right side (n + k,)."""
        n = self.sweeps.n

        def forward(x: Vector) -> Vector:
            w = x[:n]
            below = np.einsum("ij,i->j", self.c.conj(), w)
            return np.append(self.sweeps.monodromy(w) - self.rho * w + np.einsum("ij,j->i", self.b, x[n:]), below)

        return self._solved(forward, right, None)

    def adjoint(self, right: Vector, guess: Vector | None = None) -> Vector:
        """The same of [P^H - rho*, c; b^H, 0]."""
        n = self.sweeps.n

        def backward(x: Vector) -> Vector:
            w = x[:n]
            below = np.einsum("ij,i->j", self.b.conj(), w)
            above = self.sweeps.transposed(w) - np.conj(self.rho) * w
            return np.append(above + np.einsum("ij,j->i", self.c, x[n:]), below)

        return self._solved(backward, right, guess)

    @classmethod
    def at(cls, sweeps: Sweeps, rho: complex, right: Vector) -> Monodromy:
        """Where rho is a multiplier with the right vectors (n, k): borders are these, and the left vectors."""
        n, k = right.shape
        c = np.linalg.qr(right)[0]
        b = np.linalg.qr(np.random.default_rng(31).normal(size=(n, k)).astype(np.result_type(c, rho)))[0]
        guesses: list[Vector | None] = [None] * k
        for _ in range(2):  # random borders first, which lose digits
            bordered = cls(sweeps, rho, b, c)
            unit = np.eye(n + k, k, -n)
            left = np.column_stack([bordered.adjoint(unit[:, i], guesses[i]) for i in range(k)])[:n]
            b = np.linalg.qr(left)[0]
            guesses = [np.append(b[:, i], np.zeros(k)) for i in range(k)]
        return cls(sweeps, rho, b, c)


@dataclass(frozen=True, eq=False)
class OnceRound:
    """M w' = A w + g, w(T) = rho w(0); functions are their values (N, 3, n) at the points.

    vectors : right vectors (n, k) of P to the multiplier rho; k = 0 where that is none.
    """

    cycle: LargeCycle
    rho: complex
    vectors: Vector

    @cached_property
    def bordered(self) -> Monodromy:
        if self.vectors.shape[1]:
            return Monodromy.at(self.cycle.sweeps, self.rho, self.vectors)
        return Monodromy(self.cycle.sweeps, self.rho, self.vectors, self.vectors)

    @cached_property
    def functionals(self) -> list[Vector]:
        """<p, .> of the left vectors p as weights of g (N, 3, n)."""
        step = self.cycle.step
        carried = [self.cycle.sweeps.backwards(p.conj()) for p in self.bordered.b.T]
        return [np.asarray(step * np.einsum("ki,jkn->jin", A, y)) for y in carried]

    @cached_property
    def null(self) -> tuple[Vector, Vector]:
        n, k = self.vectors.shape
        w = self.bordered.solve(np.eye(n + k, 1, -n)[:, 0])[:n]
        return self.cycle.sweeps.along(w), self.functionals[0]

    def projection(self, g: Vector, left: Vector | None = None) -> complex:
        return complex(np.sum((self.functionals[0] if left is None else left) * g))

    def modulus(self, g: Vector, left: Vector | None = None) -> float:
        return float(np.sum(np.abs(self.functionals[0] if left is None else left) * np.abs(g)))

    def solve(self, g: Vector, singular: bool) -> Vector:
        n, k = self.vectors.shape
        right = np.asarray(self.cycle.step * np.einsum("ik,jkn->jin", A, g))
        led = self.cycle.sweeps.along(np.zeros(n), right)[-1, 2]
        w = self.bordered.solve(np.append(-led, np.zeros(k)))[:n]
        return self.cycle.sweeps.along(w, right)


@dataclass(frozen=True, eq=False)
class LargeCycle:
    """The orbit at z; functions are their values (N, 3, n) at its points.

    multiplier, critical : the one that is critical, and its vector (n,).
    drifts : whether the period changes across a fold.
    system : other derivatives of second and third order than the problem's own.
    """

    problem: LargeOrbitEquations
    z: Array
    multiplier: complex
    critical: Vector
    drifts: bool = True
    system: FunctionSystem | None = None
    _equations: dict[tuple[complex, str], OnceRound] = field(default_factory=dict)  # those of one orbit

    autonomous = True

    @classmethod
    def of_type(cls, problem: LargeOrbitEquations, z: Array, type_: str) -> LargeCycle:
        """With the critical multiplier of LPC, PD, NS or BPC; LinAlgError where no multiplier may be that."""
        values, vectors = problem.multipliers(z, exactly=True)
        k = critical_index(values, type_)
        if k is None:
            raise np.linalg.LinAlgError("the multiplier that crosses is lost on one of the meshes")
        return cls.with_critical(problem, z, values[k], vectors[:, k])

    @classmethod
    def with_critical(cls, problem: LargeOrbitEquations, z: Array, value: complex, vector: Vector) -> LargeCycle:
        return cls(problem, z, complex(value), np.asarray(vector / norm(vector)))

    @property
    def theta(self) -> float:
        """The angle of the critical multiplier."""
        return float(elementary.angle(self.multiplier))

    @cached_property
    def solvers(self) -> Solvers:
        found = self.problem.solvers(self.z)
        if found is None:
            raise np.linalg.LinAlgError("the equations are not finite on the orbit")
        return found

    @property
    def sweeps(self) -> Sweeps:
        return self.solvers.sweeps

    @cached_property
    def orbit(self) -> Trajectory:
        return self.problem.profile(self.z)

    @property
    def period(self) -> float:
        return float(self.z[-2])

    @property
    def step(self) -> Array:
        return np.asarray(self.period * self.orbit.h[:, None, None])

    @cached_property
    def _states(self) -> Array:
        return self.orbit.U.reshape(-1, self.problem.n)

    @cached_property
    def rates(self) -> Vector:
        p = self.problem.full_parameters(self.z)
        return self.problem.points.values(self._states, p).reshape(self.orbit.U.shape)

    @cached_property
    def velocity(self) -> Array:
        return self.problem.velocity(self.z)

    @cached_property
    def shear(self) -> float:
        """|c|, P q = q + c u0'(0) of the critical vector q across a fold, in units of |q| / |u0'(0)|."""
        q, v = np.real(self.critical), self.velocity
        moved = self.sweeps.monodromy(q) - q
        return abs(float(v @ moved)) / (norm(v) * norm(q))

    def equation(self, rho: complex, name: str = "") -> OnceRound:
        key = complex(rho), name
        if key not in self._equations:
            self._equations[key] = self._equation(rho, name)
        return self._equations[key]

    def _equation(self, rho: complex, name: str) -> OnceRound:
        if rho == 1.0:
            return OnceRound(self, rho, self.velocity[:, None])
        if name != "critical":
            return OnceRound(self, rho, np.zeros((self.problem.n, 0)))
        q = self.critical if np.iscomplexobj(np.array(rho)) else np.real(self.critical)
        return OnceRound(self, rho, q[:, None])

    def values(self, w: Vector) -> Vector:
        return w

    def weighed(self, w: Vector) -> Vector:
        if np.iscomplexobj(w):
            return self.weighed(w.real) + 1j * self.weighed(w.imag)
        return self.problem.points.weighed(w)

    def first(self, w: Vector) -> Vector:
        return self.solvers.product(w)

    def slope_along(self, w: Vector, parameter: float) -> Vector:
        """A w + f_p parameter"""
        p, active = self.problem.full_parameters(self.z), self.problem.active
        by = self.problem.points.parameter_slopes(self._states, p, active).reshape(w.shape)
        return np.asarray(self.first(w) + parameter * by)

    def apply(self, *functions: Vector) -> Vector:
        """D^k f [w_1, ..., w_k] at all points."""
        return self._derivative(*((w, 0.0) for w in functions))

    def apply_with(self, v: Vector, p: float, w: Vector, q: float) -> Vector:
        """D^2 f [(v, p), (w, q)] at all points, the active parameter moving by p and q."""
        return self._derivative((v, p), (w, q))

    def _derivative(self, *changes: tuple[Vector, float]) -> Vector:
        system = self.problem.system if self.system is None else self.system
        p = np.tile(self.problem.full_parameters(self.z), (len(self._states), 1))
        directions = []
        for w, moved in changes:
            direction = np.hstack([w.reshape(self._states.shape), np.zeros(p.shape)])
            direction[:, self.problem.n + self.problem.active] = moved
            directions.append(direction)
        return np.asarray(system.derivatives(self._states, p, *directions)).reshape(self.orbit.U.shape)

    def mean(self, v: Vector, w: Vector) -> Any:
        """The mean of <v, w> over the orbit, of the states with mass."""
        mass = self.problem.source.mass
        moving = slice(None) if mass is None else np.diff(mass.indptr) > 0
        return np.einsum("j,i,ji->", self.orbit.h, WEIGHTS, np.sum((v.conj() * w)[:, :, moving], axis=2))

    def normalised(self, w: Vector) -> Vector:
        return np.asarray(w / np.sqrt(self.mean(w, w).real))

    def across_fold(self) -> tuple[Vector, Vector | None]:
        if self.drifts:
            return self.equation(1.0).solve(self.rates, singular=True), None
        q = np.real(self.critical)
        both = OnceRound(self, 1.0, np.column_stack([self.velocity, q]))
        along, across = (self.sweeps.along(w) for w in (self.velocity, q))
        one, other = both.functionals
        p = both.projection(self.rates, other).real * one - both.projection(self.rates, one).real * other
        return self.normalised(across - self.mean(along, across) / self.mean(along, along) * along), p
