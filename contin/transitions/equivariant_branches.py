"""Branch points of a state that a declared rotation keeps, where states that it moves branch off.

There eigenvalues vanish in pairs (q and its image under the rotation), and with every solution all its rotated copies
branch off: Newton's matrix is singular on the whole branch, except in the frame that turns with the state. So a point
at a finite distance s is solved for, with the rate of rotation and the parameter unknown,

    f(u, p) = rate G u,    b = 0 of the frame's pair (a, b),    <q, (u - u0)/scale> = s,

which is regular down to s = 0 (the equivariant branching lemma: Golubitsky, Stewart and Schaeffer, Singularities and
Groups in Bifurcation Theory II, ch. XIII.3, for the kernel's directions up to the rotation), and the branch is followed
from there in the frame, away from the branch point.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.linalg.newton import Rules, by_steps
from contin.lowering import compile_system
from contin.model.kept import kept_with
from contin.problems.equilibria.branching.rotated import turning_kernel
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.symbolic.passes.corotating import corotating, turned_pair

DISTANCES: Final = (1e-3, 1e-2, 1e-4, 0.05)  # s, scaled; the first with a solution at which the parameter is near
FAR: Final = 0.1  # of the range
SOLVED: Final = 1e-12  # last step of Newton's method, in sizes
NEWTON: Final = Rules(settled=SOLVED, stalled=SOLVED, budget=20)


def rotated_branches(problem: EquilibriumProblem, point: SpecialPoint) -> list[Seed] | None:
    """The branch of states that the rotation moves; None where the ordinary way serves."""
    kernel = int(point.vectors.get("kernel", 1))
    turning = turning_kernel(problem, point.z, point.scale[:-1], kernel)
    if turning is None:
        return None
    model, generator, basis = turning.model, turning.generator, turning.basis
    where = f"{point.branch}.{point.label}"
    if kernel > 2:
        raise InputError(
            f"{where}: {kernel // 2} pairs of eigenvalues vanish together at a state that the declared rotation keeps; "
            "which combinations of them branch off is not computed. Start beside the point, from a simulation"
        )
    a, b = (model.state_names.index(name) for name in turned_pair(model)[:2])
    # a combination of the two with b = 0, a > 0
    q = basis @ np.array([basis[b, 1], -basis[b, 0]])
    if abs(q[a]) <= 1e-6 * float(np.linalg.norm(q)):
        raise InputError(
            f"{where}: the branch does not move {model.state_names[a]}, the first state that the rotation turns: name "
            "the states that move first in `rotation`"
        )
    q = q / float(np.linalg.norm(q)) * np.sign(q[a])
    z = _on_branch(problem, point, generator, q, b)
    if z is None:
        raise InputError(f"{where}: no branch of states that turn was found beside it")
    framed = kept_with(problem.system, "corotating system", lambda: compile_system(corotating(model)))
    fresh = replace(problem, system=framed)
    rising = float(z[-1] - point.z[-1])
    arms = (-1, 1) if rising == 0.0 else (1,) if rising > 0.0 else (-1,)
    return [Seed(fresh, z, arms=arms, parent=Parent.of(point))]


def _on_branch(problem: EquilibriumProblem, point: SpecialPoint, generator: Array, q: Array, b: int) -> Array | None:
    """A point (n + 1,) of the branch along the scaled direction q."""
    for distance in DISTANCES:
        z = _solved(problem, point, generator, q, b, distance)
        if z is not None and abs(float(z[-1] - point.z[-1])) < FAR * float(point.scale[-1]):
            return z
    return None


def _solved(
    problem: EquilibriumProblem, point: SpecialPoint, generator: Array, q: Array, b: int, distance: float
) -> Array | None:
    """Newton's method for (u, rate, p), in scaled unknowns, from the tangent."""
    n, sizes, width = problem.n, point.scale[:-1], float(point.scale[-1])
    start = point.z.copy()
    start[:-1] += distance * sizes * q
    units = np.concatenate([sizes, [1.0, width]])

    def step(x: Array) -> Array | None:
        z, rate = np.append(x[:n], x[-1]), x[n]
        f, jacobian = problem.system.jacobian(z[:-1], problem.full_parameters(z))
        matrix = np.zeros((n + 2, n + 2))
        matrix[:n, :n] = (jacobian[:, :n] - rate * generator) * sizes[None, :] / sizes[:, None]
        matrix[:n, n] = -(generator @ z[:-1]) / sizes
        matrix[:n, n + 1] = jacobian[:, n + problem.active] * width / sizes
        matrix[n, b] = 1.0
        matrix[n + 1, :n] = q
        moved = (z[:-1] - point.z[:-1]) / sizes
        residual = np.concatenate([(f - rate * (generator @ z[:-1])) / sizes, [z[b] / sizes[b], q @ moved - distance]])
        if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(residual))):
            return None
        return np.asarray(-np.linalg.lstsq(matrix, residual, rcond=None)[0])

    found = by_steps(step, np.insert(start, n, 0.0), units, NEWTON)
    if found is None:
        return None
    z = np.delete(found.at, n)
    z[:-1] = np.where(np.abs(z[:-1]) > SOLVED * sizes, z[:-1], 0.0)  # rounding is no size of a state
    return z
