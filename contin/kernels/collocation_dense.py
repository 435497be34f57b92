"""Elimination and inversion of larger matrices, one dense matrix after another.

For more than a few states a matrix no longer fits beside the others in the fast cache, and its rows are long enough to
be vectors themselves. So matrices are a[i, :, :] here (lane by lane contiguous), and columns are eliminated four at a
time: the update of the rest reads and writes every row once for four pivots, two rows together.
"""

import numpy as np

from contin.kernels.compile import vector_kernel
from contin.kernels.vector import multiply, subtract_four

THRESHOLD = 0.1  # the natural pivot is kept while it exceeds this part of the largest candidate


@vector_kernel("f3, i, i, i, i2, f1, f2, f2 -> i")
def eliminate_dense(a, i, count, candidates, pivots, sizes, weights, panel):
    """Eliminate columns 0 .. count - 1 of a[i] (rows, columns), pivots from the first `candidates` rows.

    Rows are compared with their weights, `sizes` (candidates,); weights (candidates, .) is memory for them.

    Multipliers are stored below the diagonal, pivots (N, count); panel (4, rows) is memory.
    Returns the sign of the product of all pivots and row exchanges; 0 where a pivot vanishes or is NaN.
    """
    rows, width = a.shape[1], a.shape[2]
    sign = 1
    first = 0
    for r in range(candidates):
        weights[r, 0] = sizes[r]
    while first < count:
        end = min(first + 4, count)
        part = _panel(a, i, first, end, candidates, pivots, weights, panel)
        if part == 0:
            return 0
        sign *= part
        _from_panel(a, i, np.uint64(first), np.uint64(end - first), panel)
        _solve_lower(a, i, first, end, end, panel)
        if end - first == 4:
            below = (i * rows + end) * width
            pivot_rows = (i * rows + first) * width + end
            subtract_four(
                a, below + end, width, rows - end, a, pivot_rows, width, a, below + first, width, 1, width - end
            )
        else:
            _subtract_few(a, i, end, rows, first, end, end, panel)
        first = end
    return sign


@vector_kernel("f3, i, i, i, i, i2, f2, f2 -> i")
def _panel(a, i, first, end, candidates, pivots, weights, panel):
    """Factor columns first .. end - 1 (at most four), which stand side by side in panel (4, rows) afterwards.

    Of a[i], rows are exchanged as a whole, and nothing else is touched.
    """
    rows, start, one = np.uint64(a.shape[1]), np.uint64(first), np.uint64(1)
    columns = np.uint64(end) - start
    sign = 1
    _to_panel(a, i, start, columns, panel)
    for j in range(columns):
        k = start + j
        p = k
        limit = weights[k, 0] * abs(panel[j, k]) / THRESHOLD
        exceeding = 0
        for r in range(k + one, np.uint64(candidates)):
            exceeding += 1 if weights[r, 0] * abs(panel[j, r]) > limit else 0
        if exceeding > 0:
            for r in range(k + one, np.uint64(candidates)):
                if weights[r, 0] * abs(panel[j, r]) > weights[p, 0] * abs(panel[j, p]):
                    p = np.uint64(r)
            sign = -sign
            for c in range(np.uint64(a.shape[2])):
                swap = a[i, k, c]
                a[i, k, c] = a[i, p, c]
                a[i, p, c] = swap
            swap = weights[k, 0]
            weights[k, 0] = weights[p, 0]
            weights[p, 0] = swap
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
    return sign


@vector_kernel("f3, i, u, u, f2")
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


@vector_kernel("f3, i, u, u, f2")
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


@vector_kernel("f3, i, i, i, i, i, i, f2")
def _subtract_few(a, i, low, high, first, end, beyond, panel):
    """Rows low .. high - 1 of a[i] minus their factors in `panel` times the pivot rows, of which there are fewer than
    four; columns from `beyond` on.
    """
    for r in range(np.uint64(low), np.uint64(high)):
        for k in range(np.uint64(first), np.uint64(end)):
            x = panel[k - np.uint64(first), r]
            for c in range(np.uint64(beyond), np.uint64(a.shape[2])):
                a[i, r, c] -= x * a[i, k, c]


@vector_kernel("f3, i, i, i, i, f2")
def _solve_lower(a, i, first, end, beyond, panel):
    """The pivot rows of a[i] are solved with L, which stands in `panel`; columns from `beyond` on."""
    start, width = np.uint64(beyond), np.uint64(a.shape[2])
    k0 = np.uint64(first)
    if end - first == 4:  # in one pass
        k1, k2, k3 = k0 + np.uint64(1), k0 + np.uint64(2), k0 + np.uint64(3)
        f, g, h = panel[0, k1], panel[0, k2], panel[1, k2]
        p, q, r = panel[0, k3], panel[1, k3], panel[2, k3]
        for c in range(start, width):
            x = a[i, k0, c]
            y = a[i, k1, c] - f * x
            z = a[i, k2, c] - g * x - h * y
            a[i, k1, c] = y
            a[i, k2, c] = z
            a[i, k3, c] -= p * x + q * y + r * z
        return
    for k in range(k0, np.uint64(end)):
        for t in range(k0, k):
            x = panel[t - k0, k]
            for c in range(start, width):
                a[i, k, c] -= x * a[i, t, c]


