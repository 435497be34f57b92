"""Elimination of the outer pair of stages (`contin.kernels.stages`), all intervals at once: the last axis is theirs."""

import numpy as np

from contin.kernels.collocation_elimination import invert
from contin.kernels.compile import vector_kernel
from contin.kernels.lanes import address, subtract_products
from contin.kernels.stages import GROWTH


@vector_kernel("Equations, Points, f, Stages, f1 -> i")
def invert_pair(e, w, period, g, work):
    """g.inverse from the Jacobians at the outer Gauss points; returns the sign of the pivots, 0 where one vanishes."""
    n, m = e.n, e.m
    inverse, first, last = g.inverse, g.first, g.last
    y, z = g.differences[0, m], g.differences[m - 1, 1]
    lanes = w.h.size
    end = np.uint64(lanes)
    _stage(e, w, period, g, 0, first)
    sign = invert(first, g.pivots, g.weights, g.row_weights, work)
    if sign == 0 or not _largest(first, g.weights) * max(abs(y), abs(z)) <= GROWTH:
        return _invert_together(e, w, period, g, work)
    _stage(e, w, period, g, m - 1, last)
    for k in range(n):
        for q in range(n):
            for i in range(end):
                last[k, q, i] -= y * z * first[k, q, i]
    sign *= invert(last, g.pivots, g.weights, g.row_weights, work)
    if sign == 0:
        return 0
    for k in range(n):
        for q in range(n):
            for i in range(end):
                inverse[k, q, i] = first[k, q, i]
                inverse[k, n + q, i] = 0.0
                inverse[n + k, q, i] = 0.0
                inverse[n + k, n + q, i] = last[k, q, i]
    step, half = 2 * n * lanes, n * lanes
    left, right = address(first, 0), address(last, 0)
    upper, lower = address(inverse, half), address(inverse, n * step)
    subtract_products(upper, step, n, n, left, half, right, half, n, lanes, lanes)
    subtract_products(lower, step, n, n, right, half, left, half, n, lanes, lanes)
    for k in range(n):
        for q in range(n):
            for i in range(end):
                inverse[k, n + q, i] *= y
                inverse[n + k, q, i] *= y * z
    subtract_products(address(inverse, 0), step, n, n, left, half, lower, step, n, lanes, lanes)
    for k in range(n):
        for q in range(n):
            for i in range(end):
                inverse[n + k, q, i] /= y
    return sign


@vector_kernel("Equations, Points, f, Stages, i, f3")
def _stage(e, w, period, g, c, out):
    """out (n, n, N): the diagonal block of stage c."""
    n, h, fu = e.n, w.h, w.fu
    x = g.differences[c, 1 + c]
    for k in range(n):
        for q in range(n):
            y = x if k == q else 0.0
            for i in range(np.uint64(h.size)):
                out[k, q, i] = y - period * h[i] * fu[c, k, q, i]


@vector_kernel("f3, f1 -> f")
def _largest(a, weights):
    """Largest modulus of all a (n, n, N), of states measured in their sizes, the inverse `weights`."""
    n, _, lanes = a.shape
    largest = 0.0
    for k in range(n):
        for q in range(n):
            ratio = weights[k] / weights[q]
            for i in range(np.uint64(lanes)):
                x = ratio * abs(a[k, q, i])
                largest = x if x > largest else largest
    return largest


@vector_kernel("Equations, Points, f, Stages, f1 -> i")
def _invert_together(e, w, period, g, work):
    """As `invert_pair`, with pivots from both stages."""
    n, m = e.n, e.m
    h, fu, inverse = w.h, w.fu, g.inverse
    lanes = np.uint64(h.size)
    for a in range(2):
        for b in range(2):
            x = g.differences[a * (m - 1), 1 + b * (m - 1)]
            for k in range(n):
                for q in range(n):
                    y = x if k == q else 0.0
                    if a == b:
                        for i in range(lanes):
                            inverse[a * n + k, b * n + q, i] = y - period * h[i] * fu[a * (m - 1), k, q, i]
                    else:
                        for i in range(lanes):
                            inverse[a * n + k, b * n + q, i] = y
    return invert(inverse, g.pivots, g.weights, g.row_weights, work)


