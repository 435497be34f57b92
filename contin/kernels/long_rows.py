"""A few long rows: products and combinations that pass through memory once, and how far a sparse matrix is symmetric.

What numpy does row by row reads rows of a million numbers again for every product; here a stretch of all rows stays in
the processor's cache until everything is computed from it. Sums are those of one thread, in one order.
"""

import numpy as np

from contin.kernels.compile import kernel, vector_kernel

STRETCH = 512  # numbers of a row: of 16 rows these are 64 kB


@vector_kernel("f2, f2, f2")
def products_of_rows(a, b, out):
    """out[i, j] = <a_i, b_j>, rows a (k, n) and b (l, n)."""
    n = a.shape[1]
    out[:, :] = 0.0
    for first in range(0, n, STRETCH):
        last = min(first + STRETCH, n)
        for i in range(a.shape[0]):
            for j in range(b.shape[0]):
                total = 0.0
                for k in range(np.uint64(first), np.uint64(last)):
                    total += a[i, k] * b[j, k]
                out[i, j] += total


@vector_kernel("f2, f2, f2")
def add_combinations(weights, rows, out):
    """out_i += sum_j weights[i, j] rows_j, out (k, n)."""
    n = rows.shape[1]
    for first in range(0, n, STRETCH):
        last = min(first + STRETCH, n)
        for i in range(out.shape[0]):
            for j in range(rows.shape[0]):
                weight = weights[i, j]
                for k in range(np.uint64(first), np.uint64(last)):
                    out[i, k] += weight * rows[j, k]


@kernel("f1, i1, i1, i1 -> (f, f)")
def edges_of_parts(data, partner, starts, diagonal):
    """The largest Gershgorin bound of the symmetric part of a CSC matrix, and the largest column sum of the other one.

    partner : place of the entry (j, i) of each entry (i, j).  diagonal (n,) : place of each diagonal entry, or -1.
    """
    right, up = -np.inf, 0.0
    for j in range(starts.size - 1):
        symmetric, skew = 0.0, 0.0
        for place in range(starts[j], starts[j + 1]):
            here, other = data[place], data[partner[place]]
            both = 0.5 * (here + other)
            symmetric += both if place == diagonal[j] else abs(both)
            skew += 0.5 * abs(here - other)
        right = max(right, symmetric)
        up = max(up, skew)
    return right, up
