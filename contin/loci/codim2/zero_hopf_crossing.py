"""Zero-Hopf points at which two Hopf curves cross: on an invariant plane, or where a reflection is broken.

Of maps, likewise, multiplier 1 on curves of period doublings and Neimark-Sacker points (F_u - I in place of F_u).

There F_p is orthogonal to the left null vector psi of F_u in both parameters, as at a branch point: w0' = w0 (...). The
equations of each Hopf curve are singular (two tangents), and so is a Newton step on them and a vanishing eigenvalue.
Two more conditions, psi . F_p = 0, make them regular: more equations than there are unknowns, with a solution all the
same, to which Gauss and Newton's step converges quadratically (Deuflhard, Newton Methods for Nonlinear Problems, 4.3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.linalg.newton import Rules, by_steps
from contin.machine import elementary
from contin.problems.equilibria import solved_to_rounding as rounding
from contin.problems.tolerances import SETTLED, STALLED

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

FORCED: Final = 1e-2  # slope |psi . F_p| near a point, relative to F_u and F_p, up to which it is looked for here
STEP: Final = 1e-6  # scaled, of the derivatives of the conditions beside the curve's equations
CURVATURE: Final = 1e-4  # scaled, of the second derivative of the curve's equations
RANK: Final = 1e-5  # a singular value below this part of the largest is zero
EXACT: Final = 1e-7  # ... at the point itself
REAL: Final = -1e-10  # of the squared size of the quadratic form: a discriminant below this has no real roots
NEWTON: Final = Rules(SETTLED, STALLED, far=1e3, budget=rounding.NEWTON_BUDGET)


@dataclass(frozen=True, eq=False)
class Crossing:
    """Scaled unknowns, the residual of all equations (maximum norm) and the estimated errors of the unknowns."""

    y: Array
    residual: float
    errors: Array

    @property
    def error(self) -> float:
        """Of the first parameter, scaled."""
        return float(self.errors[-1])


def is_forced(problem: CurveOfPoints, z: Array, scale: Array, limit: float = FORCED) -> bool:
    """True where neither parameter unfolds the vanishing eigenvalue at z (by more than `limit`)."""
    return float(np.max(np.abs(_slopes(problem, z, scale, _left(problem, z))))) < limit


def solve(problem: CurveOfPoints, eigenvalue: Callable[[Array], float], near: Sample, frame: Frame) -> Crossing | None:
    """The point next to `near`, with eigenvalue(z) = 0; None where the equations have no regular solution there."""
    curve, scale = problem.curve, frame.scale
    parameters = curve.parameters(near.z)
    rows, count = scale[:-1], len(near.z)
    psi = _left(problem, near.z)

    def unscaled(z: Array) -> Array:
        return np.array([eigenvalue(z), *_slopes(problem, z, scale, psi)])

    lengths = np.linalg.norm(_gradients(unscaled, near.z / scale, scale), axis=1)
    sizes = np.where(lengths > 0.0, lengths, 1.0)  # an eigenvalue that vanishes slowly vanishes as well

    def conditions(z: Array) -> Array:
        return np.asarray(unscaled(z) / sizes)

    def equations(y: Array) -> tuple[Array, Array]:
        f, jacobian = curve.linearise(y * scale, parameters)
        return f / rows, jacobian * scale / rows[:, None]

    rate = float(np.max(np.abs(equations(near.z / scale)[1]))) or 1.0  # the conditions have no unit of time

    def system(y: Array) -> tuple[Array, Array]:
        f, jacobian = equations(y)
        return np.append(f / rate, conditions(y * scale)), jacobian / rate

    def step(y: Array) -> Array | None:
        g, jacobian = system(y)
        matrix = np.vstack([jacobian, _gradients(conditions, y, scale)])
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(matrix))):
            return None
        return np.asarray(-np.linalg.lstsq(matrix, g, rcond=None)[0])

    found = by_steps(step, near.z / scale, 1.0, NEWTON)
    if found is None or found.exhausted:
        return None
    y = found.at
    g, jacobian = system(y)
    matrix = np.vstack([jacobian, _gradients(conditions, y, scale)])
    values = np.linalg.svd(matrix, compute_uv=False)
    if not values[-1] > RANK * values[0]:
        return None
    inverse = np.linalg.pinv(matrix)
    generator = np.random.default_rng(12345)
    shifts = rounding.PERTURBATION * generator.uniform(-1.0, 1.0, (rounding.SAMPLES, count))
    scatter = 2.0 * np.max([np.abs(shift - inverse @ system(y + shift)[0]) for shift in shifts], axis=0)
    return Crossing(y, float(np.max(np.abs(g))), scatter)


def other_tangents(problem: CurveOfPoints, z: Array, scale: Array, own: Array | None = None) -> list[Array]:
    """Unit tangents (scaled) of the curves through a crossing, without that of `own`.

    On the kernel of the curve's Jacobian, tangents are the zeros of the quadratic form psi . D^2G.
    """
    curve = problem.curve
    rows, parameters = scale[:-1], curve.parameters(z)

    def jacobian(y: Array) -> Array:
        return np.asarray(curve.linearise(y * scale, parameters)[1] * scale / rows[:, None])

    y = z / scale
    left, values, right = np.linalg.svd(jacobian(y))
    if not values[-1] <= RANK * values[0]:
        return []
    psi, kernel = left[:, -1], right[-2:]
    form = np.empty((2, 2))
    for i, k in enumerate(kernel):
        change = (jacobian(y + CURVATURE * k) - jacobian(y - CURVATURE * k)) / (2.0 * CURVATURE)
        form[i] = kernel @ (psi @ change)
    form = 0.5 * (form + form.T)
    found = [kernel.T @ direction for direction in _zeros(form)]
    found = [t / np.linalg.norm(t) for t in found]
    if own is None or len(found) < 2:
        return found
    return [min(found, key=lambda t: abs(float(t @ own)))]


def _zeros(form: Array) -> list[Array]:
    """Directions (x, y) in which a quadratic form a x^2 + 2 b x y + c y^2 vanishes: by its eigenvectors."""
    values, vectors = np.linalg.eigh(form)
    low, high = float(values[0]), float(values[1])
    if not low * high < REAL * elementary.square(max(abs(low), abs(high))):
        return []
    return [vectors[:, 0] * np.sqrt(high) + sign * vectors[:, 1] * np.sqrt(-low) for sign in (1.0, -1.0)]


def _matrix(problem: CurveOfPoints, z: Array) -> Array:
    """f_u, or of a map f_u - I, scaled."""
    d = problem.curve.sizes
    matrix = np.asarray(problem.curve.matrix(z) * d / d[:, None])
    return matrix - np.eye(problem.n) if problem.system.kind == "map" else matrix


def _left(problem: CurveOfPoints, z: Array) -> Array:
    """The left null vector of f_u (scaled), roughly: of the smallest real eigenvalue."""
    values, vectors = np.linalg.eig(_matrix(problem, z).T)
    size = float(np.abs(values).max())
    real = np.flatnonzero(np.abs(values.imag) <= 1e-9 * size)
    if not real.size:
        return np.linalg.svd(_matrix(problem, z))[0][:, -1]
    psi = vectors[:, real[int(np.argmin(np.abs(values[real])))]].real
    return np.asarray(psi / np.linalg.norm(psi))


def _slopes(problem: CurveOfPoints, z: Array, scale: Array, near: Array) -> Array:
    """psi . F_p of both parameters, relative to the sizes of F_u and F_p; psi is followed from `near`."""
    curve, n, d = problem.curve, problem.n, problem.curve.sizes
    full = curve.system.jacobian(z[:n], curve.full_parameters(z))[1]
    matrix = full[:, :n] * d / d[:, None]
    psi = _left(problem, z)
    psi = psi if float(psi @ near) > 0.0 else -psi
    slopes = full[:, [n + curve.first, n + curve.second]] * scale[[-1, -2]] / d[:, None]
    return np.asarray(psi @ slopes / max(float(np.linalg.norm(slopes)), float(np.linalg.norm(matrix)), 1e-300))


def _gradients(conditions: Callable[[Array], Array], y: Array, scale: Array) -> Array:
    """(3, N): central differences."""
    columns = []
    for k in range(len(y)):
        shift = np.zeros(len(y))
        shift[k] = STEP
        columns.append((conditions((y + shift) * scale) - conditions((y - shift) * scale)) / (2.0 * STEP))
    return np.array(columns).T
