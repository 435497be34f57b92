"""Where a large flow comes to rest from a state, by `contin.simulate.relax`'s method with sparse factors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NotFiniteError
from contin.linalg.linear import Linear
from contin.linalg.vectors import norm
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.search.large_equilibrium import LargeEquilibrium
from contin.simulate.natural import sizes_of
from contin.simulate.relax import FEWEST, PUSH, PUSHES, STEPS, Relaxed, Resolvent, run
from contin.simulate.with_mass import Weighed
from contin.systems.functions.function_system import FunctionSystem

EFFORT: Final = 1e8  # steps times entries of the Jacobian
PART: Final = 0.1
BESIDE: Final = 1e-6  # relative distance of a shift from its eigenvalue
Rest = Callable[[Array], LargeEquilibrium | None]


class LargeFlow:
    """M u' = F(u, p) at fixed p, its linear systems solved as those of its equilibria are."""

    def __init__(self, system: FunctionSystem, u: Array, p: Array) -> None:
        self.system, self.p, self.source = system, p, JacobianSource(system)
        linear = self.source.at(u, p)
        if linear is None:
            raise NotFiniteError(system.why_not_finite(u, p) or "the Jacobian is not finite at the start")
        self.sizes = _driven(linear, sizes(system, u, p))
        rate = float(np.max(linear.magnitude(self.sizes) / self.sizes))
        self.time = 1.0 / rate if rate > 0.0 else 1.0

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


def relax_large(system: FunctionSystem, u: Array, p: Array, rest: Rest) -> Relaxed:
    """Follow the flow until it rests; off an equilibrium that is unstable it is pushed twice.

    rest : from a state to the equilibrium next to it, None where there is none: its eigenvalues tell its stability.
    """
    if system.model.has_singular_mass:
        try:
            u = Weighed(system, system.model.mass_matrix, p).start(u)
        except InputError:  # an index above 1: Newton's method has to do without a trajectory
            return Relaxed(u, 0.0, "failed")
    flow = LargeFlow(system, u, p)
    steps, time, used = flow.steps(u), 0.0, 0
    for attempt in range(PUSHES + 1):
        end, taken = run(flow, u, steps - used)
        time, used = time + end.time, used + taken
        here = rest(end.u) if end.outcome == "rest" else None
        if here is None:
            return Relaxed(end.u, time, end.outcome, mean=end.mean)
        values = _eigenvalues(here)
        lead = values[int(np.argmax(values.real))] if len(values) else 0.0
        if not np.real(lead) > 0.0 or attempt == PUSHES:
            return Relaxed(here.u, time, "rest", not np.real(lead) > 0.0)
        direction = _eigenvector(here, complex(lead))
        if direction is None:
            return Relaxed(here.u, time, "rest", stable=False)
        u = here.u + PUSH * direction / float(np.max(np.abs(direction) / np.maximum(np.abs(here.u), flow.sizes)))
    raise AssertionError("the last attempt returns")


def _eigenvalues(here: LargeEquilibrium) -> Array:
    problem = LargeProblem(here.system, here.p, 0, here.source)
    return np.asarray(problem.stability(np.append(here.u, here.p[0]))[2])


def _eigenvector(here: LargeEquilibrium, value: complex) -> Array | None:
    """Its real part, by inverse iteration beside the eigenvalue; None where that fails."""
    linear = here.source.at(here.u, here.p)
    if linear is None:
        return None
    shifted = linear.shifted(value * (1.0 + BESIDE))
    q = np.random.default_rng(17).normal(size=len(here.u)).astype(float if value.imag == 0.0 else complex)
    for _ in range(3):
        q = shifted.solve(linear.weigh(q / norm(q)))
        if not np.all(np.isfinite(q)):
            return None
    return np.asarray(q.real / norm(q))
