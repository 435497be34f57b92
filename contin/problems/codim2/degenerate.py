"""DP: points of a curve of branch points where its leading coefficient vanishes, and where a curve of folds touches it.

Forced branch points are pitchforks along the whole curve, or transcritical along the whole curve. With w the curve's
own left null vector and v the right one, oriented by adj(F_u) = c v w^T with c > 0, the coefficient is <w, B(v, v)>
(transcritical; even in v) or <w, C(v, v, v) + 3 B(v, h)> with A h = -B(v, v), <v, h> = 0 (pitchfork). Without the usual
division by <w, v> both are smooth through Bogdanov-Takens points, where that product vanishes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Frame, Sample, Verified
from contin.normalforms.branching import branch_point
from contin.problems.codim2.forms import branching_form, jet_at
from contin.problems.codim2.functions import function_of, own_critical, scaled_matrix
from contin.problems.codim2.untold import untold
from contin.problems.loci.curves import curve_of

if TYPE_CHECKING:
    from contin.problems.loci.problem import LocusProblem

ACROSS = 1e-3  # relative slopes in both parameters below this at a cusp: perhaps no cusp, but the end of a fold curve
EVEN = 1e-6  # relative size of <w, B(v, v)> above which a point is no pitchfork, where nothing else decides
NEARLY = 0.05  # the same where the cusp was not solved to full accuracy, as near a pitchfork's DP
APART = 1e-4  # scaled distance of that end from the cusp that was found for it
BESIDE = 0.1  # the same where that was not solved to full accuracy
ASIDE = 0.02  # scaled distance along the branch points at which their kind is decided
UNFORCED = 1e-8  # an unfolding parameter above this is not zero


def coefficient(problem: LocusProblem, z: Array, v: Array, w: Array) -> float:
    """The coefficient for null vectors in scaled states, relative to the size of f_u."""
    curve, n = problem.curve, problem.n
    d, u, p = curve.sizes, z[:n], curve.full_parameters(z)

    def form(*directions: Array) -> Array:
        wide = np.zeros((len(directions), n + len(p)))
        wide[:, :n] = np.array(directions) * d
        return np.asarray(curve.system.derivative(u, p, *wide) / d)

    matrix = np.asarray(curve.matrix(z) * d / d[:, None])
    size = max(float(np.linalg.norm(matrix)), 1e-300) if n > 1 else 1.0
    quadratic = form(v, v)
    even = abs(float(w @ quadratic)) <= EVEN * float(np.linalg.norm(w) * np.linalg.norm(quadratic))
    if (kind(problem, z) or ("pitchfork" if even else "transcritical")) != "pitchfork":
        return float(w @ quadratic) / size
    shift = np.eye(n) if curve.system.kind == "map" else 0.0
    bordered = np.block([[matrix - shift, w[:, None]], [v[None, :], np.zeros((1, 1))]])
    try:
        h = np.linalg.solve(bordered, np.append(-quadratic, 0.0))[:n]
    except np.linalg.LinAlgError as error:
        return untold(problem, "DP", error)
    return float(w @ (form(v, v, v) + 3.0 * form(v, h))) / size


def kind(problem: LocusProblem, z: Array) -> str:
    """Pitchfork or not, decided where it is first asked: at a DP the coefficients no longer tell.

    Empty, and asked again at the next point, at a Bogdanov-Takens point, where the reduced equation has two unknowns.
    """
    if "kind" not in problem.memory:
        try:
            form = branch_point(jet_at(problem, z, (problem.curve.first,)))
        except ZeroDivisionError:  # at a double zero; asked again at the next point
            return ""
        problem.memory["kind"] = str(form.coefficients["kind"])
    return str(problem.memory["kind"])


def test(problem: LocusProblem, z: Array) -> float:
    """The coefficient at a point of the curve, with its continuous sign."""
    from contin.problems.codim2.monitors import null_pair

    shift = np.eye(problem.n) if problem.system.kind == "map" else 0.0
    v, w = null_pair(scaled_matrix(problem, z) - shift, np.zeros(problem.n))
    own = problem.curve.left_vector(z) * problem.curve.sizes
    if float(w @ own) < 0.0:
        v, w = -v, -w
    return coefficient(problem, z, v, w)


def at_fold(problem: LocusProblem, z: Array, exact: bool, frame: Frame) -> Verified | None:
    """The DP that a supposed cusp z on a curve of folds is where neither parameter unfolds it: F_p = 0 along w.

    Folds of the branches that cross at branch points end there: the two curves meet, and the defining system of folds
    is singular. The point is solved for on the curve of branch points instead; None where it is a cusp. `exact`: the
    defining system of a cusp was solved to its full accuracy, which near a DP it cannot be.
    """
    curve, n, d = problem.curve, problem.n, problem.curve.sizes
    u, p = z[:n], curve.full_parameters(z)
    if _slope(problem, u, p, frame) > (ACROSS if exact else NEARLY):
        return None
    branching = _branch_points(problem, u, p)
    scale = branching.initial_scale(branching.start, problem.first_bounds)
    solved = _solved(branching, scale)
    if solved is None:
        return None
    found, residual, error = solved
    moved = np.concatenate([(found[:n] - u) / d, (found[-2:] - z[-2:]) / frame.scale[-2:]])
    if abs(found[-3]) > UNFORCED or np.linalg.norm(moved) > (APART if exact else BESIDE):
        return None
    return _verified(problem, branching, found, residual, error * float(scale[-1]))


def _slope(problem: LocusProblem, u: Array, p: Array, frame: Frame) -> float:
    """The larger of the slopes <w, F_p> in both parameters, relative to the size of F_u."""
    curve, n, d = problem.curve, problem.n, problem.curve.sizes
    full = curve.system.jacobian(u, p)[1]
    matrix = full[:, :n] * d / d[:, None]
    if curve.system.kind == "map":
        matrix = matrix - np.eye(n)
    w = np.linalg.svd(matrix)[0][:, -1]
    slopes = full[:, [n + curve.first, n + curve.second]] * frame.scale[[-1, -2]] / d[:, None]
    return float(np.abs(w @ slopes).max() / max(float(np.linalg.norm(slopes)), float(np.linalg.norm(matrix))))


@dataclass(frozen=True, eq=False)
class _BranchPoints:
    """The curve of branch points next to (u, p): its problem and a point of it, from which Newton starts."""

    problem: Any
    start: Array

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        return np.asarray(self.problem.initial_scale(z, bounds))


def _branch_points(problem: LocusProblem, u: Array, p: Array) -> _BranchPoints:
    own = problem.curve
    curve = curve_of("BP", problem.system, p, own.first, own.second, own.sizes)
    other: Any = replace(problem, curve=curve, memory={})
    start = curve.place(u, p, 0.0)
    curve.settle(start)
    return _BranchPoints(other, start)


def _solved(branching: _BranchPoints, scale: Array) -> tuple[Array, float, float] | None:
    """(z, residual, error) of the DP on the curve of branch points; its kind is that of points further along."""
    from contin.problems.codim2 import events

    other = branching.problem
    for index, side in ((-2, 1.0), (-2, -1.0), (-1, 1.0), (-1, -1.0)):
        z = other.at_unknown(index, branching.start, branching.start[index] + side * ASIDE * scale[index], scale)
        if z is not None and abs(z[-3]) < UNFORCED:
            kind(other, z)
            break
    near = Sample(branching.start, np.zeros(len(scale)), np.zeros(1), 0, np.zeros(1, complex))
    function = function_of(other, "DP", near)
    solved = None if isinstance(function, str) else events.solve(other, function, near, scale)
    if solved is None or solved.residual > events.RESIDUAL_LIMIT or solved.error > events.ILL_CONDITIONED:
        return None
    return solved.y * scale, solved.residual, solved.error


def _verified(problem: LocusProblem, branching: _BranchPoints, found: Array, residual: float, error: float) -> Verified:
    from contin.problems.codim2 import events
    z = problem.curve.place(found[: problem.n], problem.curve.full_parameters(found))
    if kind(branching.problem, found) == "pitchfork":
        problem.memory.setdefault("mirrors", []).append(z)
    values = events.eigenvalues(problem, z)
    others = np.delete(values, own_critical(problem, z, values))
    unstable = int(np.sum(np.abs(others) > 1.0 if problem.system.kind == "map" else others.real > 0.0))
    form = branching_form(branching.problem, found)
    return Verified("DP", z, residual, error, values, unstable, dict(form.coefficients), dict(form.vectors))


def is_mirror(problem: LocusProblem, z: Array, scale: Array) -> bool:
    """True at a DP of pitchforks on a curve of folds: from there on the curve is its own mirror image."""
    seen = problem.identifying
    return any(float(np.linalg.norm(((z - m) / scale)[seen])) < APART for m in problem.memory.get("mirrors", ()))
