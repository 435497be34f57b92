"""Collocation equations of a periodic orbit and their Jacobian at a point z = (u at the nodes, T, mesh, p).

    u'(x) = T f(u(x), p [, t = T x])  at the Gauss points of every interval,   u(1) = u(0) + winding,
    phase condition  sum of weights * <u - reference, reference'> = 0   (forced systems: T = multiple * forcing period),
    arclength        <tangent, (z - z0) / scale> = length.

Layout of z: u at the N m + 1 nodes (n values each), T, the lengths h_1 .. h_N of the intervals (sum 1; they are carried
along, never solved for), p. So a point knows its own mesh.
"""

import math
from collections import namedtuple

import numpy as np

from contin.kernels.compile import call3, call4, kernel

Equations = namedtuple(
    "Equations",
    [
        "value",  # addresses: (u, p, F)
        "jacobian",  # (u, p, F, J)
        "forcing",  # (u, p, T, dT): the forcing period and its derivatives, 0 for an autonomous system
        "multiple",  # orbits of this many forcing periods
        "n",
        "m",
        "active",  # index of the varying parameter
        "values",  # (m, m + 1) basis at the Gauss points
        "slopes",
        "gauss",
        "weights",
        "winding",  # (n,) what angles gain in one period
    ],
)

Points = namedtuple(
    "Points",
    [
        "u",  # (m + 1, n, N) node values, interval by interval
        "at",  # (m, n, N) values at the Gauss points
        "f",  # (m, n, N)
        "fu",  # (m, n, n, N)
        "fp",  # (m, n, N)
        "ft",  # (m, n, N) time derivative (forced systems)
        "phase",  # (m + 1, n, N) row of the phase condition
        "phase_right",  # (1,) its value at the reference
        "F",
        "J",
        "p",  # (m_p,) all parameters (and t), its own copy
    ],
)


def new_points(n, m, intervals, p):
    """Memory for values at the Gauss points of one mesh."""
    return Points(
        np.zeros((m + 1, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m + 1, n, intervals)),
        np.zeros(1),
        np.zeros(n),
        np.zeros((n, n + p.size)),
        p.copy(),
    )


@kernel
def set_phase(e, w, reference, sizes):
    """Phase condition with respect to `reference` (layout of z): row of weights at the nodes.

    And its right-hand side.
    """
    w_u = w.u
    w_phase_right = w.phase_right
    w_phase = w.phase
    e_n = e.n
    e_m = e.m
    e_weights = e.weights
    e_slopes = e.slopes
    e_values = e.values
    n, m = e_n, e_m
    intervals = w_u.shape[2]
    w_phase_right[0] = 0.0
    for j in range(m + 1):
        for k in range(n):
            for i in range(intervals):
                w_u[j, k, i] = reference[(i * m + j) * n + k]
    for j in range(m + 1):
        for k in range(n):
            for i in range(intervals):
                w_phase[j, k, i] = 0.0
    total = 0.0
    for c in range(m):
        for k in range(n):
            inverse = e_weights[c] / (sizes[k] * sizes[k])
            for i in range(intervals):
                slope = 0.0
                here = 0.0
                for j in range(m + 1):
                    slope += e_slopes[c, j] * w_u[j, k, i]
                    here += e_values[c, j] * w_u[j, k, i]
                slope *= inverse
                total += slope * here
                for j in range(m + 1):
                    w_phase[j, k, i] += slope * e_values[c, j]
    w_phase_right[0] = total


@kernel
def evaluate(e, w, z, with_jacobian):
    """f (and its Jacobian) at all Gauss points; False where something is not finite."""
    w_u = w.u
    w_p = w.p
    w_at = w.at
    w_F = w.F
    w_J = w.J
    w_fu = w.fu
    w_fp = w.fp
    w_ft = w.ft
    w_f = w.f
    e_n = e.n
    e_m = e.m
    e_active = e.active
    e_values = e.values
    e_forcing = e.forcing
    e_gauss = e.gauss
    e_jacobian = e.jacobian
    e_value = e.value
    n, m = e_n, e_m
    intervals = w_u.shape[2]
    nodes = (intervals * m + 1) * n
    period = z[nodes]
    w_p[e_active] = z[z.size - 1]
    for j in range(m + 1):
        for k in range(n):
            for i in range(intervals):
                w_u[j, k, i] = z[(i * m + j) * n + k]
    for c in range(m):
        for k in range(n):
            for i in range(intervals):
                w_at[c, k, i] = e_values[c, 0] * w_u[0, k, i]
            for j in range(1, m + 1):
                x = e_values[c, j]
                for i in range(intervals):
                    w_at[c, k, i] += x * w_u[j, k, i]
    here = np.empty(n)
    total = 0.0
    start = 0.0
    time_column = n + w_p.size - 1
    for i in range(intervals):
        h = z[nodes + 1 + i]
        for c in range(m):
            for k in range(n):
                here[k] = w_at[c, k, i]
            if e_forcing != 0:
                w_p[w_p.size - 1] = period * (start + h * e_gauss[c])
            if with_jacobian:
                call4(e_jacobian, here, w_p, w_F, w_J)
                for k in range(n):
                    for q in range(n):
                        value = w_J[k, q]
                        w_fu[c, k, q, i] = value
                        total += value
                    value = w_J[k, n + e_active]
                    w_fp[c, k, i] = value
                    total += value
                    if e_forcing != 0:
                        w_ft[c, k, i] = w_J[k, time_column]
                        total += w_J[k, time_column]
            else:
                call3(e_value, here, w_p, w_F)
            for k in range(n):
                w_f[c, k, i] = w_F[k]
                total += w_F[k]
        start += h
    return math.isfinite(total)


