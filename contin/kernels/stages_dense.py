"""Elimination of the outer pair of stages (`contin.kernels.stages`), one interval i after another, rows as vectors."""

import numpy as np

from contin.kernels.collocation_dense import invert_dense
from contin.kernels.compile import vector_kernel
from contin.kernels.stages import GROWTH
from contin.kernels.vector import multiply, subtract_four


@vector_kernel("Equations, Points, f, Stages, i, f2 -> i")
def invert_pair_dense(e, w, period, g, i, panel):
    """g.inverse[i] from the Jacobians at the outer Gauss points; returns the sign of the pivots, 0: one vanishes."""
    n, m = e.n, e.m
    inverse, first, last = g.inverse, g.first, g.last
    y, z = g.differences[0, m], g.differences[m - 1, 1]
    one = np.uint64(n)
    _stage(e, w, period, g, i, 0, first)
    sign = invert_dense(first, 0, g.pivots, g.weights, g.row_weights, panel)
    if sign == 0 or not _largest(first, g.weights) * max(abs(y), abs(z)) <= GROWTH:
        return _invert_together(e, w, period, g, i, panel)
    _stage(e, w, period, g, i, m - 1, last)
    for k in range(one):
        for q in range(one):
            last[0, k, q] -= y * z * first[0, k, q]
    sign *= invert_dense(last, 0, g.pivots, g.weights, g.row_weights, panel)
    if sign == 0:
        return 0
    for k in range(one):
        for q in range(one):
            inverse[i, k, q] = first[0, k, q]
            inverse[i, k, one + q] = 0.0
        for q in range(one):
            inverse[i, one + k, q] = 0.0
            inverse[i, one + k, one + q] = last[0, k, q]
    _subtract_product(inverse, i, 0, n, first, last, 0, 0, 0)
    _subtract_product(inverse, i, n, 0, last, first, 0, 0, 0)
    for k in range(one):
        for q in range(one):
            inverse[i, k, one + q] *= y
            inverse[i, one + k, q] *= y * z
    _subtract_product(inverse, i, 0, 0, first, inverse, i, n, 0)
    for k in range(one):
        for q in range(one):
            inverse[i, one + k, q] /= y
    return sign


@vector_kernel("f3, i, i, i, f3, f3, i, i, i")
def _subtract_product(c, i, c_row, c_column, f, p, j, p_row, p_column):
    """C -= F P, all (n, n): F = f[0], C and P the blocks of c[i] and p[j] whose first elements are given."""
    n, c_step, p_step = f.shape[1], c.shape[2], p.shape[2]
    c_at, p_at = (i * c.shape[1] + c_row) * c_step + c_column, (j * p.shape[1] + p_row) * p_step + p_column
    k = 0
    while k + 4 <= n:
        subtract_four(c, c_at, c_step, n, p, p_at + k * p_step, p_step, f, k, n, 1, n)
        k += 4
    to, by = np.uint64(c_column), np.uint64(p_column)
    for row in range(k, n):
        for r in range(n):
            x = f[0, r, row]
            for q in range(np.uint64(n)):
                c[i, c_row + r, to + q] -= x * p[j, p_row + row, by + q]


@vector_kernel("Equations, Points, f, Stages, i, i, f3")
def _stage(e, w, period, g, i, c, out):
    """out[0] (n, n): the diagonal block of stage c of interval i."""
    n, fu = e.n, w.fu
    factor = -period * w.h[i]
    for k in range(n):
        for q in range(np.uint64(n)):
            out[0, k, q] = factor * fu[i, c, k, q]
        out[0, k, k] += g.differences[c, 1 + c]


@vector_kernel("f3, f1 -> f")
def _largest(a, weights):
    """Largest modulus of all a[0] (n, n), of states measured in their sizes, the inverse `weights`."""
    largest = 0.0
    for k in range(a.shape[1]):
        for q in range(np.uint64(a.shape[2])):
            x = weights[k] * abs(a[0, k, q]) / weights[q]
            largest = x if x > largest else largest
    return largest


