"""Curves of special orbits of large systems through a point where two of them meet."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.large_orbit_curve import LargeOrbitCurve
from contin.loci.augmented.of_large_orbits import curve_of
from contin.transitions.registry import born
from contin.transitions.special_orbits import meeting


@born(LargeOrbitCurve, "", "the other curves through it", parameters=2)
def loci_through(problem: LargeOrbitCurve, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Those of other types; its own where there is no other."""
    where = f"{point.branch}.{point.label}"
    if point.type == "NSNS":
        raise InputError(
            f"{where}: which of the two pairs a curve follows cannot be chosen here, for orbits of large systems: "
            "start the curve of the other one from its own NS point"
        )
    family, inner, parent = problem.base.at(point.z), problem.base.inner(point.z), Parent.of(point)
    return [curve_of(family, inner, type_, parameters, parent) for type_ in meeting(point.type, problem.locus)]
