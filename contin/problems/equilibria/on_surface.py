"""Newton's method on a switching surface, and behind it: corners to rounding, and points beside them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.newton import Rules, by_steps, solution
from contin.linalg.vectors import norm
from contin.problems.equilibria.onto_surface import at_height, limit_on_surface, meets_another

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

NEWTON = Rules(settled=1e-15, stalled=1e-12, budget=30)
AT_HEIGHT = Rules(settled=1e-14, stalled=1e-12, budget=30)
CORNERED = 1e-4  # scaled distance from a guess beyond which its corner is another one
HEIGHTS = (1.0, 1e-2, 1e-4, 1e-6, 1e-8)  # ... of that, above a surface that the branch leaves like a root
ROUNDINGS = 4.0  # of z: beside a corner
STEP = 1e-7  # of central differences of a switching function (scaled unknowns)
ANOTHER = "another branch lies in the surface at which this one turns: a branch point at a corner; it is not followed"


@dataclass(frozen=True, eq=False)
class OnSurface:
    """A solution on a switching surface, the error of its parameter, and what is to be said about it."""

    z: Array
    residual: float
    error: float
    remark: str = ""


def on_surface(problem: AlgebraicEquations, k: int, z: Array, side: Sample, frame: Frame) -> OnSurface | None:
    """Newton on F = 0, h_k = 0 with the Jacobian of one side.

    Where another branch lies in the surface, there are many solutions: the limit of the branch's own points is taken.
    """
    n, scale = problem.n, frame.scale
    system = problem.system

    def surface(point: Array) -> float:
        return float(system.switches(point[:n], problem.full_parameters(point))[k])

    f, matrix = problem.linearise(side.z)
    jacobian = matrix * scale / scale[:-1, None]
    gradient = _gradient(surface, z, scale)
    size = float(np.abs(gradient).max())
    if size == 0.0:
        return None
    bordered = np.vstack([jacobian, gradient / size])
    start = z

    def missed(z: Array) -> Array:
        return np.append(problem.linearise(z)[0] / scale[:-1], surface(z) / size)

    def step(z: Array) -> Array | None:
        return solution(bordered, -missed(z)) if norm((z - start) / scale) <= CORNERED else None

    found = by_steps(step, z, scale, NEWTON)
    if found is None:  # the corner is not verified, in words
        return None
    z, before, left = found.at, found.made, missed(found.at)

    def matrix_at(point: Array) -> Array:
        return np.vstack([problem.linearise(point)[1] * scale / scale[:-1, None], gradient / size])

    if meets_another(matrix_at, z, side.z):
        limit = limit_on_surface(problem, surface, gradient, side.z, scale)
        return None if limit is None else OnSurface(*limit, ANOTHER)
    f, scatter = _from_the_smoother_side(problem, z, gradient)
    moved = np.linalg.solve(bordered, np.append(-f / scale[:-1], 0.0))
    spread = float(abs(np.linalg.solve(bordered, np.append(scatter / scale[:-1], 0.0))[-1]))
    error = float(scale[-1] * (max(before, 1e-15) * 4.0 + spread))
    if np.linalg.norm(moved) < 1e-6:
        z = z + scale * moved
    return OnSurface(z, float(np.max(np.abs(left))), error)


def _from_the_smoother_side(problem: AlgebraicEquations, z: Array, gradient: Array) -> tuple[Array, Array]:
    """F just beside a corner, on the side where the next rounding errors of z change it less, and by how much.

    A formula that leaves the surface like sqrt(h) is off by the root of a rounding error where z is on the surface.
    """
    unit = ROUNDINGS * np.finfo(float).eps * np.abs(z) * np.sign(gradient)
    found = []
    for side in (-1.0, 1.0):
        near, far = (problem.linearise(z + side * times * unit)[0] for times in (1.0, 2.0))
        found.append((near, np.abs(far - near)))
    return min(found, key=lambda pair: float(np.max(pair[1])) if np.all(np.isfinite(pair[1])) else np.inf)


def behind_by_height(
    problem: AlgebraicEquations, k: int, corner: Array, sense: float, behind: float, frame: Frame, settings: Settings
) -> Sample | None:
    """A point behind a corner by its height above the surface, where the formula leaves that like a root of the height.

    No step along a tangent leads there: the slope is infinite at the corner and falls faster than Newton's method can
    follow. With the height given, the other unknowns are regular.
    """
    n, scale = problem.n, frame.scale

    def surface(z: Array) -> float:
        return float(problem.system.switches(z[:n], problem.full_parameters(z))[k])

    gradient = _gradient(surface, corner, scale)
    size = float(np.linalg.norm(gradient))
    if size == 0.0:
        return None
    for height in HEIGHTS:
        z = corner + np.copysign(height * behind, sense) * scale * gradient / size
        found = at_height(problem, surface, gradient, size, surface(z), z, scale, AT_HEIGHT)
        if found is None or far(found.at, corner, scale, behind):
            continue  # with a smaller height
        z = found.at
        _, matrix = problem.linearise(z)
        tangent = np.linalg.svd(matrix * scale / scale[:-1, None])[2][-1]
        tangent = tangent if float(gradient @ tangent) * sense > 0.0 else -tangent
        beyond = problem.probe(Sample(z, tangent, np.full(4, np.nan), 0, np.empty(0, complex)), 0.0, z, frame, settings)
        if beyond is not None and surface(beyond.z) * sense > 0.0:
            return beyond
    return None


def _gradient(surface: Callable[[Array], float], z: Array, scale: Array) -> Array:
    """Of a switching function in scaled unknowns, by central differences."""
    shifts = STEP * np.diag(scale)
    return np.array([(surface(z + shift) - surface(z - shift)) / (2.0 * STEP) for shift in shifts])


def far(beyond: Array, corner: Array, scale: Array, behind: float) -> bool:
    """True where a point is too far from a corner to lie on the arm that begins there: on another branch."""
    return float(np.linalg.norm((beyond - corner) / scale)) > 10.0 * behind
