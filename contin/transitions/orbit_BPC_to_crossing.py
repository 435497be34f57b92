"""The families that cross a family of periodic orbits at a branch point."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.normal_forms.multiple_branch_point import crossing_tangents
from contin.problems.orbits.symmetric.symmetry import halves_alike
from contin.transitions.orbits_at_point import along_own_parameter, unstable_count
from contin.transitions.registry import Explored, born

CROSSING: Final = Explored(generation=True, crowded=True)


@born(OrbitProblem, "BPC", "the family that crosses", explored=CROSSING)
def crossing(problem: OrbitProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the families that cross, each along its own tangent."""
    along_own_parameter(problem, point, parameter)
    several = crossing_tangents(problem, point.z, point.scale, point.eigenvalues)
    if several:
        return [_along(problem, point, direction) for direction in several]
    own = point.tangent / point.scale
    own = own / np.linalg.norm(own)
    tangents = [t for t in problem.tangents(point.z, point.scale) if abs(float(t @ own)) < 0.999]
    if not tangents:
        raise InputError(f"{point.branch}.{point.label}: no second real family crosses here")
    return [_along(problem, point, min(tangents, key=lambda t: abs(float(t @ own))))]


def _along(problem: OrbitProblem, point: SpecialPoint, direction: Array) -> Seed:
    symmetries = halves_alike(problem, point.z, direction * point.scale)
    halves = (1,) if symmetries else (-1, 1)
    if direction[-1] < 0.0:
        direction = -direction
    return Seed(
        problem, point.z, direction, None, point.scale, halves, Parent.of(point), symmetries,
        measured=(unstable_count(point), point.eigenvalues),
    )  # fmt: skip