@vector_kernel("Equations, Points, f, Stages, i, f2 -> i")
def _invert_together(e, w, period, g, i, panel):
    """As `invert_pair_dense`, with pivots from both stages."""
    n, m = e.n, e.m
    fu, inverse = w.fu, g.inverse
    factor = -period * w.h[i]
    one = np.uint64(n)
    for a in range(2):
        c = a * (m - 1)
        x, y = g.differences[c, 1], g.differences[c, m]
        for k in range(n):
            r = a * n + k
            for q in range(one):
                value = factor * fu[i, c, k, q]
                inverse[i, r, q] = 0.0 if a == 1 else value
                inverse[i, r, one + q] = 0.0 if a == 0 else value
            inverse[i, r, k] += x
            inverse[i, r, n + k] += y
    return invert_dense(inverse, i, g.pivots, g.weights, g.row_weights, panel)


@vector_kernel("Equations, Points, f, Stages, i, f")
def fill_columns_dense(e, w, period, g, i, start):
    """g.columns[i], and g.timing[i] from them and the inverse."""
    n, m = e.n, e.m
    h = w.h[i]
    columns, inverse, timing = g.columns, g.inverse, g.timing
    far = (m - 1) * n
    for c in range(m):
        t = period * (start + h * e.gauss[c])
        for k in range(n):
            columns[i, 0, c * n + k] = -h * w.f[c, k, i]
            columns[i, 1, c * n + k] = -h * period * w.fp[c, k, i]
            if e.forcing != 0:
                columns[i, 0, c * n + k] -= h * t * w.ft[c, k, i]
    for r in range(2 * n):
        for x in range(2):
            total = 0.0
            for q in range(np.uint64(n)):
                total += inverse[i, r, q] * columns[i, x, q]
                total += inverse[i, r, np.uint64(n) + q] * columns[i, x, np.uint64(far) + q]
            timing[i, x, r] = total


@vector_kernel("Equations, Points, f3, Stages, i")
def fill_borders_dense(e, w, nodes_of_arc, g, i):
    """g.borders[i]; nodes_of_arc (m + 1, n, N): the arclength row's coefficients of the values at the nodes."""
    n, m = e.n, e.m
    borders, nodes = g.borders, g.nodes
    for x in range(m + 1):
        for k in range(n):
            borders[i, 0, x, k] = w.phase[x - 1, k, i] if x > 0 and e.forcing == 0 else 0.0
            total = 0.0
            for j in range(m + 1):
                total += nodes[j, x] * nodes_of_arc[j, k, i]
            borders[i, 1, x, k] = total


@vector_kernel("Equations, Points, f, Stages, i, f3")
def fill_local_dense(e, w, period, g, i, local):
    """What is left for the inner stages: local[i] of `Factors`."""
    n, m = e.n, e.m
    fu = w.fu
    factor = -period * w.h[i]
    inner = (m - 2) * n
    inverse, differences, nodes, borders, product = g.inverse, g.differences, g.nodes, g.borders, g.product
    one = np.uint64(n)
    for d in range(m - 1):  # columns of u_0, then of the inner stages
        first = np.uint64(inner if d == 0 else (d - 1) * n)
        stage = 0 if d == 0 else d + 1
        x, y = differences[0, stage], differences[m - 1, stage]
        for s in range(2 * n):
            for q in range(one):
                product[s, q] = x * inverse[i, s, q] + y * inverse[i, s, one + q]
        for c in range(1, m):
            last = c == m - 1
            x = -nodes[m, 1] if last else differences[c, 1]
            y = -nodes[m, m] if last else differences[c, m]
            same = -nodes[m, stage] if last else differences[c, stage]
            for k in range(n):
                r = (c - 1) * n + k
                if c == d:
                    for q in range(one):
                        local[i, r, first + q] = factor * fu[i, c, k, q] - x * product[k, q] - y * product[n + k, q]
                else:
                    for q in range(one):
                        local[i, r, first + q] = -x * product[k, q] - y * product[n + k, q]
                local[i, r, first + np.uint64(k)] += same
        for p in range(2):
            r = inner + n + p
            for q in range(one):
                local[i, r, first + q] = borders[i, p, stage, q]
            for k in range(n):
                x, y = borders[i, p, 1, k], borders[i, p, m, k]
                for q in range(one):
                    local[i, r, first + q] -= x * product[k, q] + y * product[n + k, q]


