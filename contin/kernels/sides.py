"""The sign of a bordered determinant along a curve in two parameters: it changes where another curve crosses."""

import math

import numpy as np

from contin.kernels.algebraic import diagonal_sign, log_determinant
from contin.kernels.compile import allocating, kernel
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.null_vectors import leading_block, null_vectors

BRANCH = 2
ROUNDING = 1e-12  # part of the moduli of its terms up to which a sum is rounding
ALIGNED = 0.3  # sine of the angle of v and w = f_u v below which v is near an eigenvector


@allocating("f2, f2, i, f1, f1, f1, f1 -> f")
def mixed_coefficient(states, jacobian, active, p, scale, right, left):
    """k = <w, F_us v + F_uu phi v> of branch points, F_u phi = -F_s: the solution that is always there moves with s.

    s : the direction across the curve, of whose parts the last two parameters are.  states : scaled F_u.
    0 where it is no more than rounding.
    """
    n, size = right.size, jacobian.shape[0]
    along_first, along_second = p[p.size - 2], p[p.size - 1]
    bordered, pivots = np.zeros((n + 1, n + 1)), np.empty(n + 1, np.int64)
    phi = np.zeros(n + 1)
    for i in range(n):
        for j in range(n):
            bordered[i, j] = states[i, j]
        bordered[i, n] = left[i]
        bordered[n, i] = right[i]
        phi[i] = -(along_first * jacobian[i, size + active] + along_second * jacobian[i, size - 1]) / scale[i]
    if lu_factor(bordered, pivots) == 0:
        return 0.0
    lu_solve(bordered, pivots, phi)
    mixed, terms = 0.0, 0.0
    for j in range(n):
        own = scale[j] * right[j]
        value = jacobian[2 * n, j] * own
        mixed += value
        terms += abs(value)
        for i in range(n):
            value = phi[i] * scale[i] * jacobian[n + i, j] * own
            mixed += value
            terms += abs(value)
    return mixed if abs(mixed) > ROUNDING * terms else 0.0


@allocating("i, i, i, f2, f2, f2, f1, f1, i, f1, f1, f1 -> (f, f)")
def side_of(kind, n, sign, matrix, jacobian, block, z, p, active, scale, before, right):
    """Sign and log of det [F_z; tangent] from its factors; of branch points, over their mixed coefficient k.

    That determinant is k (grad g x tangent) along branch points g = 0 that something forces: both factors change their
    sign on the other half of a hyperbola.  right (n,) : becomes v, in the sense of that `before`.
    """
    side, size = sign * diagonal_sign(matrix), log_determinant(matrix)
    if kind != BRANCH:
        return side, size
    states = np.empty((n, n))
    left = np.empty(n)
    leading_block(block, states)
    null_vectors(states.copy(), right, left)
    along = 0.0
    for j in range(n):
        along += before[j] * right[j]
    for j in range(n):
        if along < 0.0:
            right[j] = -right[j]
    mixed = mixed_coefficient(states, jacobian, active, p, scale, right, left)
    if mixed == 0.0:
        return side, size
    return side if mixed > 0.0 else -side, size - math.log(abs(mixed))


@kernel("f1, i, f1 -> b")
def is_aligned(z, n, scale):
    """Of neutral saddles on a curve of Hopf points: v is near an eigenvector, where the system is singular."""
    vv, ww, vw = 0.0, 0.0, 0.0
    for j in range(n):
        v = z[n + j] / scale[j]
        w = z[2 * n + j] / scale[j]
        vv += v * v
        ww += w * w
        vw += v * w
    return vw * vw > (1.0 - ALIGNED * ALIGNED) * vv * ww
