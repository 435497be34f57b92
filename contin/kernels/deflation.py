"""Newton from many starts at fixed parameters, away from solutions that are known: one kernel call.

Deflation (Farrell, Birkisson and Funke 2015): Newton on M(u) F(u) with M = prod (1/|u - u_i|^2 + 1) does not converge
to any known u_i. Its step is Newton's own step s times 1/(1 - eta . s), eta = grad M / M, so it costs nothing.
"""

import math

import numpy as np

from contin.kernels.compile import allocating, call4, kernel
from contin.kernels.dense import lu_factor, lu_solve

ITERATIONS = 80
LONGEST_STEP = 0.5  # in units of the box
ABANDONED = 3.0  # a trial this many boxes away is given up
CONVERGED = 1e-11


@kernel("i, b, f1, f1, f1, f1, f1, f2, i, f1, f2, f2, i1, f1 -> b")
def deflated_newton(address, is_map, u, p, centre, scale, periods, known, count, f, jacobian, matrix, pivots, step):
    """Newton from u (in place); True where it converged."""
    n = u.size
    before = math.inf
    for _ in range(ITERATIONS):
        call4(address, u, p, f, jacobian)
        total = 0.0
        for i in range(n):
            if is_map:
                f[i] -= u[i]
            for j in range(n):
                value = jacobian[i, j]
                if is_map and i == j:
                    value -= 1.0
                matrix[i, j] = value * scale[j] / scale[i]
                total += matrix[i, j]
            step[i] = -f[i] / scale[i]
            total += step[i]
        if not math.isfinite(total):
            return False
        if lu_factor(matrix, pivots) == 0:
            return False
        lu_solve(matrix, pivots, step)
        size = 0.0
        for j in range(n):
            size = max(size, abs(step[j]))
        if not math.isfinite(size):
            return False
        if size < CONVERGED or (size < 1e-7 and size >= 0.5 * before):
            for j in range(n):
                u[j] += scale[j] * step[j]
            return True
        before = size
        if count > 0 and size > 1e-6:
            slope = 0.0
            for k in range(count):
                square = 0.0
                along = 0.0
                for j in range(n):
                    d = u[j] - known[k, j]
                    if periods[j] > 0.0:
                        d -= periods[j] * np.round(d / periods[j])
                    d /= scale[j]
                    square += d * d
                    along += d * step[j]
                if square > 0.0:
                    slope -= 2.0 * along / (square * (1.0 + square))
            denominator = 1.0 - slope
            factor = 1.0 / denominator if denominator != 0.0 else 1.0
            for j in range(n):
                step[j] *= factor
            size *= abs(factor)
            before = math.inf
        damping = min(1.0, LONGEST_STEP / size)
        for j in range(n):
            u[j] += damping * scale[j] * step[j]
            if periods[j] == 0.0 and abs(u[j] - centre[j]) > ABANDONED * scale[j]:
                return False
    return False


@allocating("i, b, f2, f1, f1, f1, f1, f2, i, f2, b1")
def search(address, is_map, starts, p, centre, scale, periods, known, count, out, status):
    """`deflated_newton` from every row of starts (N, n), deflating the first `count` rows of known; see out, status."""
    n = starts.shape[1]
    f = np.empty(n)
    jacobian = np.empty((n, n + p.size))
    matrix = np.empty((n, n))
    pivots = np.empty(n, np.int64)
    step = np.empty(n)
    for k in range(starts.shape[0]):
        for j in range(n):
            out[k, j] = starts[k, j]
        status[k] = deflated_newton(
            address, is_map, out[k], p, centre, scale, periods, known, count, f, jacobian, matrix, pivots, step
        )
