"""Where curves of special orbits start: at a labelled LPC, PD, NS or BPC of a family, and where two curves meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.loci.start import indices
from contin.problems.orbits.loci.beside import folds_of_doubled, tori_beside
from contin.problems.orbits.loci.curve import OrbitCurve
from contin.problems.orbits.loci.problem import OrbitLocusProblem

CURVES = ("LPC", "PD", "NS", "BPC")
MEETING = {  # curves that pass through a point of codimension two
    "R1": ("LPC", "NS"), "R2": ("PD", "NS"), "LPPD": ("LPC", "PD"), "LPNS": ("LPC", "NS"), "PDNS": ("PD", "NS"),
    "NSNS": ("NS",),
}  # fmt: skip


def loci_of_orbit(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold, period doubling or torus bifurcation of a family of orbits."""
    if point.type == "HOM":
        from contin.problems.orbits.homoclinic.start import connections_of_family

        return connections_of_family(problem, point, parameters)
    if point.type == "UZ" and problem.autonomous:
        return [_same_period(problem, point, parameters)]
    if point.type not in CURVES:
        raise InputError(
            f"{point.branch}.{point.label}: {point.type} has no curve in two parameters; LPC, PD, NS, BPC, HOM have. "
            "With one other parameter the orbit itself is followed from here"
        )
    first, second = indices(problem.system, parameters)
    orbits, orbit = problem.freed(problem.system.parameter_names[first], point.z)
    curve = OrbitCurve(point.type, orbits, second)
    further = float(np.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    z = curve.join(orbit, float(orbits.base[second]), further)
    return [Seed(OrbitLocusProblem(curve), z, parent=Parent(point.branch, point.label))]


def _same_period(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The orbits that have this one's period."""
    from contin.problems.orbits.same_period import PeriodCurve, SamePeriodProblem

    first, second = indices(problem.system, parameters)
    orbits, orbit = problem.freed(problem.system.parameter_names[first], point.z)
    curve = PeriodCurve(orbits, second)
    z = curve.join(orbit, float(orbits.base[second]))
    return Seed(SamePeriodProblem(curve), z, parent=Parent(point.branch, point.label))


def loci_through(problem: OrbitLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curves of other types through a point of a curve of special orbits; its own where there is no other.

    Curves of tori go on, beyond R1 and R2, as curves of neutral saddles.
    """
    if point.type == "GPD":
        return folds_of_doubled(problem, point, parameters)
    first, second = indices(problem.system, parameters)
    name = problem.system.parameter_names[first]
    orbits, orbit = problem.curve.at(point.z).freed(name, problem.curve.orbit(point.z))
    seeds: list[Seed] = []
    for type_ in meeting(point.type, problem.locus):
        if type_ == "NS" and problem.locus != "NS":
            seeds += tori_beside(problem, point, parameters)
            continue
        curve = OrbitCurve(type_, orbits, second)
        z = curve.join(orbit, float(orbits.base[second]), further_through(problem, point, type_))
        seeds.append(Seed(OrbitLocusProblem(curve), z, parent=Parent(point.branch, point.label)))
    return seeds


def meeting(point: str, locus: str) -> list[str]:
    """The types of the curves through a point of codimension two, but for the one it lies on if there are others."""
    others = [t for t in MEETING.get(point, ()) if t != locus]
    return others if others and point != "NSNS" else [locus]


def further_through(problem: Any, point: SpecialPoint, type_: str) -> float:
    """cos theta of the curve of tori through the point; 0 for other types."""
    if type_ != "NS":
        return 0.0
    if point.type == "NSNS":
        pairs = [v for v in problem.others(np.asarray(point.eigenvalues), point.z) if v.imag > 0.0]
        if pairs:
            nearest = min(pairs, key=lambda v: abs(abs(v) - 1.0))
            return float(nearest.real / abs(nearest))
    return float(problem.curve.further(point.z))
