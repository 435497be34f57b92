"""Gaussian elimination of many small matrices at once.

The matrices a[:, :, i] (rows, columns, lanes) are independent. The innermost loops run over the lanes, which are
contiguous in memory, so they become vector instructions whatever the size of a matrix. Pivots are chosen lane by lane;
rows are exchanged only where the natural pivot is small (threshold pivoting), which is rare on a mesh that resolves the
solution, so that the lanes stay together.
"""

import numpy as np

from contin.kernels.compile import vector_kernel

THRESHOLD = 0.1  # the natural pivot is kept while it exceeds this part of the largest candidate


@vector_kernel
def eliminate(a, count, candidates, low, high, pivots, work):
    """Eliminate columns 0 .. count - 1 of lanes low .. high - 1, pivots from the first `candidates` rows.

    All rows below are updated and multipliers are stored below the diagonal. pivots (count, lanes), work (lanes,).
    Returns the sign of the product of all pivots and row exchanges; 0 where a pivot vanishes or is NaN.
    """
    rows, width, _ = a.shape
    sign = 1
    for k in range(count):
        for i in range(np.uint64(low), np.uint64(high)):
            work[i] = abs(a[k, k, i])
            pivots[k, i] = k
        for r in range(k + 1, candidates):
            for i in range(np.uint64(low), np.uint64(high)):
                size = abs(a[r, k, i])
                if size > work[i]:
                    work[i] = size
                    pivots[k, i] = r
        for i in range(np.uint64(low), np.uint64(high)):
            p = pivots[k, i]
            if p != k:
                if abs(a[k, k, i]) >= THRESHOLD * work[i]:
                    pivots[k, i] = k
                else:
                    sign = -sign
                    for c in range(width):
                        swap = a[k, c, i]
                        a[k, c, i] = a[p, c, i]
                        a[p, c, i] = swap
        for i in range(np.uint64(low), np.uint64(high)):
            pivot = a[k, k, i]
            if not abs(pivot) > 0.0:
                return 0
            if pivot < 0.0:
                sign = -sign
            work[i] = 1.0 / pivot
        for r in range(k + 1, rows):
            for i in range(np.uint64(low), np.uint64(high)):
                a[r, k, i] *= work[i]
            for c in range(k + 1, width):
                for i in range(np.uint64(low), np.uint64(high)):
                    a[r, c, i] -= a[r, k, i] * a[k, c, i]
    return sign


@vector_kernel
def eliminate_right(a, count, low, high, pivots, right):
    """The same operations on right-hand sides (rows, lanes), with the factors of `eliminate`."""
    rows = a.shape[0]
    for k in range(count):
        for i in range(np.uint64(low), np.uint64(high)):
            p = pivots[k, i]
            if p != k:
                swap = right[k, i]
                right[k, i] = right[p, i]
                right[p, i] = swap
    for k in range(count):
        for r in range(k + 1, rows):
            for i in range(np.uint64(low), np.uint64(high)):
                right[r, i] -= a[r, k, i] * right[k, i]


@vector_kernel
def substitute_back(a, count, low, high, known, right):
    """Solve rows 0 .. count - 1 for their unknowns, given those of the other columns.

    known (width - count, lanes) are the values that belong to the columns from `count` on; the solution replaces
    right[:count].
    """
    width = a.shape[1]
    for k in range(count - 1, -1, -1):
        for c in range(count, width):
            for i in range(np.uint64(low), np.uint64(high)):
                right[k, i] -= a[k, c, i] * known[c - count, i]
        for c in range(k + 1, count):
            for i in range(np.uint64(low), np.uint64(high)):
                right[k, i] -= a[k, c, i] * right[c, i]
        for i in range(np.uint64(low), np.uint64(high)):
            right[k, i] /= a[k, k, i]