@vector_kernel("Equations, Points, f, Stages")
def fill_columns(e, w, period, g):
    """g.columns, and g.timing from them and the inverse."""
    n, m = e.n, e.m
    h, f, fp, ft = w.h, w.f, w.fp, w.ft
    columns, inverse, timing = g.columns, g.inverse, g.timing
    lanes = np.uint64(h.size)
    for c in range(m):
        for k in range(n):
            for i in range(lanes):
                columns[0, c * n + k, i] = -h[i] * f[c, k, i]
                columns[1, c * n + k, i] = -h[i] * period * fp[c, k, i]
    if e.forcing != 0:
        start = 0.0
        for i in range(h.size):
            for c in range(m):
                t = period * (start + h[i] * e.gauss[c])
                for k in range(n):
                    columns[0, c * n + k, i] -= h[i] * t * ft[c, k, i]
            start += h[i]
    far = (m - 1) * n
    for r in range(2 * n):
        for x in range(2):
            for i in range(lanes):
                timing[x, r, i] = inverse[r, 0, i] * columns[x, 0, i] + inverse[r, n, i] * columns[x, far, i]
            for q in range(1, n):
                for i in range(lanes):
                    total = inverse[r, q, i] * columns[x, q, i] + inverse[r, n + q, i] * columns[x, far + q, i]
                    timing[x, r, i] += total


@vector_kernel("Equations, Points, f3, Stages")
def fill_borders(e, w, nodes_of_arc, g):
    """g.borders; nodes_of_arc (m + 1, n, N): the arclength row's coefficients of the values at the nodes."""
    n, m = e.n, e.m
    borders, phase, nodes = g.borders, w.phase, g.nodes
    lanes = np.uint64(w.h.size)
    autonomous = e.forcing == 0
    for x in range(m + 1):
        for k in range(n):
            if x > 0 and autonomous:
                for i in range(lanes):
                    borders[0, x, k, i] = phase[x - 1, k, i]
            else:
                for i in range(lanes):
                    borders[0, x, k, i] = 0.0
            for i in range(lanes):
                borders[1, x, k, i] = nodes[0, x] * nodes_of_arc[0, k, i]
            for j in range(1, m + 1):
                y = nodes[j, x]
                for i in range(lanes):
                    borders[1, x, k, i] += y * nodes_of_arc[j, k, i]


@vector_kernel("Equations, Points, f, Stages, f3")
def fill_local(e, w, period, g, local):
    """What is left for the inner stages: `local` of `Factors`."""
    n, m = e.n, e.m
    h, fu = w.h, w.fu
    inner = (m - 2) * n
    inverse, differences, product = g.inverse, g.differences, g.product
    lanes = np.uint64(h.size)
    for d in range(m - 1):  # of u_0, then of the inner stages
        column = inner if d == 0 else (d - 1) * n
        stage = 0 if d == 0 else d + 1
        x, y = differences[0, stage], differences[m - 1, stage]
        for q in range(n):
            for s in range(2 * n):
                for i in range(lanes):
                    product[s, i] = x * inverse[s, q, i] + y * inverse[s, n + q, i]
            _spread_column(n, m, product, g, stage, q, column + q, local)
            if d > 0:
                for k in range(n):
                    for i in range(lanes):
                        local[(d - 1) * n + k, column + q, i] -= h[i] * period * fu[d, k, q, i]
    for x in range(2):
        for s in range(2 * n):
            for i in range(lanes):
                product[s, i] = g.timing[x, s, i]
        _spread_column(n, m, product, g, -1, 0, inner + n + x, local)
        for r in range(inner):
            for i in range(lanes):
                local[r, inner + n + x, i] += g.columns[x, n + r, i]


