"""The curve in three parameters of branch points that nothing forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.of_points import of_codimension_two
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.transitions.curve_through import seed_of
from contin.transitions.registry import born


@born(EquilibriumProblem, "BP", "the curve of branch points in three parameters", parameters=3)
def branch_points(problem: EquilibriumProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Branch points in the first parameter, where the other two are those of the curve."""
    if int(point.vectors.get("kernel", 1)) > 1:
        raise InputError(f"{point.branch}.{point.label} has a kernel of more than one dimension: no curve is followed")
    p = problem.full_parameters(point.z)
    sizes = point.scale[:-1] if point.scale.size else np.maximum(np.abs(point.z[:-1]), 1e-3)
    parent = Parent.of(point)
    plain = seed_of(
        problem.system, "BP", parameters[:2], point.z[:-1], p, sizes, problem.angle_periods, 0.0, parent
    ).problem
    return [of_codimension_two(plain, "BP", point.z[:-1], p, 0.0, parameters, parent)]  # type: ignore[arg-type]
