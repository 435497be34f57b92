"""Curves of extrema from one on a branch of equilibria, fixed points or algebraic equations."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_extrema import of_solutions
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.transitions.registry import born


@born(EquilibriumProblem, "EX", "the extrema in one more parameter", parameters=2)
def extrema(problem: EquilibriumProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of extrema of the same column."""
    return [of_solutions(problem, point, parameters)]
