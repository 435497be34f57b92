"""The same elimination as `collocation_system` for larger systems, one dense matrix after another.

For more than a few states a matrix no longer fits beside the others in the fast cache, and its rows are long enough to
be vectors themselves. So matrices are a[i, :, :] here (lane by lane contiguous), and columns are eliminated four at a
time: the update of the rest reads and writes every row once for four pivots, two rows together.
"""

import numpy as np

from contin.kernels.compile import vector_kernel

THRESHOLD = 0.1  # the natural pivot is kept while it exceeds this part of the largest candidate


@vector_kernel
def eliminate_dense(a, i, count, candidates, pivots, panel):
    """Eliminate columns 0 .. count - 1 of a[i] (rows, columns), pivots from the first `candidates` rows.

    Multipliers are stored below the diagonal, pivots (N, count); panel (4, rows) is memory.
    Returns the sign of the product of all pivots and row exchanges; 0 where a pivot vanishes or is NaN.
    """
    rows = a.shape[1]
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
            r = end
            while r + 2 < rows:
                _update_three(a, i, r, first)
                r += 3
            while r < rows:
                _update_one(a, i, r, first)
                r += 1
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
def _update_three(a, i, r, first):
    """Subtract from the rest of three rows their multiples of the four pivot rows."""
    e0, e1, e2, e3 = a[i, r, first], a[i, r, first + 1], a[i, r, first + 2], a[i, r, first + 3]
    f0, f1, f2, f3 = a[i, r + 1, first], a[i, r + 1, first + 1], a[i, r + 1, first + 2], a[i, r + 1, first + 3]
    g0, g1, g2, g3 = a[i, r + 2, first], a[i, r + 2, first + 1], a[i, r + 2, first + 2], a[i, r + 2, first + 3]
    for c in range(np.uint64(first + 4), np.uint64(a.shape[2])):
        u0, u1, u2, u3 = a[i, first, c], a[i, first + 1, c], a[i, first + 2, c], a[i, first + 3, c]
        x = a[i, r, c] - e0 * u0 - e1 * u1 - e2 * u2 - e3 * u3
        y = a[i, r + 1, c] - f0 * u0 - f1 * u1 - f2 * u2 - f3 * u3
        z = a[i, r + 2, c] - g0 * u0 - g1 * u1 - g2 * u2 - g3 * u3
        a[i, r, c] = x
        a[i, r + 1, c] = y
        a[i, r + 2, c] = z


@vector_kernel
def _update_one(a, i, r, first):
    f0, f1, f2, f3 = a[i, r, first], a[i, r, first + 1], a[i, r, first + 2], a[i, r, first + 3]
    for c in range(np.uint64(first + 4), np.uint64(a.shape[2])):
        x = a[i, r, c] - f0 * a[i, first, c] - f1 * a[i, first + 1, c]
        a[i, r, c] = x - f2 * a[i, first + 2, c] - f3 * a[i, first + 3, c]


@vector_kernel
def substitute_dense(a):
    """The right half of a (1, n, 2 n) becomes the solution with the triangular left half; four rows at once."""
    n, width = a.shape[1], np.uint64(a.shape[2])
    first = np.uint64(n)
    for k in range(n - 1, -1, -1):
        r = k + 1
        while r + 4 <= n:
            f0, f1, f2, f3 = a[0, k, r], a[0, k, r + 1], a[0, k, r + 2], a[0, k, r + 3]
            for c in range(first, width):
                x = f0 * a[0, r, c] + f1 * a[0, r + 1, c] + f2 * a[0, r + 2, c] + f3 * a[0, r + 3, c]
                a[0, k, c] -= x
            r += 4
        while r < n:
            factor = a[0, k, r]
            for c in range(first, width):
                a[0, k, c] -= factor * a[0, r, c]
            r += 1
        inverse = 1.0 / a[0, k, k]
        for c in range(first, width):
            a[0, k, c] *= inverse


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
