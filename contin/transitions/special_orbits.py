"""Curves of special orbits through a given one, and through points where two such curves meet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.problem import Problem
from contin.continuation.seed import Seed
from contin.problems.two_parameters import indices
from contin.special.table import curves_of_orbits, special_type

if TYPE_CHECKING:
    from contin.loci.orbits.special_orbits import OfSpecialOrbits
    from contin.problems.orbits.family import FamilyOfOrbits

CurveOf = Callable[..., Any]  # (type, orbits, second parameter) -> the equations of a curve
ProblemOf = Callable[..., Problem]


def seed_of(
    curve_of: CurveOf, problem_of: ProblemOf, orbits: FamilyOfOrbits, orbit: Array,
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
    return Seed(problem_of(curve), z, parent=Parent.of(point))


def seeds_through(
    curve_of: CurveOf, problem_of: ProblemOf, problem: OfSpecialOrbits,
    point: SpecialPoint, parameters: Sequence[str],
) -> list[Seed]:  # fmt: skip
    """The curves of other types through a point where two meet; its own where there is no other.

    Curves of tori go on, beyond R1 and R2, as curves of neutral saddles. `curve_of` takes the type of the curve first,
    else as `seed_of`.
    """
    orbits, orbit = problem.curve.at(point.z), problem.curve.orbit(point.z)
    seeds: list[Seed] = []
    for type_ in meeting(point.type, problem.locus):
        further = further_through(problem, point, type_)
        seeds.append(seed_of(partial(curve_of, type_), problem_of, orbits, orbit, point, parameters, further))
    return seeds


def meeting(point: str, locus: str) -> list[str]:
    """The types of the curves through a point of codimension two, but for the one it lies on if there are others."""
    others = [t for t in curves_of_orbits(point) if t != locus]
    return others if others and point != "NSNS" else [locus]


def further_through(problem: OfSpecialOrbits, point: SpecialPoint, type_: str) -> float:
    """cos theta of the curve of tori through the point; 0 for other types."""
    if type_ != "NS":
        return 0.0
    cosine = special_type(point.type).cosine
    if cosine is not None:
        return cosine
    if point.type == "NSNS" or problem.locus != "NS":
        pairs = [v for v in problem.others(np.asarray(point.eigenvalues), point.z) if v.imag > 0.0]
        if pairs:
            nearest = min(pairs, key=lambda v: abs(abs(v) - 1.0))
            return float(nearest.real / abs(nearest))
    return float(problem.curve.further(point.z))
