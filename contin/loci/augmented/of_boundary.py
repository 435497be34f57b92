"""Curves of folds and branch points of boundary-value problems, and of points where these are degenerate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.boundary import BoundaryBase
from contin.loci.augmented.degenerate_solutions import scalar
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.meshed import MeshedUnfolding
from contin.loci.augmented.of_points import places

NONE = np.zeros(0)


@dataclass(frozen=True)
class Degenerate:
    """What vanishes at a CP of folds or a DP of branch points (`boundary_degeneracies`)."""

    base: BoundaryBase
    type: str

    @property
    def text(self) -> str:
        return f"{self.base.type} with the condition of {self.type}"

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        return scalar(self.base.settled(z, scale), self.type, z)


def boundary_base(
    problem: BoundaryProblem, z: Array, type_: str, parameters: Sequence[str], kind: str = "", scale: Array = NONE
) -> BoundaryBase:
    """The equations through a solution z, with these parameters varying.

    kind : of branch points.  scale : the metric of the branch on which z was found, if it was on one.
    """
    base = problem.base.copy()
    base[problem.active] = z[-1]
    taken = [name for name in parameters if name in problem.two.free]
    if taken:
        raise InputError(f"{taken[0]} is solved for (`free`), and cannot vary too")
    found = tuple(places(problem.two.parameters, parameters))
    usual = problem.sizes(z, scale) if scale.size == z.size else NONE
    return BoundaryBase(replace(problem, base=base, active=found[0], spaces={}), found, type_, kind=kind, usual=usual)


def start(base: BoundaryBase, z: Array) -> Array:
    """z of a curve from that of a solution."""
    values = base.problem.base[list(base.places)][::-1]
    return np.concatenate([z[:-1], np.zeros(base.extra), values])


def curve_of(problem: BoundaryProblem, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve of folds or branch points through one in two parameters; of generic branch points in three."""
    z, type_, parent = point.z, point.type, Parent.of(point)
    base = boundary_base(problem, z, type_, parameters, str(point.normal_form.get("kind", "")), point.scale)
    held = (MeshedUnfolding(base),) if len(parameters) == 3 else ()
    curve = AdaptiveCurve(base, held, type_, tuple(parameters), problem.two.free)
    return Seed(curve, start(base, z), parent=parent)


def degenerate(curve: AdaptiveCurve, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve of cusps through one on a curve of folds, of DP through one on a curve of branch points; three vary."""
    z, type_, problem = curve.base.inner(point.z), point.type, curve.base.at(point.z)
    base = boundary_base(problem, z, curve.type, parameters, curve.base.kind)
    base = replace(base, usual=curve.base.usual)
    held = AdaptiveCurve(base, (Degenerate(base, type_),), type_, tuple(parameters), problem.two.free)
    return Seed(held, start(base, z), parent=Parent.of(point))
