"""Multipliers of a periodic orbit from the transition matrices of its mesh intervals, without ever forming their
product.

u(x_(i+1)) = M_i u(x_i) for perturbations. The orbit's own direction f is carried along exactly (M_i f_i ~ f_(i+1)), so
each M_i is written in orthonormal bases whose first vector is f: the remaining (n - 1) x (n - 1) blocks B_i belong
to the
Poincare map. This keeps the trivial multiplier apart from one that passes through 1 at a fold, where the monodromy
matrix has a Jordan block and its eigenvalues only half of their digits.

The product B_N ... B_1 is kept as Q_N R with orthonormal Q and triangular factors multiplied together, R = R_N ... R_1
(orthogonal iteration on the cycle, Bojanczyk, Golub and Van Dooren 1992 give the periodic Schur form that it
approaches).
Its eigenvalues are those of R (Q_0^T Q_N). The rows of that matrix are graded like the multipliers, so small ones
are as accurate as large ones. Two sweeps suffice from any start, one from the basis of a neighbouring orbit.
"""

import math

import numpy as np

from contin.kernels.compile import kernel
from contin.kernels.dense import lu_factor, lu_solve
from contin.kernels.eigen import eigenvalues


@kernel
def transitions(local, n, m, out):
    """M_i (N, n, n) from the condensed blocks [left | right] of `collocation_system.factorise`.

    False where one is singular.
    """
    inner = (m - 1) * n
    right = np.empty((n, n))
    column = np.empty(n)
    pivots = np.empty(n, np.int64)
    for i in range(local.shape[2]):
        for r in range(n):
            for c in range(n):
                right[r, c] = local[inner + r, inner + n + c, i]
        if lu_factor(right, pivots) == 0:
            return False
        for c in range(n):
            for r in range(n):
                column[r] = -local[inner + r, inner + c, i]
            lu_solve(right, pivots, column)
            for r in range(n):
                out[i, r, c] = column[r]
    return True


@kernel
def deflate(m_all, directions):
    """Replace every M_i by H_(i+1) M_i H_i, H_i f_i = -+|f_i| e_1 (in place); returns the trivial multiplier.

    directions (N, n): the vector field f at the mesh points, the last of which is the first.
    """
    count, n, _ = m_all.shape
    v = np.empty((count, n))
    for i in range(count):
        norm = 0.0
        for k in range(n):
            norm += directions[i, k] * directions[i, k]
        norm = math.sqrt(norm)
        if not norm > 0.0:
            return math.nan
        for k in range(n):
            v[i, k] = directions[i, k] / norm
        v[i, 0] += 1.0 if v[i, 0] >= 0.0 else -1.0
        size = 0.0
        for k in range(n):
            size += v[i, k] * v[i, k]
        size = math.sqrt(2.0 / size)
        for k in range(n):
            v[i, k] *= size  # H = 1 - v v^T
    trivial = 1.0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        for r in range(n):
            s = 0.0
            for c in range(n):
                s += m_all[i, r, c] * v[i, c]
            for c in range(n):
                m_all[i, r, c] -= s * v[i, c]
        for c in range(n):
            s = 0.0
            for r in range(n):
                s += v[j, r] * m_all[i, r, c]
            for r in range(n):
                m_all[i, r, c] -= v[j, r] * s
        trivial *= m_all[i, 0, 0]
    return trivial


@kernel
def sweep(m_all, skip, q, r_product):
    """One turn: q (d, d) orthonormal becomes Q_N, r_product the triangular factor.

    The first `skip` rows and columns are left out.
    """
    count, n, _ = m_all.shape
    d = n - skip
    y = np.empty((d, d))
    r = np.empty((d, d))
    for a in range(d):
        for b in range(d):
            r_product[a, b] = 1.0 if a == b else 0.0
    for i in range(count):
        for a in range(d):
            for b in range(d):
                s = 0.0
                for c in range(d):
                    s += m_all[i, skip + a, skip + c] * q[c, b]
                y[a, b] = s
        for b in range(d):
            for a in range(d):
                r[a, b] = 0.0
            for _ in range(2):  # Gram-Schmidt, twice
                for c in range(b):
                    s = 0.0
                    for a in range(d):
                        s += q[a, c] * y[a, b]
                    r[c, b] += s
                    for a in range(d):
                        y[a, b] -= s * q[a, c]
            s = 0.0
            for a in range(d):
                s += y[a, b] * y[a, b]
            s = math.sqrt(s)
            r[b, b] = s
            if not s > 0.0:
                return False
            for a in range(d):
                q[a, b] = y[a, b] / s
        for b in range(d):
            for a in range(b + 1):
                s = 0.0
                for c in range(a, b + 1):
                    s += r[a, c] * r_product[c, b]
                y[a, b] = s
        for b in range(d):
            for a in range(b + 1):
                r_product[a, b] = y[a, b]
    return True


@kernel
def multipliers(m_all, skip, q, re, im):
    """Multipliers of the cycle into re and im (d,), d = n - skip; q (d, d) is the basis of a neighbour, or NaN.

    q becomes the basis at the end of the cycle. re, im on entry: those of a neighbour, or NaN. Returns False on
    failure.
    """
    n = m_all.shape[1]
    d = n - skip
    if d == 0:
        return True
    sweeps = 1
    if not math.isfinite(q[0, 0]):
        sweeps = 3
        for a in range(d):
            for b in range(d):
                q[a, b] = 1.0 if a == b else 0.0
    begin = np.empty((d, d))
    r = np.empty((d, d))
    for _ in range(sweeps):
        for a in range(d):
            for b in range(d):
                begin[a, b] = q[a, b]
        if not sweep(m_all, skip, q, r):
            q[0, 0] = math.nan
            return False
    product = np.empty((d, d))
    for a in range(d):
        for b in range(d):
            s = 0.0
            for c in range(a, d):
                w = 0.0
                for k in range(d):
                    w += begin[k, c] * q[k, b]
                s += r[a, c] * w
            product[a, b] = s
    return eigenvalues(product, re, im, re, im) == 0
