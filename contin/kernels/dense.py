"""Small dense linear algebra without LAPACK: for n below about 20 a plain loop is faster than the call."""

from contin.kernels.compile import kernel


@kernel("f1, f1")
def assign(target, source):
    """target = source, both of one length (numba's own assignment of slices needs its runtime, for its messages)."""
    for i in range(target.size):
        target[i] = source[i]


@kernel("f2, i1, f1, i, f2 -> i")
def lu_factor_weighted(a, pivots, sizes, count, weights):
    """As `lu_factor`, where rows are compared with their weights: `sizes` of the first `count`, 1 of the others.

    weights (n, .) is memory for them.
    """
    n = a.shape[0]
    sign = 1
    for i in range(n):
        weights[i, 0] = sizes[i] if i < count else 1.0
    for k in range(n):
        p = k
        largest = abs(a[k, k]) * weights[k, 0]
        for i in range(k + 1, n):
            size = abs(a[i, k]) * weights[i, 0]
            if size > largest:
                largest = size
                p = i
        pivots[k] = p
        if not largest > 0.0:  # zero or NaN
            return 0
        if p != k:
            sign = -sign
            swap = weights[k, 0]
            weights[k, 0] = weights[p, 0]
            weights[p, 0] = swap
            for j in range(n):
                swap = a[k, j]
                a[k, j] = a[p, j]
                a[p, j] = swap
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, n):
            factor = a[i, k] * inverse
            a[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]
    return sign


@kernel("f2, i1 -> i")
def lu_factor(a, pivots):
    """Factor `a` (n, n) in place, P a = L U with partial pivoting; returns the sign of P, 0 where a pivot vanishes."""
    n = a.shape[0]
    sign = 1
    for k in range(n):
        p = k
        largest = abs(a[k, k])
        for i in range(k + 1, n):
            if abs(a[i, k]) > largest:
                largest = abs(a[i, k])
                p = i
        pivots[k] = p
        if not largest > 0.0:  # zero or NaN
            return 0
        if p != k:
            sign = -sign
            for j in range(n):
                swap = a[k, j]
                a[k, j] = a[p, j]
                a[p, j] = swap
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, n):
            factor = a[i, k] * inverse
            a[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    a[i, j] -= factor * a[k, j]
    return sign


@kernel("f2, i1, f1")
def lu_solve(a, pivots, b):
    """Solve with the factors of `lu_factor`, `b` (n,) in place."""
    n = a.shape[0]
    for k in range(n):  # all exchanges first: the stored multipliers are in their final rows
        p = pivots[k]
        if p != k:
            swap = b[k]
            b[k] = b[p]
            b[p] = swap
    for i in range(1, n):
        s = b[i]
        for j in range(i):
            s -= a[i, j] * b[j]
        b[i] = s
    for i in range(n - 1, -1, -1):
        s = b[i]
        for j in range(i + 1, n):
            s -= a[i, j] * b[j]
        b[i] = s / a[i, i]
