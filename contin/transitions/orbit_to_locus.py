"""The curves in two parameters through special orbits of a family by collocation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.orbits.isoperiodic import PeriodCurve, SamePeriodProblem
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.machine import elementary
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.special_orbits.curve import OrbitCurve
from contin.transitions.registry import born
from contin.transitions.several_multipliers import refuse_several
from contin.transitions.special_orbits import seed_of


@born(OrbitProblem, "UZ", "the orbits of this period", parameters=2)
def isoperiodic(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of orbits of the same period, of autonomous systems."""
    if not problem.autonomous:
        raise InputError(
            f"{point.branch}.{point.label}: UZ has no curve in two parameters where the period is that of the forcing"
        )
    return [seed_of(PeriodCurve, SamePeriodProblem, problem, point.z, point, parameters)]


@born(OrbitProblem, "LPC PD NS BPC", "the curve of such orbits", parameters=2)
def loci_of_orbit(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve through a fold, branch point, period doubling or torus bifurcation of a family of orbits."""
    refuse_several(point, "its curve in two parameters is not followed")
    further = float(elementary.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    return [seed_of(partial(OrbitCurve, point.type), OrbitLocusProblem, problem, point.z, point, parameters, further)]
