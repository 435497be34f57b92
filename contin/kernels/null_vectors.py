"""Null vectors of a nearly singular matrix, with the sense that its adjugate gives them."""

import math

import numpy as np

from contin.kernels.compile import allocating, kernel


@allocating("f2, f1, f1 -> f")
def null_vectors(a, right, left):
    """Unit null vectors of a nearly singular matrix (destroyed) by elimination with complete pivoting.

    Oriented such that adj(a) = c right left^T with c > 0; returns the product of all pivots but the last, with its sign
    absorbed in the orientation (so >= 0).
    """
    n = a.shape[0]
    rows = np.arange(n)
    columns = np.arange(n)
    product = 1.0
    for k in range(n - 1):
        r = k
        c = k
        largest = -1.0
        for i in range(k, n):
            for j in range(k, n):
                if abs(a[i, j]) > largest:
                    largest = abs(a[i, j])
                    r = i
                    c = j
        if r != k:
            product = -product
            rows[k], rows[r] = rows[r], rows[k]
            for j in range(n):
                a[k, j], a[r, j] = a[r, j], a[k, j]
        if c != k:
            product = -product
            columns[k], columns[c] = columns[c], columns[k]
            for i in range(n):
                a[i, k], a[i, c] = a[i, c], a[i, k]
        if not largest > 0.0:
            product = 0.0
            break
        product *= a[k, k]
        for i in range(k + 1, n):
            a[i, k] /= a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= a[i, k] * a[k, j]
    x = np.zeros(n)
    y = np.zeros(n)
    x[n - 1] = 1.0
    y[n - 1] = 1.0
    for i in range(n - 2, -1, -1):
        s = 0.0
        t = 0.0
        for j in range(i + 1, n):
            s -= a[i, j] * x[j]
            t -= a[j, i] * y[j]
        x[i] = s / a[i, i] if a[i, i] != 0.0 else 0.0
        y[i] = t
    x_norm = 0.0
    y_norm = 0.0
    for i in range(n):
        x_norm += x[i] * x[i]
        y_norm += y[i] * y[i]
    x_norm = math.sqrt(x_norm)
    y_norm = math.sqrt(y_norm)
    sign = -1.0 if product < 0.0 else 1.0
    for i in range(n):
        right[columns[i]] = sign * x[i] / x_norm
        left[rows[i]] = y[i] / y_norm
    return abs(product)


@kernel("f2, f2")
def leading_block(matrix, out):
    """out (n, n) = the first n rows and columns of matrix."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = matrix[i, j]
