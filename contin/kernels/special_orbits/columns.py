"""Columns and right-hand sides at the Gauss points: derivatives by the second parameter, second derivatives along v."""

import numpy as np

from contin.kernels.collocation import LANES
from contin.kernels.compile import allocating, call4, call5, kernel, vector_kernel


@allocating("Equations, Curve, Points, f1, f3")
def second_column(e, c, w, z, fq):
    """fq at the Gauss points. Needs `evaluate`."""
    n, m = e.n, e.m
    w_at, w_p, w_F, w_J = w.at, w.p, w.F, w.J
    address, forcing, gauss, column = e.jacobian, e.forcing, e.gauss, n + c.second
    intervals = fq.shape[2]
    nodes = (intervals * m + 1) * n
    here = np.empty(n)
    start = 0.0
    for i in range(intervals):
        for g in range(m):
            for k in range(n):
                here[k] = w_at[g, k, i]
            if forcing != 0:
                w_p[w_p.size - 1] = z[nodes] * (start + w.h[i] * gauss[g])
            call4(address, here, w_p, w_F, w_J)
            for k in range(n):
                fq[g, k, i] = w_J[k, column]
        start += w.h[i]


@vector_kernel("f1, f1, f3, f3, f3")
def turn(across, along, fp, fq, fr):
    """fp, fq -> by s (in place of fp) and by r."""
    m, n, intervals = fp.shape
    for g in range(m):
        for k in range(n):
            for i in range(np.uint64(intervals)):
                a = fp[g, k, i]
                b = fq[g, k, i]
                fp[g, k, i] = across[0] * a + across[1] * b
                fr[g, k, i] = along[0] * a + along[1] * b


@vector_kernel("f3, f1, f, f2")
def slope_right(fr, h, period, right):
    """right = h T f_r."""
    m, n, intervals = fr.shape
    for g in range(m):
        for k in range(n):
            for i in range(np.uint64(intervals)):
                right[g * n + k, i] = h[i] * period * fr[g, k, i]


@kernel("f2, i, i, i, f4, f4, f2, i")
def spread(y, row, n, m, node, at, values, to):
    """Row of y to its values interval by interval and at the Gauss points (index `to`)."""
    intervals = node.shape[3]
    place = 0
    for i in range(intervals):
        for j in range(m + 1):
            for k in range(n):
                node[to, j, k, i] = y[row, place + j * n + k]
        place += m * n
    to_gauss(values, node, at, to)


@vector_kernel("f2, f4, f4, i")
def to_gauss(values, node, at, to):
    """at[to] (m, n, N) = values (m, m + 1) applied to node[to] (m + 1, n, N)."""
    _, nodes, n, intervals = node.shape
    lanes = np.uint64(intervals)
    for g in range(nodes - 1):
        for k in range(n):
            x = values[g, 0]
            for i in range(lanes):
                at[to, g, k, i] = x * node[to, 0, k, i]
            for j in range(1, nodes):
                x = values[g, j]
                for i in range(lanes):
                    at[to, g, k, i] += x * node[to, j, k, i]


@kernel("Equations, Curve, Points, Borders, CurveMemory, i, f, f")
def second_derivatives(e, c, w, f, o, which, by_period, by_s):
    """rate = Df[v] and bend = D^2f[v, .] at the Gauss points, v at place `which` of o.at with its T and s parts."""
    n, m = e.n, e.m
    w_at, w_p, at, rate, bend = w.at, w.p, o.at, o.rate, o.bend
    direction, matrix, slope, here = o.direction, o.matrix, o.slope, o.here
    forcing, gauss, address = e.forcing, e.gauss, c.gradient
    intervals = rate.shape[2]
    nodes = (intervals * m + 1) * n
    columns = n + w_p.size
    for j in range(columns):
        direction[j] = 0.0
    direction[n + e.active] = by_s * f.across[0]
    direction[n + c.second] += by_s * f.across[1]
    start = 0.0
    for i in range(intervals):
        for g in range(m):
            for k in range(n):
                here[k] = w_at[g, k, i]
                direction[k] = at[which, g, k, i]
            if forcing != 0:
                t = start + w.h[i] * gauss[g]
                w_p[w_p.size - 1] = o.z[nodes] * t
                direction[columns - 1] = by_period * t
            call5(address, here, w_p, direction, slope, matrix)
            for k in range(n):
                rate[g, k, i] = slope[k]
                for j in range(columns):
                    bend[g, k, j, i] = matrix[k, j]
        start += w.h[i]


@vector_kernel("Equations, Curve, Points, CurveMemory, i, f, f, f, f, f, f, f, f2")
def right_side(e, c, w, o, to, period, v_period, y_period, y_p, y_q, y_s, y_r, right):
    """right = -D^2F[v, y] = h (T D^2f[v, y] + v_T Df[y] + y_T Df[v]) at the Gauss points; y at place `to` of o.at."""
    n, m = e.n, e.m
    at, rate, bend, h = o.at, o.rate, o.bend, w.h
    fu, fs, fr, ft = w.fu, w.fp, o.fr, w.ft
    first, second = n + e.active, n + c.second
    intervals = h.size
    lanes = np.uint64(intervals)
    for g in range(m):
        for k in range(n):
            r = g * n + k
            for i in range(lanes):
                x = period * (bend[g, k, first, i] * y_p + bend[g, k, second, i] * y_q) + y_period * rate[g, k, i]
                right[r, i] = x + v_period * (fs[g, k, i] * y_s + fr[g, k, i] * y_r)
            for j in range(n):
                for i in range(lanes):
                    right[r, i] += period * bend[g, k, j, i] * at[to, g, j, i]
                if n > LANES:
                    for i in range(lanes):
                        right[r, i] += v_period * fu[i, g, k, j] * at[to, g, j, i]
                else:
                    for i in range(lanes):
                        right[r, i] += v_period * fu[g, k, j, i] * at[to, g, j, i]
    if e.forcing != 0:
        time = bend.shape[2] - 1
        start = 0.0
        for i in range(intervals):
            for g in range(m):
                t = (start + h[i] * e.gauss[g]) * y_period
                for k in range(n):
                    right[g * n + k, i] += (period * bend[g, k, time, i] + v_period * ft[g, k, i]) * t
            start += h[i]
    for r in range(m * n):
        for i in range(lanes):
            right[r, i] *= h[i]
