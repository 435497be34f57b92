"""Newton on the equations of a curve and one more: a point of codimension two, with its error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Sample
from contin.loci.codim2.functions import at_rows
from contin.problems.equilibria import solved_to_rounding as rounding
from contin.problems.tolerances import SETTLED, STALLED
from contin.systems.accuracy import accuracy_of_equations

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

RESIDUAL_LIMIT = 1e-8
SAFETY = 4.0  # times the largest of a few samples of an error
POLE = 0.1  # part of its values next to a point up to which a function has a zero there, and not a pole
FURTHER = 10.0  # times that distance, where it has fallen off on both sides of a pole, and grown on those of a zero
FREE = 1e-12  # relative: singular values up to which a direction costs nothing
DIFFERENCE = 1e-6  # scaled step of the derivative of the additional function, ...
SHORTER = 0.1  # part of it that serves where the function bends
LONGEST = 1e-3  # ... where that is lost in rounding errors, longer ones along the curve,
ILL = 1e-13  # an estimated error above this may be more than that of a regular defining system
ASIDE = 1e-2  # scaled distance at which the equations' sizes are looked at, too
BENDING = 1e-3  # scaled step of its second derivative
TOLD = 20.0  # times that error: a distance at which the singular place beside a zero is none of it
ALIKE = 16.0 * float(np.finfo(float).eps)  # ... and of equations' terms, which may all be rounded alike
CROSSED = 1e-6  # singular value of a curve's equations over the largest, at which another one is not told from it
ROUGH = 0.1  # ... until no more than this part of a difference is rounding

Residual = Callable[[Array], tuple[Array, Array]]  # residuals of a square system, Jacobian without its last row


@dataclass(frozen=True, eq=False)
class Solution:
    """Scaled unknowns, residual (maximum norm) and the estimated error of the first parameter, scaled too.

    drift : estimated errors of all unknowns, scaled, as a multiple of the curve's tangent; None where not known.
    second : the estimated error of the second parameter, scaled; NaN where not known.
    each : those of all unknowns, each by itself; None where not known.
    """

    y: Array
    residual: float
    error: float
    drift: Array | None = None
    second: float = float("nan")
    each: Array | None = None
    crossed: bool = False  # the curve's own equations are singular there: two curves are not told apart
    alone: bool = True  # the function has two signs at `DIFFERENCE` on both sides: no second zero lies as near


def solve(
    problem: CurveOfPoints, function: Callable[[Array], float], near: Sample, scale: Array, with_poles: bool = False,
    turning: bool = False, rounding: Callable[[Array], float] | None = None,
) -> Solution | None:  # fmt: skip
    """Newton on the curve's equations and function(z) = 0 in scaled unknowns, until rounding decides.

    The gradient of `function` is taken once, by central differences: `near` is so close that Newton with it converges
    within a few steps. The error of the first parameter is estimated as in `solved_to_rounding.newton`.

    with_poles : None where the function has no zero there, but changes its sign at a pole (of which rounding may make a
    zero: it falls off on both sides).  turning : null vectors are
    not unique there, and may turn at no cost: steps and errors are those without such directions.  rounding : by how
    much the function may be off at z, alike at neighbouring points.
    """
    curve, rows = problem.curve, scale[:-1]
    parameters = curve.parameters(near.z)
    off = 0.0 if rounding is None else rounding(near.z)
    gradient = _gradient(problem, function, near.z, scale, parameters, off)
    size = float(np.linalg.norm(gradient))
    if not 0.0 < size < np.inf:
        return None
    gradient, off = gradient / size, off / size

    def residual(y: Array) -> tuple[Array, Array]:
        f, jacobian = curve.linearise(y * scale, parameters)
        return np.append(f / rows, function(y * scale) / size), jacobian * scale / rows[:, None]

    found = _newton(residual, gradient, near.z / scale, turning, off)
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

    scatter = _scatter(residuals, matrix, inverse, y) + off * np.abs(inverse[:, -1])
    regular = turning or not float(np.max(scatter)) > ILL
    more, crossed = (0.0, False) if regular else _beside_singular(residual, residuals, y, matrix, scatter)
    scatter = scatter + more
    g[:-1] /= float(np.max(np.abs(jacobian))) or 1.0  # in units of time, of which residuals must not depend
    along = inverse[:, -1] / np.linalg.norm(inverse[:, -1])  # the one direction that the curve's equations leave free
    aside = max(DIFFERENCE, min(off * float(np.linalg.norm(inverse[:, -1])) / ROUGH, LONGEST))
    after, before = at_rows(function, np.array([y + aside * along, y - aside * along]) * scale).tolist()
    if with_poles:
        far = at_rows(function, np.array([y + FURTHER * aside * along, y - FURTHER * aside * along]) * scale)
        if _is_pole(abs(float(g[-1])) * size, np.array([after, before]), far):
            return None
    scatter = scatter + _of_approximate(accuracy_of_equations(curve.system), jacobian, inverse, y)
    drift = (float(np.max(scatter)) + float(np.max(lacking))) * along
    second, first = (scatter + lacking)[-2:].tolist()
    g[-1] = max(abs(float(g[-1])) - off, 0.0)  # what is not rounding
    lonely = not after * before > 0.0
    return Solution(y, float(np.max(np.abs(g))), first, drift, second, scatter + lacking, crossed, lonely)


def _of_approximate(accuracy: float, jacobian: Array, inverse: Array, y: Array) -> Array:
    """Errors of all unknowns where the equations are known to this relative accuracy, (n,)."""
    if not accuracy > 0.0:
        return np.zeros(len(y))
    sizes = np.append(np.abs(jacobian).max(axis=1), 1.0)
    return np.asarray(accuracy * max(1.0, float(np.abs(y).max())) * (np.abs(inverse) @ sizes))


def _is_pole(here: float, beside: Array, far: Array) -> bool:
    """True of a function that changes its sign at a pole: from its values there, beside it and farther away."""
    return here > POLE * float(np.abs(beside).max()) or bool(np.all(np.abs(far) < np.abs(beside)))


def _gradient(
    problem: CurveOfPoints, function: Callable[[Array], float], z: Array, scale: Array, parameters: Array, off: float
) -> Array:
    """The gradient of a function that may be off by as much, in scaled unknowns; not finite where it has none."""
    gradient = _differences(function, z, DIFFERENCE * np.diag(scale)) / DIFFERENCE
    if not (off > 0.0 and 0.0 < float(np.linalg.norm(gradient)) < np.inf):
        return gradient
    shorter = _differences(function, z, SHORTER * DIFFERENCE * np.diag(scale)) / (SHORTER * DIFFERENCE)
    bent = np.abs(shorter - gradient) > off / (SHORTER * DIFFERENCE)  # more than rounding explains
    return _right_along(problem, function, z, scale, parameters, np.where(bent, shorter, gradient), off)


def _differences(function: Callable[[Array], float], z: Array, steps: Array) -> Array:
    """Half the differences of the function at z + each step and z - each step."""
    ahead, behind = np.split(at_rows(function, np.concatenate([z + steps, z - steps])), 2)
    return np.asarray(0.5 * (ahead - behind))


def _right_along(
    problem: CurveOfPoints, function: Callable[[Array], float], z: Array, scale: Array, parameters: Array,
    gradient: Array, off: float,
) -> Array:  # fmt: skip
    """The gradient with the slope along the curve that differences in this direction give.

    Off the curve a function may change a thousand times as fast, and its differences err by more than that slope.
    off : its rounding errors, beside which the differences are to be large.
    """
    _, jacobian = problem.curve.linearise(z, parameters)
    scaled = jacobian * scale / scale[:-1, None]
    if not np.all(np.isfinite(scaled)):
        return gradient
    along, step, slope = np.linalg.svd(scaled)[2][-1], 0.1 * DIFFERENCE, 0.0
    while step < LONGEST and not off <= ROUGH * abs(slope) * step:
        step *= 10.0
        slope = float(_differences(function, z, step * along[None] * scale)[0]) / step
    return gradient + (slope - float(gradient @ along)) * along if np.isfinite(slope) else gradient


def _scatter(residuals: Callable[[Array], Array], matrix: Array, inverse: Array, y: Array) -> Array:
    """Estimated errors of all unknowns: how rounding errors of the residuals (at rows of y) reach them.

    Steps of 1e-12 leave the rounding of terms like 1 + small as it is; of longer ones the odd part, without what is
    curved, shows it (as in `solved_to_rounding`).
    """
    shifts = rounding.shifts(len(y))
    longer = rounding.ROUNDED / rounding.PERTURBATION * shifts
    close, ahead, behind = np.split(residuals(np.concatenate([y + shifts, y + longer, y - longer])), 3)
    estimates = np.abs(shifts - close @ inverse.T).max(axis=0)
    odd = np.abs(0.5 * (ahead - behind) - longer @ matrix.T).max(axis=0)
    return np.asarray(np.maximum(SAFETY * estimates, np.abs(inverse) @ odd))


def _beside_singular(
    residual: Residual, residuals: Callable[[Array], Array], y: Array, matrix: Array, scatter: Array
) -> tuple[Array, bool]:
    """By how much more unknowns may be off where the system is as good as singular, (n,), and whether the curve's is.

    Along the null vector v the residual is bend t (t - 2 d)/2, with the singular place at the distance d. Newton stops
    anywhere between two zeros that rounding does not tell apart.
    """
    beside = residual(y + ASIDE / rounding.PERTURBATION * rounding.shifts(len(y))[0])[1]
    sizes = np.append(np.maximum(np.abs(matrix[:-1]), np.abs(beside)).max(axis=1), 1.0)  # rows may vanish at y
    if not np.isfinite(sizes).all():
        return np.zeros(len(y)), False
    last = np.linalg.svd(matrix[:-1] / sizes[:-1, None], compute_uv=False)
    crossed = bool(last[-1] < CROSSED * last[0])
    left, values, right = np.linalg.svd(matrix / sizes[:, None])
    step, v = BENDING, right[-1]
    ahead, here, behind = residuals(np.array([y + step * v, y, y - step * v])) / sizes
    bend = abs(float(left[:, -1] @ (ahead - 2.0 * here + behind))) / (step * step)
    spread = float(np.linalg.norm(scatter))
    if not (np.isfinite(bend) and bend > 0.0):
        return np.zeros(len(y)), crossed
    distance = float(values[-1]) / bend
    if not (distance < TOLD * spread or bend * distance * distance < ALIKE):
        return np.zeros(len(y)), crossed
    return np.asarray(2.0 * (distance + float(np.sqrt(spread * distance))) * np.abs(v)), crossed


def _newton(
    residual: Residual, gradient: Array, y: Array, turning: bool, off: float = 0.0
) -> tuple[Array, Array] | None:
    """The solution, until rounding decides, and what is still lacking of each unknown where Newton stalls.

    off : rounding errors of the last residual.
    """
    before, lacking = np.inf, np.zeros(len(y))
    for _ in range(rounding.NEWTON_BUDGET):
        g, jacobian = residual(y)
        matrix = np.vstack([jacobian, gradient])
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(matrix))):
            return None
        try:
            step = -(np.linalg.pinv(matrix, rcond=FREE) @ g) if turning else np.linalg.solve(matrix, -g)
        except np.linalg.LinAlgError:  # not verified, in words
            return None
        length = float(np.linalg.norm(step))
        stalled = STALLED if off == 0.0 else max(STALLED, off * length / max(abs(g[-1]), 1e-300))
        if length >= 0.5 * before and length < stalled:
            ratio = min(length / before, 0.9)
            if length > 1e3 * SETTLED:
                lacking = 2.0 * np.abs(step) * ratio / (1.0 - ratio)
            break
        if length > 1e3 or (length >= before and before < stalled):
            return None
        y = y + step
        if length < SETTLED:
            break
        before = length
    else:
        return None
    return y, lacking
