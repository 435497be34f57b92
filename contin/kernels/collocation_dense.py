"""Elimination and inversion of larger matrices, one dense matrix after another.

For more than a few states a matrix no longer fits beside the others in the fast cache, and its rows are long enough to
be vectors themselves. So matrices are a[i, :, :] here (lane by lane contiguous), and columns are eliminated four at a
time: the update of the rest reads and writes every row once for four pivots, two rows together.
"""

import numpy as np

from contin.kernels.compile import vector_kernel
from contin.kernels.vector import subtract_four

THRESHOLD = 0.1  # the natural pivot is kept while it exceeds this part of the largest candidate


@vector_kernel
def eliminate_dense(a, i, count, candidates, pivots, panel):
    """Eliminate columns 0 .. count - 1 of a[i] (rows, columns), pivots from the first `candidates` rows.

    Multipliers are stored below the diagonal, pivots (N, count); panel (4, rows) is memory.
    Returns the sign of the product of all pivots and row exchanges; 0 where a pivot vanishes or is NaN.
    """
    rows, width = a.shape[1], a.shape[2]
    sign = 1
    first = 0
    while first < count:
        end = min(first + 4, count)
        part = _panel(a, i, first, end, candidates, pivots, panel)
        if part == 0:
            return 0
        sign *= part
        if end - first == 4:
            _pivot_rows(a, i, first)
            place = i * rows * width
            below, rest = place + end * width, rows - end
            subtract_four(
                a, below + end, width, rest, a, place + first * width + end, width, a, below + first, width, 1,
                width - end,
            )  # fmt: skip
        else:
            for k in range(np.uint64(first), np.uint64(end)):
                for r in range(k + np.uint64(1), np.uint64(rows)):
                    factor = a[i, r, k]
                    for c in range(np.uint64(end), np.uint64(a.shape[2])):
                        a[i, r, c] -= factor * a[i, k, c]
        first = end
    return sign


@vector_kernel
def _panel(a, i, first, end, candidates, pivots, panel):
    """Factor columns first .. end - 1 (at most four), worked on side by side in panel (4, rows).

    Rows are exchanged as a whole; the other columns of the pivot rows are not touched otherwise.
    """
    rows, start, one = np.uint64(a.shape[1]), np.uint64(first), np.uint64(1)
    columns = np.uint64(end) - start
    sign = 1
    _to_panel(a, i, start, columns, panel)
    for j in range(columns):
        k = start + j
        p = k
        limit = abs(panel[j, k]) / THRESHOLD
        exceeding = 0
        for r in range(k + one, np.uint64(candidates)):
            exceeding += 1 if abs(panel[j, r]) > limit else 0
        if exceeding > 0:
            for r in range(k + one, np.uint64(candidates)):
                if abs(panel[j, r]) > abs(panel[j, p]):
                    p = np.uint64(r)
            sign = -sign
            for c in range(np.uint64(a.shape[2])):
                swap = a[i, k, c]
                a[i, k, c] = a[i, p, c]
                a[i, p, c] = swap
            for c in range(columns):
                swap = panel[c, k]
                panel[c, k] = panel[c, p]
                panel[c, p] = swap
        pivots[i, k] = p
        pivot = panel[j, k]
        if not abs(pivot) > 0.0:
            return 0
        if pivot < 0.0:
            sign = -sign
        inverse = 1.0 / pivot
        for r in range(k + one, rows):
            panel[j, r] *= inverse
        for c in range(j + one, columns):
            factor = panel[c, k]
            for r in range(k + one, rows):
                panel[c, r] -= factor * panel[j, r]
    _from_panel(a, i, start, columns, panel)
    return sign


@vector_kernel
def _to_panel(a, i, start, columns, panel):
    """panel[:columns] = columns of a[i] from `start` on, from row `start` on."""
    second, third, fourth = start + np.uint64(1), start + np.uint64(2), start + np.uint64(3)
    for r in range(start, np.uint64(a.shape[1])):
        if columns == 4:
            panel[0, r] = a[i, r, start]
            panel[1, r] = a[i, r, second]
            panel[2, r] = a[i, r, third]
            panel[3, r] = a[i, r, fourth]
        else:
            for j in range(columns):
                panel[j, r] = a[i, r, start + j]


@vector_kernel
def _from_panel(a, i, start, columns, panel):
    """The opposite of `_to_panel`."""
    second, third, fourth = start + np.uint64(1), start + np.uint64(2), start + np.uint64(3)
    for r in range(start, np.uint64(a.shape[1])):
        if columns == 4:
            a[i, r, start] = panel[0, r]
            a[i, r, second] = panel[1, r]
            a[i, r, third] = panel[2, r]
            a[i, r, fourth] = panel[3, r]
        else:
            for j in range(columns):
                a[i, r, start + j] = panel[j, r]


