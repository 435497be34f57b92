"""The curves in two parameters through special orbits of a family by shooting."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.shooting.contacts import laid_out, touches
from contin.loci.shooting.curve import ShootingCurve
from contin.loci.shooting.grazing import GrazingCurve
from contin.loci.shooting.isoperiodic import ShotPeriodCurve, ShotPeriodProblem
from contin.loci.shooting.shot_locus import ShotLocusProblem
from contin.machine import elementary
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.problems.two_parameters import indices
from contin.transitions.registry import born
from contin.transitions.several_multipliers import refuse_several
from contin.transitions.special_orbits import seed_of


@born(ShootingProblem, "UZ", "the orbits of this period", parameters=2)
def isoperiodic_by_shooting(problem: ShootingProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of orbits of the same period, of autonomous systems."""
    if not problem.autonomous:
        raise InputError(
            f"{point.branch}.{point.label}: UZ of orbits by shooting has no curve in two parameters where the period "
            "is that of the forcing; with one other parameter the orbit itself is followed from here"
        )
    return [seed_of(ShotPeriodCurve, ShotPeriodProblem, problem, point.z, point, parameters)]


@born(ShootingProblem, "LPC PD NS BPC", "the curve of such orbits", parameters=2)
def loci_of_shot_orbit(problem: ShootingProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve through a fold, branch point, period doubling or torus bifurcation of a family of orbits."""
    if point.type == "LPC" and point.normal_form.get("kind") == "nonsmooth":
        return [_touching(problem, point, parameters)]
    if point.type != "BPC":
        refuse_several(point, "its curve in two parameters is not followed")
    further = float(elementary.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    free = problem.free()  # the condition's derivatives are those of directions across the fixed space, too
    return [seed_of(partial(ShootingCurve, point.type), ShotLocusProblem, free, point.z, point, parameters, further)]


def _touching(problem: ShootingProblem, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve of orbits that touch a surface, through a nonsmooth fold."""
    first, second = indices(problem.system, parameters)
    orbits, orbit = problem.freed(problem.system.parameter_names[first], point.z)
    found = laid_out(orbits, orbit, touches(orbits, orbit))
    if found is None or not found[2]:
        raise InputError(
            f"{point.branch}.{point.label}: a nonsmooth fold where no place was found at which the orbit only touches "
            "a switching surface; its curve is not followed"
        )
    whole, orbit, places = found
    curve = GrazingCurve(whole, second, places[0])
    z = curve.join(orbit, float(orbits.base[second]))
    return Seed(ShotLocusProblem(curve), z, parent=Parent.of(point))