@vector_kernel("i, i, f2, Stages, i, i, i, f3")
def _spread_column(n, m, product, g, stage, q, column, local):
    """One column of `local` from Z times that of the pair; of state q of (u_0, v)[stage], -1: of T or p."""
    differences, nodes, borders = g.differences, g.nodes, g.borders
    inner = (m - 2) * n
    lanes = np.uint64(product.shape[1])
    for c in range(1, m):
        x = differences[c, 1] if c < m - 1 else -nodes[m, 1]
        y = differences[c, m] if c < m - 1 else -nodes[m, m]
        same = 0.0
        if stage >= 0:
            same = differences[c, stage] if c < m - 1 else -nodes[m, stage]
        for k in range(n):
            r = (c - 1) * n + k
            diagonal = same if k == q else 0.0
            for i in range(lanes):
                local[r, column, i] = diagonal - x * product[k, i] - y * product[n + k, i]
    for p in range(2):
        r = inner + n + p
        if stage >= 0:
            for i in range(lanes):
                local[r, column, i] = borders[p, stage, q, i]
        else:
            for i in range(lanes):
                local[r, column, i] = 0.0
        for k in range(n):
            for i in range(lanes):
                local[r, column, i] -= borders[p, 1, k, i] * product[k, i] + borders[p, m, k, i] * product[n + k, i]


@vector_kernel("Stages, i, i, f2, f2")
def reduce_stages(g, n, m, right, reduced):
    """Right-hand sides `right` (m n, N) -> g.outer and `reduced` ((m - 1) n + 2, N), those of `local`."""
    outer, inverse, differences, nodes, borders = g.outer, g.inverse, g.differences, g.nodes, g.borders
    inner, far = (m - 2) * n, (m - 1) * n
    lanes = np.uint64(right.shape[1])
    for r in range(2 * n):
        for i in range(lanes):
            outer[r, i] = inverse[r, 0, i] * right[0, i] + inverse[r, n, i] * right[far, i]
        for q in range(1, n):
            for i in range(lanes):
                outer[r, i] += inverse[r, q, i] * right[q, i] + inverse[r, n + q, i] * right[far + q, i]
    for c in range(1, m - 1):
        x, y = differences[c, 1], differences[c, m]
        for k in range(n):
            for i in range(lanes):
                reduced[(c - 1) * n + k, i] = right[c * n + k, i] - x * outer[k, i] - y * outer[n + k, i]
    x, y = nodes[m, 1], nodes[m, m]
    for k in range(n):
        for i in range(lanes):
            reduced[inner + k, i] = x * outer[k, i] + y * outer[n + k, i]
    for p in range(2):
        for i in range(lanes):
            reduced[inner + n + p, i] = 0.0
        for k in range(n):
            for i in range(lanes):
                total = borders[p, 1, k, i] * outer[k, i] + borders[p, m, k, i] * outer[n + k, i]
                reduced[inner + n + p, i] -= total


@vector_kernel("Stages, i, i, f2, f2, f, f")
def expand_stages(g, n, m, points, inner_values, period, parameter):
    """g.values from u at the mesh points (n, N + 1), the inner stages' values ((m - 2) n, ..), T, p and g.outer."""
    values, outer, inverse, differences, product = g.values, g.outer, g.inverse, g.differences, g.product
    inner, far = (m - 2) * n, (m - 1) * n
    lanes = np.uint64(values.shape[1])
    for r in range(inner):
        for i in range(lanes):
            values[n + r, i] = inner_values[r, i]
    for a in range(2):
        row = a * (m - 1)
        for k in range(n):
            x = differences[row, 0]
            for i in range(lanes):
                product[a * n + k, i] = x * points[k, i]
            for d in range(1, m - 1):
                x = differences[row, d + 1]
                for i in range(lanes):
                    product[a * n + k, i] += x * values[d * n + k, i]
    for s in range(2 * n):
        r = s if s < n else far + s - n
        for i in range(lanes):
            values[r, i] = outer[s, i] - g.timing[0, s, i] * period - g.timing[1, s, i] * parameter
        for q in range(n):
            for i in range(lanes):
                values[r, i] -= inverse[s, q, i] * product[q, i] + inverse[s, n + q, i] * product[n + q, i]


@vector_kernel("Stages, i, i, i, f2, f2")
def nodes_of_stages(g, n, m, j, points, out):
    """out (n, N): the values at node j of all intervals."""
    values, nodes = g.values, g.nodes
    lanes = np.uint64(values.shape[1])
    for k in range(n):
        x = nodes[j, 0]
        for i in range(lanes):
            out[k, i] = x * points[k, i]
        for c in range(m):
            x = nodes[j, 1 + c]
            for i in range(lanes):
                out[k, i] += x * values[c * n + k, i]
