"""The curves in two parameters of folds, period doublings and torus bifurcations of large orbits."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.of_large_orbits import curve_of
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.systems.functions.function_problem import DENSE_IN_KERNELS
from contin.transitions.registry import born
from contin.transitions.several_multipliers import refuse_several


@born(LargeOrbitProblem, "LPC PD NS", "the curve of such orbits", parameters=2)
def loci_of_large_orbit(problem: LargeOrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of orbits of the same type."""
    refuse_several(point, "its curve in two parameters is not followed")
    return [curve_of(problem, point.z, point.type, parameters, Parent.of(point))]


@born(LargeOrbitProblem, "BPC", "nothing yet", parameters=2)
def branch_points(problem: LargeOrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """InputError: what is missing, and what serves instead."""
    dense = problem.n <= DENSE_IN_KERNELS
    instead = "a function with a dense Jacobian has them" if dense else f"locate it at several {parameters[1]}"
    raise InputError(
        f"{point.branch}.{point.label}: curves in two parameters of {point.type} points are not made for orbits of "
        f"large systems, with a sparse or matrix-free Jacobian ({problem.n} unknowns here): {instead}"
    )
