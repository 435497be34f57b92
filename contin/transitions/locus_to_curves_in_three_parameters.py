"""The curves in three parameters through a point of codimension two on a curve of equilibria."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.of_points import of_codimension_two
from contin.loci.augmented.points import PointBase
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.machine import elementary
from contin.transitions.registry import born


@born(LocusProblem, "CP BT GH ZH HH", "the curve of such points in three parameters", parameters=3)
def in_three_parameters(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of points of the same type."""
    if problem.system.kind == "map":
        raise InputError(f"{point.branch}.{point.label}: curves in three parameters are those of flows")
    curve = problem.curve
    u, p = point.z[: problem.n], curve.full_parameters(point.z)
    kappa = 0.0
    if point.type in ("GH", "ZH", "HH"):
        pairs = [v.imag for v in point.vectors["critical"] if v.imag > 0.0]
        kappa = elementary.square(float(max(pairs)))
    parent = Parent.of(point)
    return [of_codimension_two(problem, point.type, u, p, kappa, parameters, parent)]


@born(AugmentedCurve, "CP BT GH ZH HH", "the curve of such points in three parameters", parameters=3)
def of_conditioned(problem: AugmentedCurve, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The same from a curve under conditions, which the seed does not hold."""
    if not isinstance(problem.base, PointBase):
        raise InputError(f"{point.branch}.{point.label}: such points are followed for equilibria alone")
    return in_three_parameters(problem.base.problem, point, parameters)
