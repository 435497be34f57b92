"""Curves of extrema from one on a branch of boundary-value solutions."""

from __future__ import annotations

from collections.abc import Sequence

from contin.bvp.boundary_problem import BoundaryProblem
from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_extrema import of_solutions
from contin.transitions.registry import born


@born(BoundaryProblem, "EX", "the extrema in one more parameter", parameters=2)
def extrema(problem: BoundaryProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of extrema of the same column."""
    return [of_solutions(problem, point, parameters)]
