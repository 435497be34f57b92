"""Branch points at which a branch comes to solutions that exist at one parameter and are not isolated.

A superconductor's order parameter f falls to zero where the vector potential of the normal state can be shifted at
will: F_u has a kernel of two dimensions, and beyond there are solutions without end. With its null vectors Q (n, 2),
left ones W, and alpha in the plane,

    F(x0 + Q alpha + .., p0) + W mu = 0,    <Q, x - x0> = alpha

gives mu(alpha), of second order. Where it vanishes to rounding on both sides along a curve through 0, so do the
equations: a continuum. (Isolated branches that cross have p off p0 there.)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.kernel_at_branch_point import SmallestValues, kernel_dimension
from contin.bvp.on_mesh import OnMesh
from contin.linalg.vectors import norm
from contin.machine import elementary

REACHES: Final = (0.02, 0.05)  # of the functions' sizes: how far from the branch point solutions are looked for
DIRECTIONS: Final = 24
NEXT_TO_ZERO: Final = 0.6  # of the largest mu: in these directions more is not next to a zero of a form of order 4
REFINED: Final = 40  # golden sections: the angle to 1e-9
FIRST: Final = 10  # after so many a minimum above `HOPELESS` of the largest mu is given up
HOPELESS: Final = 0.05
CHORDS: Final = 12
SETTLED: Final = 1e-11  # of the distance: a correction that no longer counts
VANISHING: Final = 1e-6  # part of the largest mu at this distance that a solution leaves (rounding, and the mesh)
OPPOSITE: Final = -0.9  # cosine of two directions that lead to both sides
GOLDEN: Final = 0.5 * (np.sqrt(5.0) - 1.0)


NONE: Final = -1


def free_function(mesh: OnMesh, x: Array, small: SmallestValues, sizes: Array) -> int:
    """The place of the state that moves most along a continuum of solutions through x at its parameter; or `NONE`.

    small : of F_u at x; only where its kernel has two dimensions is looked.  sizes : (n,) of the unknowns.
    """
    if kernel_dimension(small) != 2:
        return NONE
    q = np.linalg.qr(small[1][:, :2] / sizes[:, None])[0] * sizes[:, None]
    reduced = _reduced(mesh, x, q, sizes)
    if reduced is None:
        return NONE
    along = np.zeros(len(x) - 1)
    for reach in REACHES:
        angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
        left = np.array([norm(reduced(reach * _unit(a))) for a in angles])
        if not np.all(np.isfinite(left)) or left.max() == 0.0:
            return NONE
        low = (left <= np.minimum(np.roll(left, 1), np.roll(left, -1))) & (left <= NEXT_TO_ZERO * left.max())
        ways = angles[low].tolist()
        lowest = [_least(reduced, reach, a, HOPELESS * left.max()) for a in ways]
        zeros = [a for a, size in lowest if size <= VANISHING * left.max()]
        pairs = [a for a in zeros if any(elementary.cos(a - b) < OPPOSITE for b in zeros)]
        if not pairs:
            return NONE
        along = q @ _unit(pairs[0])
    moved = np.abs(along / sizes).reshape(-1, mesh.problem.n).max(axis=0)
    return int(np.argmax(moved[: mesh.problem.two.n_states]))


def _unit(angle: float) -> Array:
    return np.array([elementary.cos(angle), elementary.sin(angle)], dtype=float)


def _reduced(mesh: OnMesh, x: Array, q: Array, sizes: Array) -> Callable[[Array], Array] | None:
    """mu(alpha), NaN where the iteration does not settle."""
    linear = mesh.linear(x)
    if linear is None:
        return None
    w = np.linalg.qr(np.column_stack([linear.factor.solve_transposed(each) for each in q.T]))[0]
    rows = q / elementary.square(sizes)[:, None]  # <q, x> in units of the sizes
    solver = linear.bordered(w, rows, np.zeros((2, 2)))

    def value(alpha: Array) -> Array:
        at, mu = x.copy(), np.zeros(2)
        at[:-1] += q @ alpha
        before = np.inf
        for _ in range(CHORDS):
            right = np.concatenate([-mesh.residual(at) - w @ mu, alpha - rows.T @ (at - x)[:-1]])
            if not np.all(np.isfinite(right)):
                return np.full(2, np.nan)
            step = solver.solve(right)
            at[:-1] += step[:-2]
            mu += step[-2:]
            size = norm(step[:-2] / sizes)
            if size >= before or size < SETTLED * norm(alpha):
                break
            before = size
        return mu

    return value


def _least(reduced: Callable[[Array], Array], reach: float, angle: float, hopeless: float) -> tuple[float, float]:
    """The angle next to this one at which |mu| is least, and |mu| there."""
    step = 2.0 * np.pi / DIRECTIONS
    low, high = angle - step, angle + step

    def size(a: float) -> float:
        return norm(reduced(reach * _unit(a)))

    a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    fa, fb = size(a), size(b)
    for k in range(REFINED):
        if k == FIRST and min(fa, fb) > hopeless:
            break
        if fa < fb:
            high, b, fb = b, a, fa
            a = high - GOLDEN * (high - low)
            fa = size(a)
        else:
            low, a, fa = a, b, fb
            b = low + GOLDEN * (high - low)
            fb = size(b)
    return (a, fa) if fa < fb else (b, fb)
