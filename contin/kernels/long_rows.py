"""A few long rows: products and combinations that pass through memory once, and how far a sparse matrix is symmetric.

What numpy does row by row reads rows of a million numbers again for every product; here a stretch of all rows stays in
the processor's cache until everything is computed from it. Sums are those of one thread, in one order.
"""

import numpy as np

from contin.kernels.compile import kernel, vector_kernel

STRETCH = 512  # numbers of a row: of 16 rows these are 64 kB


@vector_kernel("f2, f2, i, i, f2")
def products_of_rows(a, b, begin, end, out):
    """out[i, j] = <a_i, b_j> of their numbers from `begin` to `end`, rows a (k, n) and b (l, n)."""
    out[:, :] = 0.0
    for first in range(begin, end, STRETCH):
        last = min(first + STRETCH, end)
        for i in range(a.shape[0]):
            for j in range(b.shape[0]):
                total = 0.0
                for k in range(np.uint64(first), np.uint64(last)):
                    total += a[i, k] * b[j, k]
                out[i, j] += total


@vector_kernel("f2, f2, i, i, f2")
def add_combinations(weights, rows, begin, end, out):
    """out_i += sum_j weights[i, j] rows_j, out (k, n), from `begin` to `end`."""
    for first in range(begin, end, STRETCH):
        last = min(first + STRETCH, end)
        for i in range(out.shape[0]):
            for j in range(rows.shape[0]):
                weight = weights[i, j]
                for k in range(np.uint64(first), np.uint64(last)):
                    out[i, k] += weight * rows[j, k]


@vector_kernel("f1, f2, f1, i, i, f1")
def add_and_multiply(weights, rows, w, begin, end, out):
    """w += sum_j weights_j rows_j; then out_j = <rows_j, w>, and behind them <w, w>."""
    count = rows.shape[0]
    out[:] = 0.0
    for first in range(begin, end, STRETCH):
        last = min(first + STRETCH, end)
        for j in range(count):
            weight = weights[j]
            for k in range(np.uint64(first), np.uint64(last)):
                w[k] += weight * rows[j, k]
        for j in range(count):
            total = 0.0
            for k in range(np.uint64(first), np.uint64(last)):
                total += rows[j, k] * w[k]
            out[j] += total
        total = 0.0
        for k in range(np.uint64(first), np.uint64(last)):
            total += w[k] * w[k]
        out[count] += total


@vector_kernel("f1, f1, i, i -> f")
def square_in_units(x, units, begin, end):
    """sum (x_k / units_k)^2"""
    total = 0.0
    for k in range(np.uint64(begin), np.uint64(end)):
        part = x[k] / units[k]
        total += part * part
    return total


@vector_kernel("f1, f1, f, i, i, f1")
def add_multiple(x, row, weight, begin, end, out):
    """out = x + weight row, of the first numbers of each."""
    for k in range(np.uint64(begin), np.uint64(end)):
        out[k] = x[k] + weight * row[k]


@kernel("i1, i1, f1, f1, i, i, f1")
def product_by_rows(starts, columns, data, x, begin, end, out):
    """out_i = (A x)_i, A in CSR form; columns : two 32-bit ones in each number."""
    for i in range(np.uint64(begin), np.uint64(end)):
        total = 0.0
        for place in range(np.uint64(starts[i]), np.uint64(starts[i + 1])):
            pair = columns[place >> np.uint64(1)]
            column = (pair >> 32) if place & np.uint64(1) else (pair & 0xFFFFFFFF)
            total += data[place] * x[np.uint64(column)]
        out[i] = total


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
