"""The sign of a bordered determinant along a curve in two parameters: it changes where another curve crosses."""

import math

import numpy as np

from contin.kernels.algebraic import diagonal_sign, log_determinant
from contin.kernels.compile import allocating, kernel
from contin.kernels.null_vectors import leading_block, null_vectors

BRANCH = 2
ALIGNED = 0.3  # sine of the angle of v and w = f_u v below which v is near an eigenvector


@allocating("i, i, i, f2, f2, f2, f1, f1, f1, f1 -> (f, f)")
def side_of(kind, n, sign, matrix, jacobian, block, z, scale, before, right):
    """Sign and log of det [F_z; tangent] from its factors; of branch points, over <w, F_us v>.

    That determinant is <w, F_us v> (grad g x tangent) along branch points g = 0 that something forces, s across the
    curve: both factors change their sign on the other half of a hyperbola.  right (n,) : becomes v, in the sense of
    that `before`.
    """
    side, size = sign * diagonal_sign(matrix), log_determinant(matrix)
    if kind != BRANCH:
        return side, size
    states = np.empty((n, n))
    left = np.empty(n)
    leading_block(block, states)
    null_vectors(states, right, left)
    mixed = 0.0
    along = 0.0
    for j in range(n):
        along += before[j] * right[j]
    for j in range(n):
        if along < 0.0:
            right[j] = -right[j]
        mixed += jacobian[2 * n, j] * scale[j] * right[j]
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
