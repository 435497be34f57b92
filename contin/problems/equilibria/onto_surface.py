"""Where a branch meets a switching surface in which another branch lies: the limit of its own points.

As x (g(|x|) - p) = 0 at x = 0: there F = 0 on the surface whatever the parameter is, so that Newton's method on both
ends wherever its last chord leads. At a height above the surface the branch's own point is regular; polynomials through
several such points give the one at height 0 (Neville's scheme).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.newton import Converged, Rules, by_steps, solution

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

NEARER: Final = 0.125  # of the way to the surface that is left, ...
FALLS: Final = 0.2  # ... where the smallest singular value falls in proportion, if another branch lies in it
HIGHEST: Final = 1e-4  # scaled height of the first point
POINTS: Final = 5  # each at half the height of the one before
AMPLIFIED: Final = 16.0  # rounding errors of such points, at height 0
AT_HEIGHT: Final = Rules(settled=1e-16, stalled=1e-10, budget=20)
MISSED: Final = 1e-2  # scaled: a limit so far from the point before is that of another branch


def meets_another(bordered: Callable[[Array], Array], corner: Array, side: Array) -> bool:
    """True where the matrix of F = 0, h = 0 becomes singular on the way from a point on one side to the corner."""
    far, near = (
        np.linalg.svd(bordered(corner + part * (side - corner)), compute_uv=False)[-1] for part in (1.0, NEARER)
    )
    return bool(near < FALLS * far)


def at_height(
    problem: AlgebraicEquations, surface: Callable[[Array], float], gradient: Array, size: float, height: float,
    guess: Array, scale: Array, rules: Rules,
) -> Converged[Array] | None:  # fmt: skip
    """F = 0 at a height of the surface's function, by Newton's method with its gradient at one place, of this size."""

    def step(z: Array) -> Array | None:
        f, matrix = problem.linearise(z)
        bordered = np.vstack([matrix * scale / scale[:-1, None], gradient / size])
        return solution(bordered, -np.append(f / scale[:-1], (surface(z) - height) / size))

    return by_steps(step, guess, scale, rules)


def limit_on_surface(
    problem: AlgebraicEquations, surface: Callable[[Array], float], gradient: Array, side: Array, scale: Array
) -> tuple[Array, float, float] | None:
    """The limit of the branch through a point `side` (N,) beside a surface: z, its height, the error of the parameter.

    surface : its function.  gradient (N,) : of that, in scaled unknowns.  None where there are no such points.
    """
    size, here = float(np.abs(gradient).max()), surface(side)
    heights = np.copysign(HIGHEST * size / 2.0 ** np.arange(POINTS), here)
    points, guess = [], side
    for height in heights:
        found = at_height(problem, surface, gradient, size, float(height), guess, scale, AT_HEIGHT)
        if found is None or not surface(found.at) * here > 0.0:
            return None
        points.append(found.at)
        guess = found.at
    table = np.array(points)
    for order in range(1, POINTS):
        ratio = heights[order:, None] / heights[:-order, None]
        before, table = table, (table[1:] - ratio * table[:-1]) / (1.0 - ratio)
    z, doubt = table[-1], np.abs(table[-1] - before).max(axis=0)
    if not np.linalg.norm((z - points[-1]) / scale) < MISSED:
        return None
    rounding = AMPLIFIED * np.finfo(float).eps * float(np.abs(z[-1]))
    return z, float(abs(surface(z)) / size), float(doubt[-1] + rounding)
