"""Where curves by shooting start: at a labelled LPC, PD, NS or BPC of a family, and where two curves meet."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.loci.start import indices
from contin.problems.orbits.loci.start import CURVES, seed_of, seeds_through
from contin.problems.shooting.loci.curve import ShootingCurve
from contin.problems.shooting.loci.grazing import GrazingCurve
from contin.problems.shooting.loci.problem import ShotLocusProblem
from contin.problems.shooting.loci.same_period import ShotPeriodCurve, ShotPeriodProblem
from contin.problems.shooting.loci.touching import laid_out, touches


def loci_of_orbit(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold, branch point, period doubling or torus bifurcation of a family."""
    name = f"{point.branch}.{point.label}"
    if point.type == "UZ" and problem.autonomous:
        return [seed_of(ShotPeriodCurve, ShotPeriodProblem, problem, point.z, point, parameters)]
    if point.type not in CURVES:
        raise InputError(
            f"{name}: {point.type} of orbits by shooting has no curve in two parameters; LPC, PD, NS, BPC have. "
            "With one other parameter the orbit itself is followed from here"
        )
    if point.type == "LPC" and point.normal_form.get("kind") == "nonsmooth":
        return [_touching(problem, point, parameters)]
    further = float(elementary.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    return [seed_of(partial(ShootingCurve, point.type), ShotLocusProblem, problem, point.z, point, parameters, further)]


def loci_through(problem: ShotLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curves of other types through a point of a curve; its own where there is no other."""
    return seeds_through(ShootingCurve, ShotLocusProblem, problem, point, parameters)


def _touching(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
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
    return Seed(ShotLocusProblem(curve), z, parent=Parent(point.branch, point.label))
