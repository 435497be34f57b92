"""Curves of extrema from one on a family of periodic orbits by collocation."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_extrema import of_solutions
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.transitions.registry import born


@born(OrbitProblem, "EX", "the extrema in one more parameter", parameters=2)
def extrema(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of extrema of the same column."""
    return [of_solutions(problem, point, parameters)]
