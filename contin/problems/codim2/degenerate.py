"""DP: points of a curve of branch points where its leading coefficient vanishes, and where a curve of folds touches it.

Forced branch points are pitchforks along the whole curve, or transcritical along the whole curve. With w the curve's
own left null vector and v the right one, oriented by adj(F_u) = c v w^T with c > 0, the coefficient is <w, B(v, v)>
(transcritical; even in v) or <w, C(v, v, v) + 3 B(v, h)> with A h = -B(v, v), <v, h> = 0 (pitchfork). Without the usual
division by <w, v> both are smooth through Bogdanov-Takens points, where that product vanishes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Frame, Sample, Verified

ACROSS = 1e-3  # relative slopes in both parameters below this at a cusp: perhaps no cusp, but the end of a fold curve
APART = 1e-4  # scaled distance of that end from the "cusp" that was found for it


def coefficient(problem: Any, z: Array, v: Array, w: Array) -> float:
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
    if kind(problem, z) != "pitchfork":
        return float(w @ quadratic) / size
    shift = np.eye(n) if curve.system.kind == "map" else 0.0
    bordered = np.block([[matrix - shift, w[:, None]], [v[None, :], np.zeros((1, 1))]])
    try:
        h = np.linalg.solve(bordered, np.append(-quadratic, 0.0))[:n]
    except np.linalg.LinAlgError:
        return 0.0
    return float(w @ (form(v, v, v) + 3.0 * form(v, h))) / size


def kind(problem: Any, z: Array) -> str:
    """Pitchfork or not, decided where it is first asked: at a DP the coefficients no longer tell."""
    if "kind" not in problem.memory:
        from contin.normalforms.branching import branch_point
        from contin.problems.codim2.forms import jet_at

        form = branch_point(jet_at(problem, z, (problem.curve.first,)))
        problem.memory["kind"] = str(form.coefficients["kind"])
    return str(problem.memory["kind"])


def test(problem: Any, z: Array) -> float:
    """The coefficient at a point of the curve, with its continuous sign."""
    from contin.problems.codim2.functions import scaled_matrix
    from contin.problems.codim2.monitors import null_pair

    shift = np.eye(problem.n) if problem.system.kind == "map" else 0.0
    v, w = null_pair(scaled_matrix(problem, z) - shift, np.zeros(problem.n))
    own = problem.curve.left_vector(z) * problem.curve.sizes
    if float(w @ own) < 0.0:
        v, w = -v, -w
    return coefficient(problem, z, v, w)


def at_fold(problem: Any, cusp: Verified, near: Sample, frame: Frame) -> Verified | None:
    """The DP that a supposed cusp on a curve of folds is where neither parameter unfolds it: F_p = 0 along w.

    Folds of the branches that cross at branch points end there: the two curves meet, and the defining system of a cusp
    is singular. The point is solved for on the curve of branch points instead; None where it is a cusp.
    """
    from contin.problems.codim2 import events
    from contin.problems.codim2.functions import function_of
    from contin.problems.loci.start import seed_of

    curve, n = problem.curve, problem.n
    u, p, d = cusp.z[:n], curve.full_parameters(cusp.z), curve.sizes
    full = curve.system.jacobian(u, p)[1]
    matrix = full[:, :n] * d / d[:, None]
    if curve.system.kind == "map":
        matrix = matrix - np.eye(n)
    w = np.linalg.svd(matrix)[0][:, -1]
    widths = frame.scale[[-1, -2]]
    slopes = full[:, [n + curve.first, n + curve.second]] * widths / d[:, None]
    if np.abs(w @ slopes).max() > ACROSS * max(float(np.linalg.norm(slopes)), float(np.linalg.norm(matrix))):
        return None
    names = list(problem.system.parameter_names)
    pair = (names[curve.first], names[curve.second])
    seed = seed_of(problem.system, "BP", pair, u, p, d, problem.state_periods, 0.0, None)
    branching: Any = seed.problem
    branching.curve.settle(seed.z)
    sample = Sample(seed.z, np.zeros(len(seed.z)), np.zeros(1), 0, near.eigenvalues)
    function = function_of(branching, "DP", sample)
    if isinstance(function, str):
        return None
    solved = events.solve(branching, function, sample, branching.initial_scale(seed.z, problem.first_bounds))
    if solved is None or solved.residual > events.RESIDUAL_LIMIT or solved.error > events.ILL_CONDITIONED:
        return None
    scale = branching.initial_scale(seed.z, problem.first_bounds)
    found = solved.y * scale
    moved = np.concatenate([(found[:n] - u) / d, (found[-2:] - cusp.z[-2:]) / frame.scale[-2:]])
    if abs(found[-3]) > events.FORCED or np.linalg.norm(moved) > APART:
        return None
    from contin.problems.codim2.forms import branching_form

    z = curve.place(found[:n], curve.full_parameters(found))
    form = branching_form(branching, found)
    return replace(
        cusp, type="DP", z=z, residual=solved.residual, error=solved.error * float(scale[-1]),
        normal_form=dict(form.coefficients), vectors={**cusp.vectors, **form.vectors},
    )  # fmt: skip
