"""From a boundary equilibrium to the pseudo-equilibria that slide on its surface, and from those to the other side."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, cast

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.lowering import compile_system
from contin.lowering.sliding import sliding_model
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.surfaces.jumps import jumps_of
from contin.problems.surfaces.sliding import Sliding
from contin.transitions.registry import Explored, born

FASTER: Final = 4.0  # the normal rate beside the largest eigenvalue at the point
STEP: Final = 1e-6  # scaled, along the new branch
DIGITS: Final = 3  # of the normal rate
NARROW: Final = 1e-2  # scaled width of a sliding motion, of which the branch is taken up at
PART: Final = 0.1  # this part


@born(EquilibriumProblem, "BE", "the pseudo-equilibria", explored=Explored(when=lambda problem: not problem.is_map))
def switched(problem: EquilibriumProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The branch that goes on at a boundary equilibrium.

    Raises InputError where several surfaces meet: the sliding motion is not defined by the two fields of one.
    """
    if problem.is_map:
        raise InputError(f"{point.branch}.{point.label}: nothing slides on a surface of a map; start beyond it")
    if point.vectors.get("surfaces", 1) > 1:
        raise _undefined(point, str(point.normal_form["surface"]))
    problem = problem if parameter == problem.parameters[0] else problem.with_active(parameter, point.z)
    upper = bool(point.vectors["upper"])
    if problem.sliding is not None:
        if not point.vectors["own"]:
            raise _undefined(point, f"{problem.sliding.jump.surface.text} and {point.normal_form['surface']}")
        return [_beside(problem, point, upper)]
    return [_sliding(problem, point, upper)]


def _undefined(point: SpecialPoint, surfaces: str) -> InputError:
    return InputError(
        f"{point.branch}.{point.label}: two surfaces meet here ({surfaces}); the Filippov field on both is not defined"
    )


def _sliding(problem: EquilibriumProblem, point: SpecialPoint, upper: bool) -> Seed:
    n, z = problem.n, point.z
    jump = jumps_of(problem.system)[int(point.vectors["jump"])]
    p = problem.full_parameters(z)
    difference = jump.upper.value(z[:n], p) - jump.lower.value(z[:n], p)
    normal = jump.height(z[:n], p)[1][:n]
    crossing = abs(float(normal @ difference))
    if not crossing > 0.0:
        raise InputError(f"{point.branch}.{point.label}: both fields are tangent to the surface; nothing slides there")
    largest = float(np.abs(np.asarray(point.eigenvalues)).max(initial=0.0)) or crossing
    rate = float(f"{FASTER * largest / crossing:.{DIGITS}g}")
    system = compile_system(sliding_model(jump.model, jump.surface, rate), regular=True)
    sliding = Sliding(problem, jump)
    beyond = replace(problem, system=system, sliding=sliding)
    along = _tangent(beyond, z, point.scale)
    step = STEP * along * point.scale
    low, high = sliding.weights(beyond, np.stack([z - step, z + step]))
    if not (np.isfinite(low) and np.isfinite(high)) or low == high:
        raise InputError(f"{point.branch}.{point.label}: the sliding motion is not defined beside this point")
    inward = (high < low) if upper else (high > low)
    across = 2.0 * STEP / abs(high - low)  # scaled distance to the other end of the sliding motion, about
    seed = _seed(beyond, point, along if inward else -along)
    return replace(seed, reach=PART * across) if across < NARROW else seed


def _beside(problem: EquilibriumProblem, point: SpecialPoint, upper: bool) -> Seed:
    assert problem.sliding is not None
    jump, n, z = problem.sliding.jump, problem.n, point.z
    regular = replace(cast("EquilibriumProblem", problem.sliding.regular), base=problem.base, active=problem.active)
    along = _tangent(replace(regular, system=jump.side(upper)), z, point.scale)
    slope = jump.height(z[:n], problem.full_parameters(z))[1][[*range(n), n + problem.active]]
    rises = float(slope @ (along * point.scale)) > 0.0
    return _seed(regular, point, along if rises == upper else -along)


def _tangent(problem: EquilibriumProblem, z: Array, scale: Array) -> Array:
    _, matrix = problem.linearise(z)
    return np.asarray(np.linalg.svd(matrix * scale / scale[:-1, None])[2][-1])


def _seed(problem: EquilibriumProblem, point: SpecialPoint, direction: Array) -> Seed:
    parent = Parent.of(point)
    return Seed(problem, point.z, direction, None, point.scale, (1,), parent)