@vector_kernel("f3, i, i, i, f2")
def _solve_upper(a, i, first, end, panel):
    """The pivot rows of a[i] are solved with U, which stands in `panel`."""
    width = np.uint64(a.shape[2])
    k0 = np.uint64(first)
    if end - first == 4:
        k1, k2, k3 = k0 + np.uint64(1), k0 + np.uint64(2), k0 + np.uint64(3)
        f, g, h = panel[1, k0], panel[2, k0], panel[2, k1]
        p, q, r = panel[3, k0], panel[3, k1], panel[3, k2]
        s, t, u, v = 1.0 / panel[0, k0], 1.0 / panel[1, k1], 1.0 / panel[2, k2], 1.0 / panel[3, k3]
        for c in range(width):
            z = a[i, k3, c] * v
            y = (a[i, k2, c] - r * z) * u
            x = (a[i, k1, c] - q * z - h * y) * t
            a[i, k3, c] = z
            a[i, k2, c] = y
            a[i, k1, c] = x
            a[i, k0, c] = (a[i, k0, c] - p * z - g * y - f * x) * s
        return
    for k in range(end - 1, first - 1, -1):
        for j in range(k + 1, end):
            x = panel[j - first, k]
            for c in range(width):
                a[i, k, c] -= x * a[i, j, c]
        x = 1.0 / panel[k - first, k]
        for c in range(width):
            a[i, k, c] *= x


@vector_kernel("f3, i, i2, f1, f2, f2 -> i")
def invert_dense(a, i, pivots, sizes, weights, panel):
    """a[i] (d, d) becomes its inverse, in place (Gauss-Jordan, four columns at a time, row exchanges).

    sizes and weights as in `eliminate_dense`; pivots (., d), panel (4, d) are memory. Returns the sign of the
    determinant; 0 where a pivot vanishes. Cost: 2 d^3 operations.
    """
    d = a.shape[1]
    sign = 1
    first = 0
    for r in range(d):
        weights[r, 0] = sizes[r]
    while first < d:
        end = min(first + 4, d)
        part = _panel(a, i, first, end, d, pivots, weights, panel)
        if part == 0:
            return 0
        sign *= part
        _identity(a, i, first, end, panel)
        place, stride = i * d * d, panel.shape[1]
        above, pivot_rows = place + end * d, place + first * d
        _solve_lower(a, i, first, end, 0, panel)
        if end - first == 4:
            subtract_four(a, above, d, d - end, a, pivot_rows, d, panel, end, 1, stride, d)
            _solve_upper(a, i, first, end, panel)
            subtract_four(a, place, d, first, a, pivot_rows, d, panel, 0, 1, stride, d)
        else:
            _subtract_few(a, i, end, d, first, end, 0, panel)
            _solve_upper(a, i, first, end, panel)
            _subtract_few(a, i, 0, first, first, end, 0, panel)
        first = end
    for k in range(d - 1, -1, -1):
        p = pivots[i, k]
        if p != k:
            for r in range(d):
                swap = a[i, r, k]
                a[i, r, k] = a[i, r, p]
                a[i, r, p] = swap
    return sign


@vector_kernel("f3, i, i, i, f2")
def _identity(a, i, first, end, panel):
    """Columns first .. end - 1 of a[i] become those of the identity; what stood above row `first` goes to `panel`."""
    start, beyond = np.uint64(first), np.uint64(end)
    for r in range(start):
        for c in range(start, beyond):
            panel[c - start, r] = a[i, r, c]
            a[i, r, c] = 0.0
    for r in range(start, np.uint64(a.shape[1])):
        for c in range(start, beyond):
            a[i, r, c] = 1.0 if r == c else 0.0


@vector_kernel("f3, i, i, i, i2, f2, f1")
def eliminate_right_dense(a, count, low, high, pivots, right, v):
    """The same operations on right-hand sides (rows, N), lanes low .. high - 1; v (rows + 4,) is memory."""
    rows, width = a.shape[1], a.shape[2]
    for i in range(low, high):
        for r in range(rows):
            v[r] = right[r, i]
        for k in range(count):
            p = pivots[i, k]
            if p != k:
                swap = v[k]
                v[k] = v[p]
                v[p] = swap
        for first in range(0, count, 4):
            end = min(first + 4, count)
            multiply(v, rows, a, (i * rows + first) * width, width, end - first, v, 0, first)
            for r in range(first, end):
                total = v[r] - v[rows + r - first]
                for k in range(first, r):
                    total -= a[i, r, k] * v[k]
                v[r] = total
        for r in range(count):
            right[r, i] = v[r]
        for first in range(count, rows, 4):
            end = min(first + 4, rows)
            multiply(v, rows, a, (i * rows + first) * width, width, end - first, v, 0, count)
            for r in range(first, end):
                right[r, i] = v[r] - v[rows + r - first]


@vector_kernel("f3, i, i, i, f2, f2, f1")
def substitute_back_dense(a, count, low, high, known, right, v):
    """Solve rows 0 .. count - 1 for their unknowns, given those of the other columns, known (width - count, N).

    v (width + 4,) is memory.
    """
    rows, width = a.shape[1], a.shape[2]
    for i in range(low, high):
        for c in range(count, width):
            v[c] = known[c - count, i]
        end = count
        while end > 0:
            first = max(end - 4, 0)
            multiply(v, width, a, (i * rows + first) * width + end, width, end - first, v, end, width - end)
            for k in range(end - 1, first - 1, -1):
                total = right[k, i] - v[width + k - first]
                for c in range(k + 1, end):
                    total -= a[i, k, c] * v[c]
                v[k] = total / a[i, k, k]
                right[k, i] = v[k]
            end = first