@vector_kernel("Equations, Stages, i, f3")
def fill_timing_dense(e, g, i, local):
    """The columns of T and p of local[i]."""
    n, m = e.n, e.m
    inner = (m - 2) * n
    timing, columns, differences, nodes, borders = g.timing, g.columns, g.differences, g.nodes, g.borders
    for q in range(2):
        for c in range(1, m):
            x = -nodes[m, 1] if c == m - 1 else differences[c, 1]
            y = -nodes[m, m] if c == m - 1 else differences[c, m]
            for k in range(n):
                value = columns[i, q, c * n + k] if c < m - 1 else 0.0
                local[i, (c - 1) * n + k, inner + n + q] = value - x * timing[i, q, k] - y * timing[i, q, n + k]
        for p in range(2):
            total = 0.0
            for k in range(n):
                total += borders[i, p, 1, k] * timing[i, q, k] + borders[i, p, m, k] * timing[i, q, n + k]
            local[i, inner + n + p, inner + n + q] = -total


@vector_kernel("Stages, i, i, f2, f2")
def reduce_stages_dense(g, n, m, right, reduced):
    """Right-hand sides `right` (m n, N) -> g.outer and `reduced` ((m - 1) n + 2, N), those of `local`."""
    outer, inverse, differences, nodes, borders, v = g.outer, g.inverse, g.differences, g.nodes, g.borders, g.vector
    inner, far, size = (m - 2) * n, (m - 1) * n, 2 * n
    for i in range(right.shape[1]):
        for k in range(n):
            v[0, k] = right[k, i]
            v[0, n + k] = right[far + k, i]
        multiply(v, v.shape[1], inverse, i * size * size, size, size, v, 0, size)
        for r in range(size):
            outer[r, i] = v[1, r]
        for k in range(n):
            for c in range(1, m - 1):
                x = differences[c, 1] * v[1, k] + differences[c, m] * v[1, n + k]
                reduced[(c - 1) * n + k, i] = right[c * n + k, i] - x
            reduced[inner + k, i] = nodes[m, 1] * v[1, k] + nodes[m, m] * v[1, n + k]
        for p in range(2):
            total = 0.0
            for k in range(n):
                total += borders[i, p, 1, k] * v[1, k] + borders[i, p, m, k] * v[1, n + k]
            reduced[inner + n + p, i] = -total


@vector_kernel("Stages, i, i, f2, f2, f, f")
def expand_stages_dense(g, n, m, points, inner_values, period, parameter):
    """g.values from u at the mesh points (n, N + 1), the inner stages' values ((m - 2) n, ..), T, p and g.outer."""
    values, outer, inverse, differences, timing, v = g.values, g.outer, g.inverse, g.differences, g.timing, g.vector
    inner, far, size = (m - 2) * n, (m - 1) * n, 2 * n
    for i in range(values.shape[1]):
        for r in range(inner):
            values[n + r, i] = inner_values[r, i]
        for k in range(n):
            for a in range(2):
                row = a * (m - 1)
                x = differences[row, 0] * points[k, i]
                for d in range(1, m - 1):
                    x += differences[row, d + 1] * values[d * n + k, i]
                v[0, a * n + k] = x
        multiply(v, v.shape[1], inverse, i * size * size, size, size, v, 0, size)
        for s in range(size):
            x = outer[s, i] - timing[i, 0, s] * period - timing[i, 1, s] * parameter - v[1, s]
            values[s if s < n else far + s - n, i] = x
