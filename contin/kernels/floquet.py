"""Multipliers of a periodic orbit from the transition matrices of its mesh intervals, whose product is never formed.

u(x_(i+1)) = M_i u(x_i) for perturbations. The orbit's own direction f is carried along exactly (M_i f_i ~ f_(i+1)), so
each M_i is written in orthonormal bases whose first vector is f: the remaining (n - 1) x (n - 1) blocks B_i belong to
the Poincare map. This keeps the trivial multiplier apart from one that passes through 1 at a fold, where the monodromy
matrix has a Jordan block and its eigenvalues only half of their digits.

The product B_N ... B_1 is kept as Q_N R with orthonormal Q and triangular factors multiplied together, R = R_N ... R_1
(orthogonal iteration on the cycle, Bojanczyk, Golub and Van Dooren 1992 give the periodic Schur form that it
approaches). Its eigenvalues are those of R (Q_0^T Q_N). The rows of that matrix are graded like the multipliers, so
small ones are as accurate as large ones. Two sweeps suffice from any start, one from the basis of a neighbouring orbit.
"""

import math

import numpy as np

from contin.kernels.collocation import LANES
from contin.kernels.compile import allocating, allocating_vector_kernel, kernel, vector_kernel
from contin.kernels.eigen import eigenvalues
from contin.kernels.vector import add_four, subtract_four

KEPT = 0.03  # a column that keeps more than this part of its length is orthogonal to rounding after one projection


@kernel("f3, i, i, f1, f3")
def transitions(local, n, m, weights, out):
    """M_i (N, n, n) from the condensed intervals `local` of `Factors`: minus their blocks of the left end.

    They act on states measured in their sizes, 1 / `weights`: lengths and angles mean something then.
    """
    inner = (m - 2) * n
    for i in range(out.shape[0]):
        for r in range(n):
            for c in range(n):
                value = local[i, inner + r, inner + c] if n > LANES else local[inner + r, inner + c, i]
                out[i, r, c] = -value * (weights[r] / weights[c])


@allocating("f3, f2 -> f")
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


@allocating_vector_kernel("f3, i, f2, f2 -> b")
def sweep(m_all, skip, q, r_product):
    """One turn: q (d, d) orthonormal becomes Q_N, r_product the triangular factor.

    The first `skip` rows and columns are left out.
    """
    count, n, _ = m_all.shape
    d = n - skip
    columns = np.uint64(d)
    y = np.empty((d, d))
    r = np.zeros((d, d))
    s = np.empty((4, d))
    for a in range(d):
        for b in range(d):
            r_product[a, b] = 1.0 if a == b else 0.0
    for i in range(count):
        _times(m_all, i, skip, q, y)
        for a in range(d):
            for b in range(columns):
                q[a, b] = y[a, b]
        for _ in range(2):  # Gram-Schmidt, again where much of a column was cancelled
            lost = _orthonormalise(q, r, s)
            if not lost > 0.0:
                return False
            _times_triangular(r, r_product)
            if lost > KEPT:
                break
    return True


@vector_kernel("f3, i, i, f2, f2")
def _times(m_all, i, skip, q, y):
    """y = M_i q without the first `skip` rows and columns of M_i; four rows of q at once."""
    n, d = m_all.shape[1], q.shape[0]
    columns = np.uint64(d)
    for a in range(d):
        for b in range(columns):
            y[a, b] = 0.0
    first = i * n * n + skip * n + skip
    c = 0
    while c + 4 <= d:
        add_four(y, 0, d, d, q, c * d, d, m_all, first + c, n, 1, d)
        c += 4
    for k in range(c, d):
        for a in range(d):
            x = m_all[i, skip + a, skip + k]
            for b in range(columns):
                y[a, b] += x * q[k, b]


