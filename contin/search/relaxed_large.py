"""Where a large flow comes to rest from a state, by `contin.simulate.relax`'s method with sparse factors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NotFiniteError
from contin.linalg.copies import EPSILON, ROUNDINGS
from contin.linalg.linear import Linear, fastest_rate
from contin.linalg.vectors import norm
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.search.large_equilibrium import LargeEquilibrium
from contin.simulate.natural import sizes_of
from contin.simulate.relax import FEWEST, STEPS, Relaxed, Resolvent, Rest, to_rest
from contin.simulate.with_mass import Weighed
from contin.systems.functions.function_system import FunctionSystem

EFFORT: Final = 1e8  # steps times entries of the Jacobian
PART: Final = 0.1
BESIDE: Final = 1e-6  # relative distance of a shift from its eigenvalue
NEUTRAL: Final = ROUNDINGS * EPSILON  # of the fastest rate: growth that may be rounding of an eigenvalue 0


class LargeFlow:
    """M u' = F(u, p) at fixed p, its linear systems solved as those of its equilibria are."""

    def __init__(self, system: FunctionSystem, u: Array, p: Array) -> None:
        self.system, self.p, self.source = system, p, JacobianSource(system)
        linear = self.source.at(u, p)
        if linear is None:
            raise NotFiniteError(system.why_not_finite(u, p) or "the Jacobian is not finite at the start")
        self.sizes = _driven(linear, sizes(system, u, p))
        self.time = 1.0 / (fastest_rate(linear, self.sizes) or 1.0)

    def steps(self, u: Array) -> int:
        """How many are worth their cost."""
        linear = self.source.at(u, self.p)
        entries = getattr(getattr(linear, "matrix", None), "nnz", 50 * len(u))
        return int(np.clip(EFFORT / entries, FEWEST, STEPS))

    def value(self, u: Array) -> Array:
        return self.system.value(u, self.p)

    def weigh(self, x: Array) -> Array:
        mass = self.source.mass
        return x if mass is None else np.asarray(mass @ x)

    def at(self, u: Array) -> tuple[Array, Callable[[float], Resolvent | None]]:
        linear = self.source.at(u, self.p)

        def resolvent(h: float) -> Resolvent | None:
            if linear is None:
                return None
            moved = linear.shifted(1.0 / h)  # F_u - M/h
            return lambda r: np.asarray(moved.solve(r / -h))

        return self.value(u), resolvent


def sizes(system: FunctionSystem, u: Array, p: Array) -> Array:
    """Of the states (n,): declared, or at the start, or the model's; of one that is 0 in all of these the largest."""
    declared, usual = sizes_of(system.model, tuple(float(v) for v in p))
    found = np.where(declared > 0.0, declared, np.maximum(np.abs(u), usual))
    return np.where(found > 0.0, found, float(found.max(initial=0.0)) or 1.0)


def _driven(linear: Linear, size: Array) -> Array:
    """Sizes (n,), of none less than a part of what the others make of it: a field may vanish at one of its nodes."""
    driven = np.full(len(size), PART * float(size.max()))
    if linear.matrix is not None:
        own = np.abs(linear.matrix.diagonal())
        driven = np.divide(PART * linear.magnitude(size), own, out=np.zeros(len(size)), where=own > 0.0)
    return np.asarray(np.maximum(size, driven))


def relax_large(
    system: FunctionSystem, u: Array, p: Array, solved: Callable[[Array], LargeEquilibrium | None]
) -> Relaxed:
    """Follow the flow until it rests; off an equilibrium that is unstable it is pushed twice.

    solved : from a state to the equilibrium next to it, None where there is none: its eigenvalues tell its stability.
    """
    if system.model.has_singular_mass:
        try:
            u = Weighed(system, system.model.mass_matrix, p).start(u)
        except InputError:  # an index above 1: Newton's method has to do without a trajectory
            return Relaxed(u, 0.0, "failed")
    flow = LargeFlow(system, u, p)

    def rest(u: Array) -> Rest | None:
        here = solved(u)
        if here is None:
            return None
        values, linear = _eigenvalues(here), flow.source.at(here.u, p)
        lead = complex(values[int(np.argmax(values.real))]) if len(values) else 0.0j
        if linear is None or not lead.real > NEUTRAL * fastest_rate(linear, flow.sizes):
            return Rest(here.u, stable=linear is not None)
        return Rest(here.u, stable=False, fastest=_eigenvector(linear, lead, len(u)))

    return to_rest(lambda _: flow, u, flow.steps(u), rest)


def _eigenvalues(here: LargeEquilibrium) -> Array:
    problem = LargeProblem(here.system, here.p, 0, here.source)
    return np.asarray(problem.stability(np.append(here.u, here.p[0]))[2])


def _eigenvector(linear: Linear, value: complex, n: int) -> Array | None:
    """Its real part, by inverse iteration beside the eigenvalue; None where that fails."""
    shifted = linear.shifted(value * (1.0 + BESIDE))
    q = np.random.default_rng(17).normal(size=n).astype(float if value.imag == 0.0 else complex)
    for _ in range(3):
        q = shifted.solve(linear.weigh(q / norm(q)))
        if not np.all(np.isfinite(q)):
            return None
    return np.asarray(q.real / norm(q))
