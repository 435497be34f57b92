"""From a guess to an equilibrium of a large system."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.linalg.copies import EPSILON
from contin.linalg.linear import Linear
from contin.linalg.newton import longest_part
from contin.linalg.vectors import norm
from contin.problems.sparse.as_dense import SMALL, divided
from contin.problems.sparse.jacobian import JacobianSource
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.search.equilibrium_from_guess import Equilibrium
from contin.search.tolerances import ACCEPTABLE, ACCURATE
from contin.systems.functions.function_system import FunctionSystem

BUDGET = 40
UNSEEN = 1e-11  # part of its size up to which a product is rounding
SETTLED = 1e-9  # part of a state that its own correction is at the end, ...
NOISE = 100.0  # ... or times what rounding of the equations' terms makes of it
VANISHED = 1e-30  # part of the largest state met on the way, below which all are zero if zero solves the equations
LATE = 8  # corrections for states that are small beside others


@dataclass(frozen=True, eq=False)
class LargeEquilibrium:
    """A solution of F(u, p) = 0 at fixed parameters: the start of a continuation."""

    system: FunctionSystem
    u: Array
    p: Array
    source: JacobianSource

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""
        active = list(self.system.parameter_names).index(parameter)
        problem = LargeProblem(self.system, self.p, active, self.source)
        return Seed(problem, np.append(self.u, self.p[active]))

    def __str__(self) -> str:
        return f"equilibrium of {len(self.u)} unknowns, largest {float(np.abs(self.u).max()):.6g}"


def as_small(solution: object) -> object:
    """An equilibrium of a small function with a sparse Jacobian as one of a dense problem; anything else as it is."""
    if not isinstance(solution, LargeEquilibrium) or solution.system.model.written is not None:
        return solution
    if solution.system.n > SMALL or solution.system.model.has_singular_mass:
        return solution
    return Equilibrium(divided(solution.system), solution.u, solution.p, solution.system.model.periods())


def refuse_singular_pencil(linear: Linear, name: str) -> None:
    """InputError where a direction is in the kernels of F_u and of M, so that solutions are not determined by it."""
    q = np.random.default_rng(13).normal(size=linear.mass.shape[0])
    for _ in range(2):
        q = linear.solve(q / norm(q))
        if not np.all(np.isfinite(q)):
            return
    q = q / norm(q)
    is_kernel = norm(linear.apply(q)) <= UNSEEN * norm(linear.magnitude(np.abs(q)))
    if is_kernel and norm(linear.weigh(q)) <= UNSEEN * norm(abs(linear.mass) @ np.ones(len(q))):
        k = int(np.argmax(np.abs(q)))
        raise InputError(
            f"function {name!r}: states are not determined, neither by F = 0 nor by M: F_u q = 0 and M q = 0 with q "
            f"largest in component {k}. A pressure that is defined up to a constant? Fix one value by an equation "
            "of its own"
        )


def _ahead(
    system: FunctionSystem, p: Array, linear: Linear, u: Array, step: Array, part: float
) -> tuple[float, tuple[Array, Array]] | None:
    """The length of the next step after a part of this one, with the state and F there."""
    there = u + part * step
    f = system.value(there, p)
    return (float(np.max(np.abs(linear.solve(-f)))), (there, f)) if np.all(np.isfinite(f)) else None


def _is_settled(linear: Linear, u: Array, step: Array) -> bool:
    """Whether the correction of every state is a small part of it, or what rounding of the equations' terms makes."""
    moved, small = np.abs(step), SETTLED * np.abs(u)
    if np.all(moved <= small):
        return True
    signs = np.random.default_rng(19).choice([-1.0, 1.0], len(u))
    rounding = np.abs(linear.solve(EPSILON * signs * linear.magnitude(np.abs(u))))
    return bool(np.all(moved <= np.maximum(small, NOISE * rounding)))


def converge_large(system: FunctionSystem, u: Array, p: Array) -> LargeEquilibrium:
    """Damped Newton's method at fixed p, until corrections are small beside the largest state, and each beside its own
    state or rounding: states may have units of their own.
    """
    source = JacobianSource(system)
    u = np.array(u, dtype=float)
    f = system.value(u, p)
    if not np.all(np.isfinite(f)):
        raise NotFiniteError(system.why_not_finite(u, p) or "the equations are not finite at the start")
    history = [float(np.max(np.abs(f)))]
    before, late, widest = np.inf, 0, float(np.abs(u).max())
    for _ in range(BUDGET):
        if history[-1] == 0.0:
            return LargeEquilibrium(system, u, p, source)
        linear = source.at(u, p)
        if linear is not None and linear.mass is not None and len(history) == 1:
            refuse_singular_pencil(linear, system.model.name)
        step = None if linear is None else linear.solve(-f)
        if linear is None or step is None or not np.all(np.isfinite(step)):
            break
        largest = max(float(np.abs(u).max()), float(np.abs(step).max()), 1e-300)
        size = float(np.max(np.abs(step))) / largest
        if size < ACCURATE or (size >= 0.5 * before and before < ACCEPTABLE):
            if late == LATE or _is_settled(linear, u, step):
                return LargeEquilibrium(system, u + step if size < before else u, p, source)
            late += 1
        ahead = partial(_ahead, system, p, linear, u, step)
        enough = np.inf if size < ACCEPTABLE else ACCURATE * largest
        found = longest_part(ahead, float(np.max(np.abs(step))), enough)
        if found is None:
            break
        part, (u, f) = found
        before = size if part == 1.0 else np.inf
        history.append(float(np.max(np.abs(f))))
        widest = max(widest, float(np.abs(u).max()))
        if float(np.abs(u).max()) < VANISHED * widest and not system.value(np.zeros_like(u), p).any():
            return LargeEquilibrium(system, np.zeros_like(u), p, source)  # beside which no correction is small
    advice = system.model.advice(u)
    shown = " -> ".join(f"{r:.1e}" for r in ([*history[:3], *history[-2:]] if len(history) > 5 else history))
    raise NoSolutionError(
        f"no equilibrium found from the start: residual {shown} after {len(history) - 1} Newton steps. Start closer, "
        "give other parameters, or check the Jacobian (matrix-free: the preconditioner); or begin with `start: auto`, "
        f"which simulates the given state to rest{advice and '.'}{advice}"
    )
