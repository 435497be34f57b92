"""Where a curve of folds meets that of branch points: what a cusp of the folds may be instead.

DP, where it touches that curve and ends; a double zero, where folds on an invariant plane cross it (`double_zero`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Rejected, Verified
from contin.continuation.sample import Frame, Sample
from contin.loci.codim2 import degenerate
from contin.loci.codim2.degenerate import APART
from contin.loci.codim2.double_zero import UNFORCED, BranchPoints, branch_points_next_to, on_branch_points
from contin.loci.codim2.forms import branching_form
from contin.loci.codim2.functions import function_of
from contin.loci.codim2.matrices import eigenvalues, own_critical
from contin.loci.codim2.solving import RESIDUAL_LIMIT, solve
from contin.loci.tolerances import ILL_CONDITIONED
from contin.normalforms.result import NO_FORM

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

ACROSS = 1e-3  # relative slopes in both parameters below this at a cusp: perhaps no cusp, but the end of a fold curve
NEARLY = 0.05  # the same where the cusp was not solved to full accuracy, as near a pitchfork's DP
BESIDE = 0.1  # the same where that was not solved to full accuracy
ASIDE = 0.02  # scaled distance along the branch points at which their kind is decided


def at_fold(problem: CurveOfPoints, z: Array, exact: bool, frame: Frame) -> Verified | None:
    """The DP (BT, R1) that a supposed cusp z on a curve of folds is where no parameter unfolds it: F_p = 0 along w.

    Folds of the branches that cross at branch points end there: the two curves meet, and the defining system of folds
    is singular. The point is solved for on the curve of branch points instead; None where it is a cusp. `exact`: the
    defining system of a cusp was solved to its full accuracy, which near a DP it cannot be.
    """
    curve, n, d = problem.curve, problem.n, problem.curve.sizes
    u, p = z[:n], curve.full_parameters(z)
    if _slope(problem, u, p, frame) > (ACROSS if exact else NEARLY):
        return None
    branching = branch_points_next_to(problem, u, p)
    scale = branching.initial_scale(branching.start, problem.first_bounds)
    solved = _solved(branching, scale)
    if solved is None:
        return None
    found, residual, error = solved
    moved = np.concatenate([(found[:n] - u) / d, (found[-2:] - z[-2:]) / frame.scale[-2:]])
    if abs(found[-3]) > UNFORCED or np.linalg.norm(moved) > (APART if exact else BESIDE):
        return None
    try:
        return _verified(problem, branching, found, residual, error * float(scale[-1]))
    except NO_FORM:  # at a double zero, where folds on an invariant plane cross the curve on which it is left
        return on_branch_points(problem, "R1" if curve.system.kind == "map" else "BT", found[:n], found)


def _slope(problem: CurveOfPoints, u: Array, p: Array, frame: Frame) -> float:
    """The larger of the slopes <w, F_p> in both parameters, relative to the size of F_u."""
    curve, n, d = problem.curve, problem.n, problem.curve.sizes
    full = curve.system.jacobian(u, p)[1]
    matrix = full[:, :n] * d / d[:, None]
    if curve.system.kind == "map":
        matrix = matrix - np.eye(n)
    w = np.linalg.svd(matrix)[0][:, -1]
    slopes = full[:, [n + curve.first, n + curve.second]] * frame.scale[[-1, -2]] / d[:, None]
    return float(np.abs(w @ slopes).max() / max(float(np.linalg.norm(slopes)), float(np.linalg.norm(matrix))))


def _solved(branching: BranchPoints, scale: Array) -> tuple[Array, float, float] | None:
    """(z, residual, error) of the DP on the curve of branch points; its kind is that of points further along."""
    other = branching.problem
    for index, side in ((-2, 1.0), (-2, -1.0), (-1, 1.0), (-1, -1.0)):
        z = other.at_unknown(index, branching.start, branching.start[index] + side * ASIDE * scale[index], scale)
        if z is not None and abs(z[-3]) < UNFORCED:
            degenerate.kind(other, z)
            break
    near = Sample(branching.start, np.zeros(len(scale)), np.zeros(1), 0, np.zeros(1, complex))
    function = function_of(other, "DP", near)
    solved = None if isinstance(function, Rejected) else solve(other, function, near, scale)
    if solved is None or solved.residual > RESIDUAL_LIMIT or solved.error > ILL_CONDITIONED:
        return None
    return solved.y * scale, solved.residual, solved.error


def _verified(
    problem: CurveOfPoints, branching: BranchPoints, found: Array, residual: float, error: float
) -> Verified:
    z = problem.curve.place(found[: problem.n], problem.curve.full_parameters(found))
    if degenerate.kind(branching.problem, found) == "pitchfork":
        problem.memory.setdefault("mirrors", []).append(z)
    values = eigenvalues(problem, z)
    others = np.delete(values, own_critical(problem, z, values))
    unstable = int(np.sum(np.abs(others) > 1.0 if problem.system.kind == "map" else others.real > 0.0))
    form = branching_form(branching.problem, found)
    return Verified("DP", z, residual, error, values, unstable, dict(form.coefficients), dict(form.vectors))
