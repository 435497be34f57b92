"""Gaussian elimination of many small matrices at once.

The matrices a[:, :, i] (rows, columns, lanes) are independent. Vector instructions run over the lanes, which are
contiguous in memory, whatever the size of a matrix (`contin.kernels.lanes`). Pivots are chosen lane by lane;
rows are exchanged only where the natural pivot is small (threshold pivoting), which is rare on a mesh that resolves the
solution, so that the lanes stay together.
"""

import numpy as np

from contin.kernels.compile import vector_kernel
from contin.kernels.lanes import address, backward_lanes, forward_lanes, subtract_products

THRESHOLD = 0.1  # the natural pivot is kept while it exceeds this part of the largest candidate


@vector_kernel("f3, i, i, i, i, i2, f1, f2, f1 -> i")
def eliminate(a, count, candidates, low, high, pivots, sizes, weights, work):
    """Eliminate columns 0 .. count - 1 of lanes low .. high - 1, pivots from the first `candidates` rows.

    Rows are compared with their weights, `sizes` (candidates,); weights (candidates, lanes) is memory for them.

    All rows below are updated and multipliers are stored below the diagonal. pivots (count, lanes), work (lanes,).
    Crout's order: of column k and row k all that was eliminated before is subtracted at once when they are needed.
    Returns the sign of the product of all pivots and row exchanges; 0 where a pivot vanishes or is NaN.
    """
    rows, width, far = a.shape
    step, lanes = width * far, high - low
    sign = 1
    first, end = np.uint64(low), np.uint64(high)
    _weigh(weights, sizes, candidates, low, high)
    for k in range(count):
        row, column, here = address(a, k * step + low), address(a, k * far + low), address(a, k * (step + far) + low)
        subtract_products(here, step, rows - k, 1, row, step, column, step, k, far, lanes)
        for i in range(first, end):
            work[i] = weights[k, i] * abs(a[k, k, i])
        for r in range(k + 1, candidates):
            for i in range(first, end):
                work[i] = max(work[i], weights[r, i] * abs(a[r, k, i]))
        small = 0
        for i in range(first, end):
            pivots[k, i] = k
            small += 0 if weights[k, i] * abs(a[k, k, i]) >= THRESHOLD * work[i] else 1
        if small > 0:
            sign *= _exchange(a, k, candidates, low, high, pivots, weights, work)
        negative = 0
        unfit = 0
        for i in range(first, end):
            work[i] = 1.0 / a[k, k, i]
            negative += 1 if work[i] < 0.0 else 0
            unfit += 0 if abs(work[i]) < np.inf else 1
        if unfit > 0:
            return 0
        if negative % 2 == 1:
            sign = -sign
        for r in range(k + 1, rows):
            for i in range(first, end):
                a[r, k, i] *= work[i]
        after, above = address(a, k * step + (k + 1) * far + low), address(a, (k + 1) * far + low)
        subtract_products(after, step, 1, width - k - 1, row, step, above, step, k, far, lanes)
    below, rest = address(a, count * step + low), address(a, count * step + count * far + low)
    right = address(a, count * far + low)
    subtract_products(rest, step, rows - count, width - count, below, step, right, step, count, far, lanes)
    return sign


@vector_kernel("f3, i2, f1, f2, f1 -> i")
def invert(a, pivots, sizes, weights, work):
    """All a[:, :, i] (d, d) become their inverses, in place (Gauss-Jordan). pivots (d, lanes) and work are memory.

    sizes and weights as in `eliminate`. Returns the sign of the product of the determinants; 0 where a pivot vanishes
    or is NaN.
    """
    d, _, lanes = a.shape
    sign = 1
    end = np.uint64(lanes)
    _weigh(weights, sizes, d, 0, lanes)
    for k in range(d):
        for i in range(end):
            work[i] = weights[k, i] * abs(a[k, k, i])
        for r in range(k + 1, d):
            for i in range(end):
                work[i] = max(work[i], weights[r, i] * abs(a[r, k, i]))
        small = 0
        for i in range(end):
            pivots[k, i] = k
            small += 0 if weights[k, i] * abs(a[k, k, i]) >= THRESHOLD * work[i] else 1
        if small > 0:
            sign *= _exchange(a, k, d, 0, lanes, pivots, weights, work)
        negative = 0
        for i in range(end):
            work[i] = 1.0 / a[k, k, i]
            a[k, k, i] = work[i]
            negative += 1 if work[i] < 0.0 else 0
            if not abs(work[i]) < np.inf:
                return 0
        if negative % 2 == 1:
            sign = -sign
        for c in range(d):
            if c != k:
                for i in range(end):
                    a[k, c, i] *= work[i]
        for r in range(d):
            if r == k:
                continue
            for c in range(d):
                if c != k:
                    for i in range(end):
                        a[r, c, i] -= a[r, k, i] * a[k, c, i]
            for i in range(end):
                a[r, k, i] *= -work[i]
    for k in range(d - 1, -1, -1):
        for i in range(lanes):
            p = pivots[k, i]
            if p != k:
                for r in range(d):
                    swap = a[r, k, i]
                    a[r, k, i] = a[r, p, i]
                    a[r, p, i] = swap
    return sign


@vector_kernel("f3, i, i, i, i, i2, f2, f1 -> i")
def _exchange(a, k, candidates, low, high, pivots, weights, largest):
    """Bring the largest candidate to row k in the lanes where the natural pivot is small; (-1)^exchanges."""
    sign = 1
    for i in range(low, high):
        if weights[k, i] * abs(a[k, k, i]) >= THRESHOLD * largest[i]:
            continue
        p = k
        for r in range(k + 1, candidates):
            if weights[r, i] * abs(a[r, k, i]) > weights[p, i] * abs(a[p, k, i]):
                p = r
        if p != k:
            pivots[k, i] = p
            sign = -sign
            for c in range(a.shape[1]):
                swap = a[k, c, i]
                a[k, c, i] = a[p, c, i]
                a[p, c, i] = swap
            swap = weights[k, i]
            weights[k, i] = weights[p, i]
            weights[p, i] = swap
    return sign


@vector_kernel("f2, f1, i, i, i")
def _weigh(weights, sizes, rows, low, high):
    """weights[:rows, low:high] = sizes[:rows]: rows have not been exchanged yet."""
    for r in range(rows):
        for i in range(np.uint64(low), np.uint64(high)):
            weights[r, i] = sizes[r]


@vector_kernel("f3, i, i, i, i2, f2")
def eliminate_right(a, count, low, high, pivots, right):
    """The same operations on right-hand sides (rows, lanes), with the factors of `eliminate`."""
    rows, width, far = a.shape
    step, lanes = width * far, high - low
    for k in range(count):
        for i in range(np.uint64(low), np.uint64(high)):
            p = pivots[k, i]
            if p != k:
                swap = right[k, i]
                right[k, i] = right[p, i]
                right[p, i] = swap
    forward_lanes(address(right, low), rows, count, address(a, low), step, far, lanes)


@vector_kernel("f3, i, i, i, f2, f2")
def substitute_back(a, count, low, high, known, right):
    """Solve rows 0 .. count - 1 for their unknowns, given those of the other columns.

    known (width - count, lanes) are the values that belong to the columns from `count` on; the solution replaces
    right[:count].
    """
    width, far = a.shape[1], a.shape[2]
    step, lanes = width * far, high - low
    backward_lanes(address(right, low), count, address(a, low), step, address(known, low), width - count, far, lanes)
