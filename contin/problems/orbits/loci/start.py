"""Where curves of special orbits start: at a labelled LPC, PD, NS or BPC of a family, and where two curves meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.machine import elementary
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
        from contin.problems.orbits.same_period import PeriodCurve, SamePeriodProblem

        return [seed_of(PeriodCurve, SamePeriodProblem, problem, point.z, point, parameters)]
    if point.type not in CURVES:
        raise InputError(
            f"{point.branch}.{point.label}: {point.type} has no curve in two parameters; LPC, PD, NS, BPC, HOM have. "
            "With one other parameter the orbit itself is followed from here"
        )
    further = float(elementary.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    return [seed_of(partial(OrbitCurve, point.type), OrbitLocusProblem, problem, point.z, point, parameters, further)]


def seed_of(
    curve_of: Callable[[Any, int], Any], problem_of: Callable[[Any], Any], orbits: Any, orbit: Array,
    point: SpecialPoint, parameters: Sequence[str], further: float = 0.0,
) -> Seed:  # fmt: skip
    """The curve in two parameters through an orbit.

    curve_of : the curve's equations, from the orbits in the first parameter and the index of the second one.
    problem_of : the problem of such a curve.
    """
    first, second = indices(orbits.system, parameters)
    orbits, orbit = orbits.freed(orbits.system.parameter_names[first], orbit)
    curve = curve_of(orbits, second)
    z = curve.join(orbit, float(orbits.base[second]), further)
    return Seed(problem_of(curve), z, parent=Parent(point.branch, point.label))


def loci_through(problem: OrbitLocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curves of other types through a point of a curve of special orbits; its own where there is no other.

    Curves of tori go on, beyond R1 and R2, as curves of neutral saddles.
    """
    return seeds_through(OrbitCurve, OrbitLocusProblem, problem, point, parameters)


def seeds_through(
    curve_of: Callable[[str, Any, int], Any], problem_of: Callable[[Any], Any], problem: Any, point: SpecialPoint,
    parameters: Sequence[str],
) -> list[Seed]:  # fmt: skip
    """As `loci_through`; `curve_of` takes the type of the curve first, else as `seed_of`."""
    if point.type == "GPD":
        return folds_of_doubled(problem, point, parameters)
    orbits, orbit = problem.curve.at(point.z), problem.curve.orbit(point.z)
    seeds: list[Seed] = []
    for type_ in meeting(point.type, problem.locus):
        if type_ == "NS" and problem.locus != "NS":
            seeds += tori_beside(problem, point, parameters)
        else:
            further = further_through(problem, point, type_)
            seeds.append(seed_of(partial(curve_of, type_), problem_of, orbits, orbit, point, parameters, further))
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
