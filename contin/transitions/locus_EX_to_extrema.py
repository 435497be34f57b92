"""Curves of extrema from one on a curve of special points, or of extrema: successive extremum continuation."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.of_extrema import of_extrema, of_locus
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.transitions.registry import born


@born(LocusProblem, "EX", "the extrema in one more parameter", parameters=3)
def extrema_of_locus(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of extrema of the same column on curves of special points: isola centres."""
    return [of_locus(problem, point, parameters)]


@born(AugmentedCurve, "EX", "the extrema in one more parameter", parameters=3)
def extrema_of_extrema(problem: AugmentedCurve, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the next curve of extrema."""
    return [of_extrema(problem, point, parameters)]


for _more in (4, 5, 6):
    born(AugmentedCurve, "EX", "the extrema in one more parameter", parameters=_more)(extrema_of_extrema)
