"""What collocation leaves of the equations between its points, where a solution is not smooth.

Errors of the mesh are estimated from the derivative of order m + 1, which means nothing where the equations have a
singular coefficient (x^(-1/2) at an end) or a corner. On an interval of length h the polynomial meets u' = F at m Gauss
points; what it does not meet is F - I F, I the interpolation there. Its integral,

    d_i = h int |F - I F| ds / size,

is an error of u of the order of the method where F is smooth, and is seen for what it is where F is not.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp.sizes import largest
from contin.kernels.collocation_basis import basis
from contin.linalg.vectors import norm
from contin.problems.orbits.mesh.adaption import estimate
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.small_ends import error_at_small_ends

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

STUBBORN: Final = 0.125  # part of a defect that is left in half the interval: more than of a smooth solution
FINER: Final = 0.01  # of the tolerance: where a solution is not smooth, errors of the finer mesh beside the other's
LEVELS: Final = 40  # of halving: to rounding of the places
MOST: Final = 100  # intervals that are added at a time
ROUNDED: Final = 1e-8  # of its natural size: a function below it is zero but for rounding
NO_PART: Final = 1e-8  # of a null function's largest part: such a part is rounding
NEXT: Final = 1e-9  # part of an interval: there a defect is the same, and rounding another
NOISY: Final = 0.05  # part of a defect by which rounding differs
ROWS: Final = 4  # of a branch that are looked at
UNRESOLVED: Final = 100.0  # times the tolerance, ...
WORTHLESS: Final = 40.0  # ... and the estimate: a defect that makes it worthless (30 times of smooth solutions)


@lru_cache(maxsize=8)
def _rule(m: int) -> tuple[Array, Array, Array]:
    """Points and weights of a quadrature on [0, 1] that shares none with the m Gauss points, and I at them."""
    points, weights = np.polynomial.legendre.leggauss(2 * m + 2)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    gauss = basis(m).gauss
    apart = gauss[:, None] - gauss
    np.fill_diagonal(apart, 1.0)
    away = points[:, None] - gauss
    matrix = np.empty((len(points), m))
    for k in range(m):
        matrix[:, k] = np.prod(np.delete(away, k, axis=1), axis=1) / np.prod(apart[k])
    return points, weights, matrix


def defects(
    problem: BoundaryEquations, profile: Profile, h: Array, sizes: Array, beside: Profile | None = None,
    shift: float = 0.0, asked: NDArray[np.bool_] | None = None,
) -> Array:  # fmt: skip
    """d_i of the intervals h for a solution known on its own mesh, (len(h),); NaN and infinity count as none.

    beside : a function q of the same mesh that is to meet the linearised equations q' = F_u q as well, such as a null
    function, relative to its largest values.  shift : part of an interval by which all points of it are moved.
    asked : the intervals that are looked at, all without it; the result is theirs.
    """
    points, weights, interpolate = _rule(profile.m)
    starts = np.concatenate([[0.0], np.cumsum(h)[:-1]])
    if asked is not None:
        starts, h = starts[asked], h[asked]
    inner = np.concatenate([basis(profile.m).gauss, points]) + shift
    times = np.minimum((starts + h * inner[:, None]).ravel(), 1.0)  # sums over points in intervals run over long rows
    p = np.tile(problem.full_parameters(profile.vector()), (len(times), 1))
    p[:, -1] = times
    n, m = profile.n, profile.m
    values, matrices = (np.asarray(each) for each in problem.two.system.jacobians(profile.at(times), p))
    right, accurate = values[:, :n], sizes
    if beside is not None:
        linear = np.einsum("tij,tj->ti", matrices[:, :n, :n], beside.at(times))
        top = np.abs(beside.u).max(axis=0)
        right = np.hstack([right, linear])
        accurate = np.append(sizes, np.where(top > NO_PART * top.max(), top, np.inf))
    right = right.reshape(len(inner), -1)
    apart = np.abs(right[m:] - np.einsum("qk,kx->qx", interpolate, right[:m]))
    whole = np.einsum("q,qx->x", weights, apart).reshape(len(h), -1)
    found = (h[:, None] * whole / accurate).max(axis=1)
    return np.where(np.isfinite(found), found, 0.0)


def finer(problem: BoundaryEquations, profile: Profile, sizes: Array) -> Array:
    """The mesh by which errors are told: half the intervals, still shorter where the solution is not smooth."""
    return resolving(problem, profile, np.repeat(0.5 * profile.h, 2), sizes, FINER * problem.tolerance)


def resolving(
    problem: BoundaryEquations, profile: Profile, h: Array, sizes: Array, tolerance: float | None = None,
    beside: Profile | None = None,
) -> Array:  # fmt: skip
    """The mesh h with intervals halved where the solution is not smooth, until the equations are met to the tolerance.

    Where it is smooth, a defect falls by 2^(m + 1) in half an interval, and errors are those that the mesh was made
    for; where it is not, hardly.  beside : see `defects`.
    """
    most, tolerance = len(h) + MOST, problem.tolerance if tolerance is None else tolerance
    open_ = np.ones(len(h), dtype=bool)
    for _ in range(LEVELS):
        found = np.zeros(len(h))
        found[open_] = defects(problem, profile, h, sizes, beside, asked=open_)
        open_ = found > tolerance
        if not open_.any():
            break
        halves = defects(problem, profile, np.repeat(0.5 * h, 2), sizes, beside, asked=np.repeat(open_, 2))
        split = open_.copy()
        split[open_] = halves.reshape(-1, 2).max(axis=1) > STUBBORN * found[open_]
        if not split.any() or len(h) + int(split.sum()) > most:
            break
        parts = np.where(split, 2, 1)
        h, open_ = np.repeat(h / parts, parts), np.repeat(split, parts)
    return h


def remark_on_ends(problem: BoundaryEquations, z: Array, natural: Array) -> str:
    """That values at ends where functions are small are not known to many digits on these meshes; of rows z."""

    def error_of(profile: Profile) -> float:
        return error_at_small_ends(profile, natural)

    worst, where = _worst(problem, z, error_of)
    if worst == 0.0:
        return ""
    return (
        f"at ends where a function is much smaller than elsewhere it is known to about {min(worst, 1.0):.0e} of its "
        f"own size only near {problem.parameters[0]} = {where:.6g}: so are its .start or .end there. Try "
        "more settings.intervals"
    )


def remark(problem: BoundaryEquations, z: Array, natural: Array) -> str:
    """That the equations are not met between the points of a mesh whose error is estimated as small; of rows z.

    natural : sizes (n,) of functions that are zero but for rounding.
    """

    def error_of(profile: Profile) -> float:
        own = largest(problem, profile)
        sizes = np.where(own > ROUNDED * natural, own, natural)
        found = defects(problem, profile, profile.h, sizes)
        error = float(found.max())
        if error <= max(UNRESOLVED * problem.tolerance, WORTHLESS * estimate(profile, sizes, closed=False)[0]):
            return 0.0  # as the mesh tells
        moved = defects(problem, profile, profile.h, sizes, shift=NEXT)
        return error if norm(moved - found) < NOISY * norm(found) else 0.0

    worst, where = _worst(problem, z, error_of)
    if worst == 0.0:
        return ""
    return (
        f"the equations are met between the points of the mesh only to {worst:.0e} of the solution's size near "
        f"{problem.parameters[0]} = {where:.6g}, as where a coefficient is singular: values are known to "
        "no more than that. Try other variables there (x = s^2 for a root), or more settings.intervals"
    )


def _worst(problem: BoundaryEquations, z: Array, error_of: Callable[[Profile], float]) -> tuple[float, float]:
    """The largest error in some of the rows z, and the parameter there; (0, 0) where all are within the tolerance."""
    worst, where = 0.0, 0.0
    for row in np.unique(np.linspace(0, len(z) - 1, ROWS).astype(int)):
        error = error_of(problem.profile(z[row]))
        if error > max(worst, UNRESOLVED * problem.tolerance):
            worst, where = error, float(z[row, -1])
    return worst, where
