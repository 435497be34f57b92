"""Past a corner of a user's function, whose surface nobody has named: the residual and its derivatives show where.

On either side of a corner h(z) = 0 the function is smooth, F_new = F_old + c h with c a vector. So the Jacobians differ
by a matrix of rank one, c (grad h)^T, which gives both; what the value just beyond differs from the old formula's gives
h there, and with it the corner to second order in the distances used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Corner
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import dot, norm

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

BESIDE: Final = 3e-5  # distance from the corner (scaled) at which either formula is looked at
KINK: Final = 1e-3  # relative change of the Jacobian across that distance that only a corner makes
SINGLE: Final = 0.05  # second singular value of that change: beyond, more than one surface is crossed
FURTHER: Final = 3e-4  # ... where a last step went past it
TOUCHES: Final = 1e-6  # rate along the branch below which it does not cross the surface
SETTLED: Final = 0.01  # change of the place in the last round, in multiples of BESIDE
CLOSER: Final = 16.0  # ratio of distances at which a corner changes the Jacobian alike
AWAY: Final = 10.0  # multiples of the first distance within which the corner must lie


@dataclass(frozen=True, eq=False)
class Bend:
    """A corner z and the tangents of the branch before and beyond it (scaled, in the sense of travel)."""

    z: Array
    before: Array
    beyond: Array


def unnamed_corner(problem: AlgebraicEquations, last: Sample, frame: Frame) -> Bend | None:
    """The corner near `last`, ahead or behind; None where there is none, or several surfaces meet."""
    return _searched(problem, last, frame, BESIDE) or _searched(problem, last, frame, FURTHER)


def _searched(problem: AlgebraicEquations, last: Sample, frame: Frame, first: float) -> Bend | None:
    """The corner, looked for at the distance `first`, and then at BESIDE."""
    scale = frame.scale
    n = len(scale) - 1

    def scaled(z: Array) -> tuple[Array, Array]:
        f, matrix = problem.linearise(z)
        return f / scale[:-1], matrix * scale / scale[:-1, None]

    ahead, corner = last.tangent, last.z
    before, gradient, j_new = corner, ahead, np.empty((n, n + 1))
    for beside in (first, BESIDE, BESIDE):
        old, new = corner - beside * scale * ahead, corner + beside * scale * ahead
        (f_old, j_old), (f_new, j_new) = scaled(old), scaled(new)
        if not all(np.all(np.isfinite(a)) for a in (f_old, j_old, f_new, j_new)):
            return None
        tangent = np.linalg.svd(j_old)[2][-1]
        ahead = tangent if dot(tangent, last.tangent) > 0.0 else -tangent
        jumps, sizes, gradients = np.linalg.svd(j_new - j_old)
        if sizes[0] < KINK * norm(j_old.ravel()) or (n > 1 and sizes[1] > SINGLE * sizes[0]):
            return None
        jump, gradient = jumps[:, 0], gradients[0]
        if abs(dot(gradient, ahead)) < TOUCHES:
            return None
        h = dot(jump, f_new - f_old - j_old @ ((new - old) / scale)) / float(sizes[0])
        right = np.append(-f_old, dot(gradient, (new - old) / scale) - h)
        before = corner
        try:
            corner = old + scale * np.linalg.solve(np.vstack([j_old, gradient]), right)
        except np.linalg.LinAlgError:  # no corner is crossed: the branch ends, in words
            return None
        if not norm((corner - last.z) / scale) < AWAY * first:
            return None
    if not norm((corner - before) / scale) < SETTLED * BESIDE:
        return None
    closer = BESIDE / CLOSER * scale * ahead
    gap = scaled(corner + closer)[1] - scaled(corner - closer)[1]
    if not np.linalg.norm(gap, 2) > 0.5 * float(sizes[0]):  # NaN, too
        return None  # it shrinks with the distance: the function is smooth, and bent
    beyond = np.linalg.svd(j_new)[2][-1]
    rate = dot(gradient, beyond)
    if abs(rate) < TOUCHES:
        return None
    return Bend(corner, ahead, beyond if rate * dot(gradient, ahead) > 0.0 else -beyond)


def cross_unnamed_corner(
    problem: AlgebraicEquations, last: Sample, frame: Frame, settings: Settings
) -> tuple[Sample, Corner] | None:
    """A point just beyond the corner near `last`, and the corner."""
    bend = unnamed_corner(problem, last, frame)
    if bend is None:
        return None
    base = Sample(bend.z, bend.beyond, np.full(4, np.nan), 0, last.eigenvalues)
    guess = bend.z + BESIDE * frame.scale * bend.beyond
    found: Sample | None = problem.probe(base, BESIDE, guess, frame, settings)
    if found is None or norm((found.z - bend.z) / frame.scale) > 2.0 * BESIDE:
        return None
    return (found, Corner(bend.z)) if dot(found.tangent, bend.beyond) > 0.0 else None
