"""The curves in two parameters of folds, branch points, period doublings and torus bifurcations of large orbits."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.of_large_orbits import curve_of
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.transitions.registry import born
from contin.transitions.several_multipliers import refuse_several


@born(LargeOrbitProblem, "LPC PD NS BPC", "the curve of such orbits", parameters=2)
def loci_of_large_orbit(problem: LargeOrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of orbits of the same type."""
    refuse_several(point, "its curve in two parameters is not followed")
    return [curve_of(problem, point.z, point.type, parameters, Parent.of(point))]
