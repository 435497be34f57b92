"""The curves in two parameters through special orbits of a family of orbits with jumps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.loci.hybrid_orbits import HybridLocus
from contin.problems.hybrid.hybrid_orbits import OF_MAPS, HybridOrbits
from contin.transitions.point_to_locus import loci_of_point
from contin.transitions.registry import born


@born(HybridOrbits, "LPC PD NS BPC", "the curve of such orbits", parameters=2)
def loci_of_hybrid_orbit(problem: HybridOrbits, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of points of this type of the map's fixed points, as orbits."""
    if problem.map.n == 1 and point.type == "NS":
        raise InputError(f"{point.branch}.{point.label}: a map of one state has no tori")
    of_map = replace(point, type=OF_MAPS.get(point.type, point.type))
    found = []
    for seed in loci_of_point(problem.inner, of_map, parameters):
        assert isinstance(seed.problem, LocusProblem)
        found.append(replace(seed, problem=HybridLocus(seed.problem.curve, problem, seed.problem)))
    return found
