"""Curves in two parameters of bifurcations of large orbits: not made, in words."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.systems.functions.function_problem import DENSE_IN_KERNELS
from contin.transitions.registry import born


@born(LargeOrbitProblem, "LPC PD NS BPC", "nothing yet", parameters=2)
def curve(problem: LargeOrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """InputError: what is missing, and what serves instead."""
    dense = problem.n <= DENSE_IN_KERNELS
    other = "a function with a dense Jacobian has them"
    instead = other if dense else f"locate {point.type} at several {parameters[1]}"
    raise InputError(
        f"{point.branch}.{point.label}: curves in two parameters of {point.type} points are not made for orbits of "
        f"large systems, with a sparse or matrix-free Jacobian ({problem.n} unknowns here): {instead}"
    )
