"""The curves through folds and branch points of boundary-value problems: in two parameters, generic BP in three."""

from __future__ import annotations

from collections.abc import Sequence

from contin.bvp.boundary_problem import BoundaryProblem
from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_boundary import curve_of
from contin.transitions.registry import born


@born(BoundaryProblem, "BP", "the curve of such points in three parameters", parameters=3)
@born(BoundaryProblem, "LP BP", "the curve of such points", parameters=2)
def loci_of_solution(problem: BoundaryProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of points of the same type."""
    return [curve_of(problem, point, parameters)]