@vector_kernel
def _pivot_rows(a, i, first):
    """Apply four factored columns to the rest of the rows that hold their pivots."""
    k0 = np.uint64(first)
    k1, k2, k3 = k0 + np.uint64(1), k0 + np.uint64(2), k0 + np.uint64(3)
    f, g, h = a[i, k1, k0], a[i, k2, k0], a[i, k2, k1]
    p, q, r = a[i, k3, k0], a[i, k3, k1], a[i, k3, k2]
    for c in range(k3 + np.uint64(1), np.uint64(a.shape[2])):
        x = a[i, k0, c]
        y = a[i, k1, c] - f * x
        z = a[i, k2, c] - g * x - h * y
        a[i, k1, c] = y
        a[i, k2, c] = z
        a[i, k3, c] -= p * x + q * y + r * z


@vector_kernel
def invert_dense(a, i, pivots, panel):
    """a[i] (d, d) becomes its inverse, in place (Gauss-Jordan, four columns at a time, row exchanges).

    pivots (., d), panel (4, d) are memory. Returns the sign of the determinant; 0 where a pivot vanishes. Cost: 2 d^3
    operations.
    """
    d = a.shape[1]
    sign = 1
    first = 0
    while first < d:
        end = min(first + 4, d)
        part = _panel(a, i, first, end, d, pivots, panel)
        if part == 0:
            return 0
        sign *= part
        _take_factors(a, i, first, end, panel)
        _solve_rows(a, i, first, end, panel)
        if end - first == 4:
            place, stride = i * d * d, panel.shape[1]
            above, row = place + end * d, place + first * d
            subtract_four(a, place, d, first, a, row, d, panel, 0, 1, stride, d)
            subtract_four(a, above, d, d - end, a, row, d, panel, end, 1, stride, d)
        else:
            for r in range(d):
                if r < first or r >= end:
                    for k in range(first, end):
                        x = panel[k - first, r]
                        for c in range(np.uint64(d)):
                            a[i, r, c] -= x * a[i, k, c]
        first = end
    for k in range(d - 1, -1, -1):
        p = pivots[i, k]
        if p != k:
            for r in range(d):
                swap = a[i, r, k]
                a[i, r, k] = a[i, r, p]
                a[i, r, p] = swap
    return sign


@vector_kernel
def _take_factors(a, i, first, end, panel):
    """Columns first .. end - 1 of a[i], as they were before `_panel` factored them, into `panel`; of the pivot rows L
    and U. Then these columns are those of the identity.
    """
    for r in range(a.shape[1]):
        for j in range(end - first - 1, -1, -1):
            x = a[i, r, first + j]
            if r >= end:
                x *= a[i, first + j, first + j]
                for t in range(j):
                    x += a[i, r, first + t] * a[i, first + t, first + j]
            panel[j, r] = x
    for r in range(a.shape[1]):
        for c in range(first, end):
            a[i, r, c] = 1.0 if r == c else 0.0


@vector_kernel
def _solve_rows(a, i, first, end, panel):
    """The pivot rows of a[i] are solved with L and U, which `_take_factors` has left in `panel`."""
    width = np.uint64(a.shape[2])
    for k in range(first, end):
        for t in range(first, k):
            x = panel[t - first, k]
            for c in range(width):
                a[i, k, c] -= x * a[i, t, c]
    for k in range(end - 1, first - 1, -1):
        for t in range(k + 1, end):
            x = panel[t - first, k]
            for c in range(width):
                a[i, k, c] -= x * a[i, t, c]
        x = 1.0 / panel[k - first, k]
        for c in range(width):
            a[i, k, c] *= x


@vector_kernel
def eliminate_right_dense(a, count, low, high, pivots, right, v):
    """The same operations on right-hand sides (rows, N), lanes low .. high - 1; v is memory for one of them."""
    rows = a.shape[1]
    for i in range(low, high):
        for r in range(rows):
            v[r] = right[r, i]
        for k in range(count):
            p = pivots[i, k]
            if p != k:
                swap = v[k]
                v[k] = v[p]
                v[p] = swap
        for r in range(1, rows):
            total = 0.0
            for k in range(np.uint64(0), np.uint64(min(r, count))):
                total += a[i, r, k] * v[k]
            v[r] -= total
        for r in range(rows):
            right[r, i] = v[r]


@vector_kernel
def substitute_back_dense(a, count, low, high, known, right, v):
    """Solve rows 0 .. count - 1 for their unknowns, given those of the other columns, known (width - count, N)."""
    width = a.shape[2]
    for i in range(low, high):
        for c in range(count, width):
            v[c] = known[c - count, i]
        for k in range(count - 1, -1, -1):
            total = 0.0
            for c in range(np.uint64(k + 1), np.uint64(width)):
                total += a[i, k, c] * v[c]
            v[k] = (right[k, i] - total) / a[i, k, k]
            right[k, i] = v[k]
