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

from contin.kernels.compile import allocating, call3, call4, kernel, vector_kernel
from contin.kernels.signature import structure

LANES = 10  # up to this many states all intervals are eliminated at once, beyond it one after another

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
        "periods",  # (n,) of angles; 0 of other states
    ],
)
structure(Equations, "i, i, i, i, i, i, i, f2, f2, f1, f1, f1, f1")

Points = namedtuple(
    "Points",
    [
        "u",  # (m + 1, n, N) node values, interval by interval
        "at",  # (m, n, N) values at the Gauss points
        "f",  # (m, n, N)
        "fu",  # (m, n, n, N); with n > LANES (N, m, n, n)
        "fp",  # (m, n, N)
        "ft",  # (m, n, N) time derivative (forced systems)
        "phase",  # (m, n, N) row of the phase condition, on the values at the Gauss points
        "arc",  # (m + 1, n, N) row of the arclength on the node values, each node once
        "phase_right",  # (1,) its value at the reference
        "h",  # (N,) lengths of the intervals
        "F",
        "J",
        "p",  # (m_p,) all parameters (and t), its own copy
    ],
)
structure(Points, "f3, f3, f3, f4, f3, f3, f3, f3, f1, f1, f1, f2, f1")


def new_points(n, m, intervals, p):
    """Memory for values at the Gauss points of one mesh."""
    return Points(
        np.zeros((m + 1, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((intervals, m, n, n) if n > LANES else (m, n, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m, n, intervals)),
        np.zeros((m + 1, n, intervals)),
        np.zeros(1),
        np.zeros(intervals),
        np.zeros(n),
        np.zeros((n, n + p.size)),
        p.copy(),
    )


@kernel("Equations, Points, f1, f1")
def set_phase(e, w, reference, sizes):
    """Phase condition with respect to `reference` (layout of z): row of weights at the Gauss points.

    And its right-hand side. Both vanish for a constant reference.
    """
    u, at, phase = w.u, w.at, w.phase
    n, m = e.n, e.m
    for j in range(m + 1):
        for k in range(n):
            for i in range(u.shape[2]):
                u[j, k, i] = reference[(i * m + j) * n + k]
    _set_rows(e.weights, e.slopes, sizes, u, phase)
    _interpolate(e.values, u, at)
    w.phase_right[0] = _product(phase, at)


@vector_kernel("f1, f2, f1, f3, f3")
def _set_rows(weights, slopes, sizes, u, phase):
    """phase (m, n, N) = weight * u' / size^2 at the Gauss points."""
    nodes, n, intervals = u.shape
    lanes = np.uint64(intervals)
    for c in range(nodes - 1):
        for k in range(n):
            factor = weights[c] / (sizes[k] * sizes[k])
            x = factor * slopes[c, 0]
            for i in range(lanes):
                phase[c, k, i] = x * u[0, k, i]
            for j in range(1, nodes):
                x = factor * slopes[c, j]
                for i in range(lanes):
                    phase[c, k, i] += x * u[j, k, i]


@allocating("Equations, Points, f1, b -> b")
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
    for i in range(intervals):
        w.h[i] = z[nodes + 1 + i]
    for j in range(m + 1):
        for k in range(n):
            for i in range(intervals):
                w_u[j, k, i] = z[(i * m + j) * n + k]
    _interpolate(e_values, w_u, w_at)
    here = np.empty(n)
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
                        if n > LANES:
                            w_fu[i, c, k, q] = w_J[k, q]
                        else:
                            w_fu[c, k, q, i] = w_J[k, q]
                    w_fp[c, k, i] = w_J[k, n + e_active]
                    if e_forcing != 0:
                        w_ft[c, k, i] = w_J[k, time_column]
            else:
                call3(e_value, here, w_p, w_F)
            for k in range(n):
                w_f[c, k, i] = w_F[k]
        start += h
    total = _sum(w_f)
    if with_jacobian:
        total += _sum_of_derivatives(w_fu) + _sum(w_fp)
        if e_forcing != 0:
            total += _sum(w_ft)
    return math.isfinite(total)


@vector_kernel("f3 -> f")
def _sum(a):
    total = 0.0
    for c in range(a.shape[0]):
        for k in range(a.shape[1]):
            for i in range(np.uint64(a.shape[2])):
                total += a[c, k, i]
    return total


@vector_kernel("f4 -> f")
def _sum_of_derivatives(a):
    total = 0.0
    for b in range(a.shape[0]):
        for c in range(a.shape[1]):
            for k in range(a.shape[2]):
                for i in range(np.uint64(a.shape[3])):
                    total += a[b, c, k, i]
    return total


@vector_kernel("f2, f3, f3")
def _interpolate(values, u, at):
    """at (m, n, N) = values (m, m + 1) applied to u (m + 1, n, N)."""
    nodes, n, intervals = u.shape
    lanes = np.uint64(intervals)
    for c in range(nodes - 1):
        for k in range(n):
            for i in range(lanes):
                at[c, k, i] = values[c, 0] * u[0, k, i]
            for j in range(1, nodes):
                x = values[c, j]
                for i in range(lanes):
                    at[c, k, i] += x * u[j, k, i]


@allocating("Equations, Points, f1 -> (f, f)")
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


@kernel("Equations, Points, f1, f2, f1, f1")
def residual(e, w, z, right, jump, border):
    """Minus the residual: right (m n, N) collocation, jump (n,) periodicity, border[0] phase. Needs `evaluate`."""
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
    _defect(e_slopes, w_u, w.h, w_f, period, right)
    for k in range(n):
        jump[k] = z[k] + e_winding[k] - z[nodes - n + k]
    if e_forcing != 0:
        wanted, _ = forcing_period(e, w, z)
        border[0] = wanted - period
    else:
        border[0] = w_phase_right[0] - _product(w_phase, w.at)


@vector_kernel("f2, f3, f1, f3, f, f2")
def _defect(slopes, u, h, f, period, right):
    """right (m n, N): h T f - u' at the Gauss points."""
    nodes, n, intervals = u.shape
    lanes = np.uint64(intervals)
    for c in range(nodes - 1):
        for k in range(n):
            r = c * n + k
            for i in range(lanes):
                right[r, i] = h[i] * period * f[c, k, i] - slopes[c, 0] * u[0, k, i]
            for j in range(1, nodes):
                x = slopes[c, j]
                for i in range(lanes):
                    right[r, i] -= x * u[j, k, i]


@vector_kernel("f3, f3 -> f")
def _product(a, b):
    """Sum of a * b, both (m, n, N)."""
    nodes, n, intervals = a.shape
    total = 0.0
    for j in range(nodes):
        for k in range(n):
            for i in range(np.uint64(intervals)):
                total += a[j, k, i] * b[j, k, i]
    return total
