"""Saddle-nodes that homoclinic orbits return to: the fold as a scalar equation, and how central the orbit is.

A saddle-node has one zero eigenvalue, f_u q = 0, p^T f_u = 0. The orbit leaves it along q, on the side where the flow
on the centre manifold leads away, and comes back on the other side, tangent to q as well: a central homoclinic orbit,
which lasts along a curve of folds. Where it comes back (or leaves) along another direction, it is non-central (NCH):
there the curve of homoclinic orbits to a saddle begins (Schecter, SIAM J. Math. Anal. 18 (1987) 1142; Champneys,
Kuznetsov and Sandstede 1996).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.systems.protocol import System

STEP: Final = 1e-3  # of the second difference, relative to the states' sizes


def borders(matrix: Array) -> tuple[Array, Array]:
    """Left and right singular vectors of the smallest singular value, the matrix' norm taken into the first one."""
    left, values, right = np.linalg.svd(matrix)
    return left[:, -1] * float(values[0]), right[-1]


def fold_scalar(matrix: Array, b: Array, c: Array) -> float:
    """g of [A b; c^T 0] [v; g] = [0; 1]: zero where A is singular."""
    n = len(matrix)
    bordered = np.zeros((n + 1, n + 1))
    bordered[:n, :n], bordered[:n, n], bordered[n, :n] = matrix, b, c
    return float(np.linalg.solve(bordered, np.append(np.zeros(n), 1.0))[n])


def critical_direction(matrix: Array) -> tuple[Array, Array]:
    """Left and right eigenvectors p, q of the eigenvalue next to zero, |q| = 1, <p, q> = 1."""
    values, right = np.linalg.eig(matrix)
    q = np.real(right[:, int(np.argmin(np.abs(values)))])
    others, left = np.linalg.eig(matrix.T)
    p = np.real(left[:, int(np.argmin(np.abs(others)))])
    return p / float(p @ q), q


def quadratic(system: System, u: Array, p: Array, sizes: Array, left: Array, q: Array) -> float:
    """<left, f_uu(q, q)> / 2 in states relative to their sizes, by a second difference."""
    before, here, after = (system.value(u + s * STEP * sizes * q, p) for s in (-1.0, 0.0, 1.0))
    return 0.5 * float(left @ ((before - 2.0 * here + after) / sizes)) / elementary.square(STEP)


def centrality(matrix: Array, leaving: Array, arriving: Array, extent: float) -> float:
    """Positive for a central orbit, zero for a non-central one; leaving, arriving : u(0) - x0 and u(1) - x0.

    Of the parts along q of both ends one is positive and the other negative; the smaller one (relative to the orbit's
    extent) vanishes at NCH.
    """
    p, _ = critical_direction(matrix)
    first, last = float(p @ leaving), float(p @ arriving)
    sense = 1.0 if first >= last else -1.0
    return min(sense * first, -sense * last) / extent
