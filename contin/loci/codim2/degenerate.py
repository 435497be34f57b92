"""DP: points of a curve of branch points where its leading coefficient vanishes, and where a curve of folds touches it.

Forced branch points are pitchforks along the whole curve, or transcritical along the whole curve. With w the curve's
own left null vector and v the right one, oriented by adj(F_u) = c v w^T with c > 0, the coefficient is <w, B(v, v)>
(transcritical; even in v) or <w, C(v, v, v) + 3 B(v, h)> with A h = -B(v, v), <v, h> = 0 (pitchfork). Without the usual
division by <w, v> both are smooth through Bogdanov-Takens points, where that product vanishes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.loci.codim2.forms import jet_at
from contin.loci.codim2.matrices import null_pair, scaled_matrix
from contin.loci.codim2.uncomputed_tests import untold
from contin.normalforms.branching import branch_point
from contin.normalforms.result import NO_FORM

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

EVEN = 1e-6  # relative size of <w, B(v, v)> above which a point is no pitchfork, where nothing else decides
APART = 1e-4  # scaled distance of that end from the cusp that was found for it


def coefficient(problem: CurveOfPoints, z: Array, v: Array, w: Array) -> float:
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
        return untold(problem, "DP", z, error)
    return float(w @ (form(v, v, v) + 3.0 * form(v, h))) / size


def kind(problem: CurveOfPoints, z: Array) -> str:
    """Pitchfork or not, decided where it is first asked: at a DP the coefficients no longer tell.

    Empty, and asked again at the next point, at a Bogdanov-Takens point, where the reduced equation has two unknowns.
    """
    if "kind" not in problem.memory:
        try:
            form = branch_point(jet_at(problem, z, (problem.curve.first,)))
        except NO_FORM:  # at a double zero; asked again at the next point
            return ""
        problem.memory["kind"] = str(form.coefficients["kind"])
    return str(problem.memory["kind"])


def test(problem: CurveOfPoints, z: Array) -> float:
    """The coefficient at a point of the curve, with its continuous sign."""
    shift = np.eye(problem.n) if problem.system.kind == "map" else 0.0
    v, w = null_pair(scaled_matrix(problem, z) - shift, np.zeros(problem.n))
    own = problem.curve.left_vector(z) * problem.curve.sizes
    if float(w @ own) < 0.0:
        v, w = -v, -w
    return coefficient(problem, z, v, w)


def is_mirror(problem: CurveOfPoints, z: Array, scale: Array) -> bool:
    """True at a DP of pitchforks on a curve of folds: from there on the curve is its own mirror image."""
    seen = problem.identifying
    return any(float(np.linalg.norm(((z - m) / scale)[seen])) < APART for m in problem.memory.get("mirrors", ()))
