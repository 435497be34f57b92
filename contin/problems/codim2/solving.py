"""Newton on the equations of a curve and one more: a point of codimension two, with its error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Sample
from contin.problems import defining
from contin.problems.codim2.functions import at_rows

if TYPE_CHECKING:
    from contin.problems.loci.problem import LocusProblem

RESIDUAL_LIMIT = 1e-8
ILL_CONDITIONED = 1e-4  # an estimated error (of the first parameter, in the metric) above this locates nothing
SAFETY = 4.0  # times the largest of a few samples of an error
POLE = 0.1  # part of its values next to a point up to which a function has a zero there, and not a pole
FREE = 1e-12  # relative: singular values up to which a direction costs nothing
DIFFERENCE = 1e-6  # scaled step of the derivative of the additional function

Residual = Callable[[Array], tuple[Array, Array]]  # residuals of a square system, Jacobian without its last row


@dataclass(frozen=True, eq=False)
class Solution:
    """Scaled unknowns, residual (maximum norm) and the estimated error of the first parameter, scaled too.

    drift : estimated errors of all unknowns, scaled, as a multiple of the curve's tangent; None where not known.
    second : the estimated error of the second parameter, scaled; NaN where not known.
    """

    y: Array
    residual: float
    error: float
    drift: Array | None = None
    second: float = float("nan")
    alone: bool = True  # the function has two signs at `DIFFERENCE` on both sides: no second zero lies as near


def solve(
    problem: LocusProblem, function: Callable[[Array], float], near: Sample, scale: Array, with_poles: bool = False,
    turning: bool = False,
) -> Solution | None:  # fmt: skip
    """Newton on the curve's equations and function(z) = 0 in scaled unknowns, until rounding decides.

    The gradient of `function` is taken once, by central differences: `near` is so close that Newton with it converges
    within a few steps. The error of the first parameter is estimated as in `defining.newton`.

    with_poles : None where the function has no zero there, but changes its sign at a pole.  turning : null vectors are
    not unique there, and may turn at no cost: steps and errors are those without such directions.
    """
    curve, rows = problem.curve, scale[:-1]
    parameters = curve.parameters(near.z)
    steps = DIFFERENCE * np.diag(scale)
    ahead, behind = np.split(at_rows(function, np.concatenate([near.z + steps, near.z - steps])), 2)
    gradient = (ahead - behind) / (2.0 * DIFFERENCE)
    size = float(np.linalg.norm(gradient))
    if not 0.0 < size < np.inf:
        return None
    gradient /= size

    def residual(y: Array) -> tuple[Array, Array]:
        f, jacobian = curve.linearise(y * scale, parameters)
        return np.append(f / rows, function(y * scale) / size), jacobian * scale / rows[:, None]

    found = _newton(residual, gradient, near.z / scale, turning)
    if found is None:
        return None
    y, lacking = found
    g, jacobian = residual(y)
    try:
        matrix = np.vstack([jacobian, gradient])
        inverse = np.linalg.pinv(matrix, rcond=FREE) if turning else np.linalg.inv(matrix)
    except np.linalg.LinAlgError:  # not verified, in words
        return None


    def residuals(at: Array) -> Array:
        z = at * scale
        return np.column_stack([curve.values(z, parameters) / rows, at_rows(function, z) / size])

    scatter = _scatter(residuals, matrix, inverse, y)
    g[:-1] /= float(np.max(np.abs(jacobian))) or 1.0  # in units of time, of which residuals must not depend
    along = inverse[:, -1] / np.linalg.norm(inverse[:, -1])  # the one direction that the curve's equations leave free
    after, before = at_rows(function, np.array([y + DIFFERENCE * along, y - DIFFERENCE * along]) * scale).tolist()
    beside = max(abs(after), abs(before))
    if with_poles and abs(float(g[-1])) * size > POLE * beside:
        return None
    approximate = max((limit.accuracy for limit in curve.system.limits), default=0.0)
    if approximate > 0.0:
        sizes = np.append(np.abs(jacobian).max(axis=1), 1.0)
        scatter = scatter + approximate * max(1.0, float(np.abs(y).max())) * (np.abs(inverse) @ sizes)
    drift = (float(np.max(scatter)) + float(lacking[-1])) * along
    second, first = (scatter + lacking)[-2:].tolist()
    return Solution(y, float(np.max(np.abs(g))), first, drift, second, not after * before > 0.0)


def _scatter(residuals: Callable[[Array], Array], matrix: Array, inverse: Array, y: Array) -> Array:
    """Estimated errors of all unknowns: how rounding errors of the residuals (at rows of y) reach them.

    Steps of 1e-12 leave the rounding of terms like 1 + small as it is; of longer ones the odd part, without what is
    curved, shows it (as in `defining`).
    """
    shifts = defining.shifts(len(y))
    longer = defining.ROUNDED / defining.PERTURBATION * shifts
    close, ahead, behind = np.split(residuals(np.concatenate([y + shifts, y + longer, y - longer])), 3)
    estimates = np.abs(shifts - close @ inverse.T).max(axis=0)
    odd = np.abs(0.5 * (ahead - behind) - longer @ matrix.T).max(axis=0)
    return np.asarray(np.maximum(SAFETY * estimates, np.abs(inverse) @ odd))


def _newton(residual: Residual, gradient: Array, y: Array, turning: bool) -> tuple[Array, Array] | None:
    """The solution, until rounding decides, and what is still lacking of each unknown where Newton stalls."""
    before, lacking = np.inf, np.zeros(len(y))
    for _ in range(defining.NEWTON_BUDGET):
        g, jacobian = residual(y)
        matrix = np.vstack([jacobian, gradient])
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(matrix))):
            return None
        try:
            step = -(np.linalg.pinv(matrix, rcond=FREE) @ g) if turning else np.linalg.solve(matrix, -g)
        except np.linalg.LinAlgError:  # not verified, in words
            return None
        length = float(np.linalg.norm(step))
        if length >= 0.5 * before and length < defining.STALLED:
            ratio = min(length / before, 0.9)
            if length > 1e3 * defining.SETTLED:
                lacking = 2.0 * np.abs(step) * ratio / (1.0 - ratio)
            break
        if length > 1e3 or (length >= before and before < defining.STALLED):
            return None
        y = y + step
        if length < defining.SETTLED:
            break
        before = length
    else:
        return None
    return y, lacking
