"""Sizes of the functions of a boundary-value problem where the solution itself has none.

A function u_k is noticed by the equation u_i' = F_i at the size u_i / (largest |dF_i / du_k|): there it moves u_i by
its own size along the interval, which is 1 in scaled time. Sizes far below that are rounding of zero (a derivative at a
constant solution, an eigenvalue at 0); the size at which it would be noticed is the natural one. All of it is
independent of the functions' units.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations
    from contin.problems.orbits.mesh.layout import Profile

APART: Final = 1e-8  # ratio of sizes between functions that may be remnants of zeros and the others
DEGREES: Final = (1, 2, 3, 4)  # of equations that remnants of zeros may obey
FAINT: Final = 1e-8  # part of the noticed size below which a motion may be what Newton's method has left
ROUNDING: Final = 1e-18  # part of a number below which nothing is rounding of it
UNDETERMINED: Final = 64.0 * np.finfo(float).eps  # of the terms of an equation
UNNOTICED: Final = 1e-11  # part of the noticed size that may be what remains of a zero after a Newton step


def without_remnants(problem: BoundaryEquations, z: Array) -> Array:
    """z with zeros in place of functions that are what Newton's method leaves of a zero, 1e-60 beside others of 1.

    They are small beside the others, no other equation and no condition notices whether they are there, and their own
    equations are homogeneous in them: doubled, each is 2^k times what it was. So their size is that of nothing. (Small
    functions in units of their own are noticed by something, or by their own nonlinear terms.)
    """
    profile = problem.profile(z)
    sizes = np.abs(profile.u).max(axis=0)
    for bound in np.unique(sizes)[::-1]:
        small = (sizes <= bound) & (sizes > 0.0)
        others = sizes[~small]
        if others.any() and bound < APART * others[others > 0.0].min() and _is_remnant(problem, profile, z, small):
            u = np.where(small, 0.0, profile.u)
            return replace(profile, u=u).vector()
    return z


def _is_remnant(problem: BoundaryEquations, profile: Profile, z: Array, small: NDArray[np.bool_]) -> bool:
    p = np.tile(problem.full_parameters(z), (len(profile.u), 1))
    p[:, -1] = profile.times
    values, ends = [], []
    for factor in (1.0, 2.0, 0.0):
        u = np.where(small, factor * profile.u, profile.u)
        values.append(np.asarray(problem.two.system.jacobians(u, p)[0])[:, : problem.n])
        ends.append(problem.two.conditions.jacobian(u[0], u[-1], p[0, :-1]))
    if not all(np.isfinite(f).all() and np.isfinite(g[0]).all() for f, g in zip(values, ends, strict=True)):
        return False
    once, twice, without = values
    sizes = np.abs(profile.u).max(axis=0)
    slack = UNDETERMINED * np.maximum(np.abs(once).max(axis=0), sizes)
    own = np.zeros(len(sizes), dtype=bool)
    for k in DEGREES:
        own |= (np.abs(twice - 2.0**k * once) <= 2.0**k * UNDETERMINED * np.abs(once).max(axis=0)).all(axis=0)
    unchanged = ((np.abs(twice - once) <= slack) & (np.abs(without - once) <= slack)).all(axis=0)
    zero = (np.abs(without) <= slack).all(axis=0)
    (g, by_ends), (g2, _), (g0, _) = ends
    noticed = np.abs(np.asarray(by_ends)[:, : 2 * len(sizes)])
    loose = UNDETERMINED * (noticed @ np.tile(sizes, 2))
    kept = (np.abs(g2 - g) <= loose) & (np.abs(g0 - g) <= loose) | (np.abs(g2 - 2.0 * g) <= loose) & (
        np.abs(g0) <= loose
    )
    return bool(np.where(small, own & zero, unchanged).all() and kept.all())


def largest(problem: BoundaryEquations, profile: Profile) -> Array:
    """Largest modulus of every function, (n,); of an integral I' = F_i at least int sum_k |dF_i / du_k| |u_k| ds.

    An integral whose terms cancel (a phase condition along the solution it refers to) is known to what its terms are
    known to; a size of its own rounding would ask the mesh for digits that are not there.
    """
    sizes = np.asarray(np.abs(profile.u).max(axis=0))
    first = problem.two.n_states + len(problem.two.free)
    if first < problem.n:
        p = np.tile(problem.full_parameters(profile.vector()), (len(profile.u), 1))
        p[:, -1] = profile.times
        matrices = np.asarray(problem.two.system.jacobians(profile.u, p)[1])[:, first : problem.n, : problem.n]
        terms = np.einsum("tik,tk->ti", np.abs(matrices), np.abs(profile.u))
        total = np.trapezoid(np.where(np.isfinite(terms), terms, 0.0), profile.times, axis=0)
        sizes[first:] = np.maximum(sizes[first:], total)
    return sizes


def couplings(problem: BoundaryEquations, z: Array) -> Array:
    """Largest |dF_i / du_k| over the mesh points, (n, n); entries that are not finite count as zero."""
    profile = problem.profile(z)
    at = slice(None, None, problem.points)
    p = np.tile(problem.full_parameters(z), (profile.intervals + 1, 1))
    p[:, -1] = profile.times[at]
    _, matrices = problem.two.system.jacobians(profile.u[at], p)
    steep = np.abs(np.asarray(matrices)[:, :, : problem.n])
    largest = np.where(np.isfinite(steep), steep, 0.0).max(axis=0)
    np.fill_diagonal(largest, 0.0)
    return np.asarray(largest)


def noticed(sizes: Array, coupling: Array) -> Array:
    """`sizes` (n,), zero where no equation notices them."""
    return np.where(sizes > UNNOTICED * _noticeable(sizes, coupling), sizes, 0.0)


def moved(seen: Array, motion: Array, coupling: Array) -> Array:
    """Sizes (n,): those that are seen, else how far the parameter moves a function, if one that is known notices it.

    Where nothing but rounding moves a whole cluster of functions, its members notice one another. A motion that is less
    than rounding of the noticed size is one all the same: the coupling is rounding. What no equation notices (an
    integral in a condition) and rounding alone moves has the size of its own equation's terms.
    """
    known = seen.copy()
    for _ in range(len(seen)):
        natural = _noticeable(known, coupling)
        new = (known == 0.0) & (natural > 0.0)
        if not new.any():
            break
        left = (motion <= FAINT * natural) & ((motion == 0.0) | (motion > ROUNDING * natural))
        known[new] = np.where(left, natural, motion)[new]
    made = coupling @ known
    known = np.where((known == 0.0) & (motion <= UNNOTICED * made), made, known)
    return np.where(known > 0.0, known, motion)


def filled(sizes: Array, coupling: Array) -> Array:
    """`sizes` with the natural one in place of zeros; where nothing gives one, the largest of the others (or 1)."""
    out = sizes.copy()
    for _ in range(len(sizes)):
        natural = _noticeable(out, coupling)
        empty = (out == 0.0) & (natural > 0.0)
        if not empty.any():
            break
        out[empty] = natural[empty]
    return np.where(out > 0.0, out, out.max(initial=0.0) or 1.0)


def _noticeable(sizes: Array, coupling: Array) -> Array:
    """The smallest size at which each function is noticed by one whose size is known, (n,); 0 where by none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        each = np.where((coupling > 0.0) & (sizes[:, None] > 0.0), sizes[:, None] / coupling, np.inf)
    least = each.min(axis=0)
    return np.where(np.isfinite(least), least, 0.0)