@kernel
def forcing_period(e, w, z):
    """(period, its derivative by the varying parameter) of a forced system's orbit."""
    w_p = w.p
    w_J = w.J
    w_F = w.F
    e_active = e.active
    e_forcing = e.forcing
    e_multiple = e.multiple
    w_p[e_active] = z[z.size - 1]
    period = np.empty(1)
    derivatives = np.empty((1, w_J.shape[1]))
    call4(e_forcing, w_F, w_p, period, derivatives)
    return e_multiple * period[0], e_multiple * derivatives[0, w_F.size + e_active]


@kernel
def residual(e, w, z, right, jump, border):
    """Minus the residual: right (m n + 2, N) collocation, jump (n,) periodicity, border[0] phase. Needs `evaluate`."""
    w_u = w.u
    w_f = w.f
    w_phase_right = w.phase_right
    w_phase = w.phase
    e_n = e.n
    e_m = e.m
    e_slopes = e.slopes
    e_winding = e.winding
    e_forcing = e.forcing
    n, m = e_n, e_m
    intervals = w_u.shape[2]
    nodes = (intervals * m + 1) * n
    period = z[nodes]
    for c in range(m):
        for k in range(n):
            r = c * n + k
            for i in range(intervals):
                right[r, i] = z[nodes + 1 + i] * period * w_f[c, k, i] - e_slopes[c, 0] * w_u[0, k, i]
            for j in range(1, m + 1):
                x = e_slopes[c, j]
                for i in range(intervals):
                    right[r, i] -= x * w_u[j, k, i]
    for k in range(n):
        jump[k] = z[k] + e_winding[k] - z[nodes - n + k]
    if e_forcing != 0:
        wanted, _ = forcing_period(e, w, z)
        border[0] = wanted - period
    else:
        total = w_phase_right[0]
        for j in range(m + 1):
            for k in range(n):
                for i in range(intervals):
                    total -= w_phase[j, k, i] * w_u[j, k, i]
        border[0] = total


@kernel
def fill(e, w, z, tangent, scale, local, border):
    """The matrix: `local` of `Factors`, border (2, 2) coefficients of T and p. Needs `evaluate` with the Jacobian."""
    w_u = w.u
    w_fu = w.fu
    w_phase = w.phase
    w_f = w.f
    w_fp = w.fp
    w_ft = w.ft
    e_n = e.n
    e_m = e.m
    e_values = e.values
    e_slopes = e.slopes
    e_forcing = e.forcing
    e_gauss = e.gauss
    n, m = e_n, e_m
    intervals = w_u.shape[2]
    nodes = (intervals * m + 1) * n
    period = z[nodes]
    inner = (m - 1) * n
    left, right = inner, inner + n
    last = z.size - 1
    for j in range(m + 1):
        column = left if j == 0 else (right if j == m else (j - 1) * n)
        for c in range(m):
            value = e_values[c, j] * period
            slope = e_slopes[c, j]
            for k in range(n):
                for q in range(n):
                    for i in range(intervals):
                        local[c * n + k, column + q, i] = -value * z[nodes + 1 + i] * w_fu[c, k, q, i]
                for i in range(intervals):
                    local[c * n + k, column + k, i] += slope
        for k in range(n):
            for i in range(intervals):
                local[m * n, column + k, i] = w_phase[j, k, i]
                t = 0.0
                if j < m or i == intervals - 1:
                    index = (i * m + j) * n + k
                    t = tangent[index] / scale[index]
                local[m * n + 1, column + k, i] = t
    for c in range(m):
        for k in range(n):
            for i in range(intervals):
                local[c * n + k, right + n, i] = -z[nodes + 1 + i] * w_f[c, k, i]
                local[c * n + k, right + n + 1, i] = -z[nodes + 1 + i] * period * w_fp[c, k, i]
    if e_forcing != 0:
        start = 0.0
        for i in range(intervals):
            h = z[nodes + 1 + i]
            for c in range(m):
                t = period * (start + h * e_gauss[c])
                for k in range(n):
                    local[c * n + k, right + n, i] -= h * t * w_ft[c, k, i]
            start += h
    for q in range(2):
        for c in range(2):
            for i in range(intervals):
                local[m * n + q, right + n + c, i] = 0.0
    border[0, 0] = 0.0
    border[0, 1] = 0.0
    if e_forcing != 0:
        for column in range(inner + 2 * n):
            for i in range(intervals):
                local[m * n, column, i] = 0.0
        _, derivative = forcing_period(e, w, z)
        border[0, 0] = 1.0
        border[0, 1] = -derivative
    border[1, 0] = tangent[nodes] / scale[nodes]
    border[1, 1] = tangent[last] / scale[last]