@vector_kernel("f2, f2")
def _times_triangular(r, product):
    """product = r product, both (d, d) upper triangular; four rows at once."""
    d = r.shape[0]
    columns = np.uint64(d)
    first = 0
    while first < d:
        end = min(first + 4, d)
        for a in range(first, end):  # rows below are still the old ones
            x = r[a, a]
            for b in range(np.uint64(a), columns):
                product[a, b] *= x
            for c in range(a + 1, end):
                x = r[a, c]
                for b in range(np.uint64(c), columns):
                    product[a, b] += x * product[c, b]
        c = end
        while c + 4 <= d:
            add_four(product, first * d + c, d, end - first, product, c * d + c, d, r, first * d + c, d, 1, d - c)
            c += 4
        for k in range(c, d):
            for a in range(first, end):
                x = r[a, k]
                for b in range(np.uint64(k), columns):
                    product[a, b] += x * product[k, b]
        first = end


@vector_kernel("f2, f2, f2 -> f")
def _orthonormalise(q, r, s):
    """Columns of q (d, d) become orthonormal, old q = new q r; s (4, d) is memory. Four columns at once.

    Returns the least part of its length that a column kept, 0 where they are dependent.
    """
    d = q.shape[0]
    least = 1.0
    first = 0
    while first < d:
        end = min(first + 4, d)
        for k in range(first, end):
            kept = _next_column(q, r, k, end)
            if not kept > 0.0:
                return 0.0
            least = min(least, kept)
        if end < d:
            _project(q, r, s, first, end)
        first = end
    return least


@vector_kernel("f2, f2, i, i -> f")
def _next_column(q, r, k, end):
    """Column k becomes a unit vector, columns k + 1 .. end - 1 orthogonal to it; returns the part that it had kept."""
    d = q.shape[0]
    square = 0.0
    for a in range(d):
        square += q[a, k] * q[a, k]
    if not square > 0.0:
        return 0.0
    whole = square
    for a in range(k):
        whole += r[a, k] * r[a, k]
    norm = math.sqrt(square)
    r[k, k] = norm
    inverse = 1.0 / norm
    for a in range(d):
        q[a, k] *= inverse
    for b in range(k + 1, end):
        x = 0.0
        for a in range(d):
            x += q[a, k] * q[a, b]
        r[k, b] = x
        for a in range(d):
            q[a, b] -= x * q[a, k]
    return norm / math.sqrt(whole)


@vector_kernel("f2, f2, f2, i, i")
def _project(q, r, s, first, end):
    """Columns from `end` on become orthogonal to columns first .. end - 1 (four)."""
    d = q.shape[0]
    rest = d - end
    for j in range(4):
        for b in range(np.uint64(rest)):
            s[j, b] = 0.0
    a = 0
    while a + 4 <= d:
        add_four(s, 0, d, 4, q, a * d + end, d, q, a * d + first, 1, d, rest)
        a += 4
    for row in range(a, d):
        for j in range(4):
            x = q[row, first + j]
            for b in range(np.uint64(rest)):
                s[j, b] += x * q[row, np.uint64(end) + b]
    for j in range(4):
        for b in range(np.uint64(rest)):
            r[first + j, np.uint64(end) + b] = s[j, b]
    subtract_four(q, end, d, d, s, 0, d, q, first, d, 1, rest)


@allocating("f3, i, f2, f1, f1 -> b")
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
    _closed(r, begin, q, product)
    return eigenvalues(product, re, im, re, im) == 0


@allocating_vector_kernel("f2, f2, f2, f2")
def _closed(r, begin, q, product):
    """product = r (begin^T q), r upper triangular."""
    d = q.shape[0]
    columns = np.uint64(d)
    turned = np.zeros((d, d))
    for k in range(d):
        for a in range(d):
            x = begin[k, a]
            for b in range(columns):
                turned[a, b] += x * q[k, b]
    for a in range(d):
        for b in range(columns):
            product[a, b] = 0.0
        for c in range(a, d):
            x = r[a, c]
            for b in range(columns):
                product[a, b] += x * turned[c, b]
