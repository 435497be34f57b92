"""The curve in three parameters of branch points of cycles that nothing forces."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_orbits import branch_points
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.transitions.registry import born


@born(OrbitProblem, "BPC", "the curve of such orbits in three parameters", parameters=3)
def branch_points_of_cycles(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Branch points in the first parameter."""
    return [branch_points(problem, point.z, parameters, Parent.of(point))]
