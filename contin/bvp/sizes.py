"""Sizes of the functions of a boundary-value problem where the solution itself has none.

A function u_k is noticed by the equation u_i' = F_i at the size u_i / (largest |dF_i / du_k|): there it moves u_i by
its own size along the interval, which is 1 in scaled time. Sizes far below that are rounding of zero (a derivative at a
constant solution, an eigenvalue at 0); the size at which it would be noticed is the natural one. All of it is
independent of the functions' units.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.bvp.boundary_equations import BoundaryEquations

FAINT: Final = 1e-8  # part of the noticed size below which a motion may be what Newton's method has left
ROUNDING: Final = 1e-18  # part of a number below which nothing is rounding of it
UNNOTICED: Final = 1e-11  # part of the noticed size that may be what remains of a zero after a Newton step


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
    than rounding of the noticed size is one all the same: the coupling is rounding.
    """
    known = seen.copy()
    for _ in range(len(seen)):
        natural = _noticeable(known, coupling)
        new = (known == 0.0) & (natural > 0.0)
        if not new.any():
            break
        left = (motion <= FAINT * natural) & ((motion == 0.0) | (motion > ROUNDING * natural))
        known[new] = np.where(left, natural, motion)[new]
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
