"""Double zero eigenvalues on curves of branch points, where other curves cross them and are singular.

Folds on an invariant plane cross the curve on which the plane is left (a saddle-node and a transcritical bifurcation
at once); Hopf curves end on the curve on which two equilibria pass through each other, for want of a parameter that
makes them vanish. Defining systems of BT on those curves have two tangents there; that of BT on the curve of branch
points, with its unfolding parameter, is regular. Of maps likewise: R1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Rejected, Verified
from contin.continuation.sample import Sample
from contin.loci.codim2.forms import described
from contin.loci.codim2.functions import critical_indices, function_of
from contin.loci.codim2.matrices import eigenvalues
from contin.loci.codim2.solving import RESIDUAL_LIMIT, solve
from contin.loci.tolerances import ILL_CONDITIONED

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

UNFORCED = 1e-8  # an unfolding parameter above this is not zero
APART = 1e-3  # scaled distance from where it was suspected: two curves that cross are solved to the root of rounding


@dataclass(frozen=True, eq=False)
class BranchPoints:
    """The curve of branch points next to (u, p): its problem and a point of it, from which Newton starts."""

    problem: CurveOfPoints
    start: Array

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        return np.asarray(self.problem.initial_scale(z, bounds))


def branch_points_next_to(problem: CurveOfPoints, u: Array, p: Array) -> BranchPoints:
    """That curve, in the same parameters as `problem`, with borders made at (u, p)."""
    other = problem.of_type("BP", p)
    start = other.curve.place(u, p, 0.0)
    settled = other.curve.settled(start, other.initial_scale(start, problem.first_bounds))
    return BranchPoints(replace(other, curve=settled), start)


def on_branch_points(problem: CurveOfPoints, type_: str, u: Array, z: Array) -> Verified | None:
    """The double zero (BT, R1) next to states u and the parameters of z, as a point of the curve `problem`.

    None where the curve of branch points has none there.
    """
    branching = branch_points_next_to(problem, u, problem.curve.full_parameters(z))
    other, start = branching.problem, branching.start
    scale = branching.initial_scale(start, problem.first_bounds)
    function = function_of(other, type_, _sample(start))
    solved = None if isinstance(function, Rejected) else solve(other, function, _sample(start), scale)
    if solved is None or not solved.residual <= RESIDUAL_LIMIT or not solved.error <= ILL_CONDITIONED:
        return None
    found = solved.y * scale
    moved = ((found - start) / scale)[other.identifying]
    if not abs(found[-3]) <= UNFORCED or not float(np.linalg.norm(moved)) <= APART:
        return None
    values = eigenvalues(other, found)
    critical = critical_indices(other, type_, found, values) or []
    others = np.delete(values, critical)
    unstable = int(np.sum(np.abs(others) > 1.0 if type_ == "R1" else others.real > 0.0))
    error = solved.error * float(scale[-1]) + 0.5 * np.finfo(float).eps * abs(float(found[-1]))
    point = Verified(type_, found, solved.residual, error, values, unstable)
    point = described(other, point, values[critical], scale)
    if problem.locus == "LP":
        here = problem.curve.place(found[: problem.n], problem.curve.full_parameters(found))
    else:  # the vectors of the pair are those nearby
        here = z.copy()
        here[: problem.n], here[-2:] = found[: problem.n], found[-2:]
        here[-3] = 1.0 if type_ == "R1" else 0.0  # cos(theta), kappa
    return replace(point, z=here, vectors={**point.vectors, "crossed": True})


def _sample(z: Array) -> Sample:
    return Sample(z, np.zeros(len(z)), np.zeros(1), 0, np.zeros(1, complex))
