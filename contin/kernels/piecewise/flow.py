"""What the trajectory kernels know of a piecewise-smooth flow: slopes, signs of its surfaces, modes.

A surface function h_j has the mode s_j = +-1, the sign it had where the present piece began; g_j = s_j h_j is positive
inside the piece and falls through zero where it ends. The last surface (index `surface_count`) is the user's section,
which changes no formula.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.compile import call3, call4, kernel, part
from contin.kernels.dop853 import STAGES
from contin.kernels.signature import structure

ON_SURFACE = 1e-14  # |h| beside sum |h_u u|: the start lies on the surface


class Flow(NamedTuple):
    """Addresses (see `contin.lowering.pieces`), sizes, and what is integrated along."""

    value: int
    jacobian: int
    surfaces: int
    n: int
    surface_count: int
    first_mode: int
    forced: bool
    columns: NDArray[np.int64]  # (k,) the column of df/dz added to f_u v of each variation: a sensitivity; -1: none
    section: Array  # (n + 2,) normal, offset, direction; normal 0: no section


structure(Flow, "i, i, i, i, i, i, b, i1, f1")


class FlightMemory(NamedTuple):
    """Arrays the kernels work in; p and sigma carry the state of the flight between calls."""

    p: Array  # parameters, modes, time
    sigma: Array  # (count + 1,) modes; the last is the section's side
    u: Array
    f: Array
    J: Array
    h: Array  # (count,)
    dh: Array  # (count, n + p_size)
    g0: Array  # (count + 1,) g and dg/dt at the beginning of the step
    d0: Array
    g1: Array
    d1: Array
    slopes: Array  # (STAGES + 4, size)
    begin: Array
    trial: Array
    point: Array
    dense: Array


structure(FlightMemory, "f1, f1, f1, f1, f2, f1, f2, f1, f1, f1, f1, f2, f1, f1, f1, f2")


def new_memory(n, count, p_size, size):
    """FlightMemory for a state (with its variations) of this size."""
    surfaces = count + 1
    return FlightMemory(
        np.zeros(p_size), np.zeros(surfaces), np.zeros(n), np.zeros(n), np.zeros((n, n + p_size)), np.zeros(count),
        np.zeros((count, n + p_size)), np.zeros(surfaces), np.zeros(surfaces), np.zeros(surfaces), np.zeros(surfaces),
        np.zeros((STAGES + 4, size)), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((7, size)),
    )  # fmt: skip


@part
def slope(value, jacobian, forced, columns, t, y, p, u, f, J, slopes, row):
    """slopes[row] = dy/dt at (t, y) in the modes of p; y = (u, v_1, .., v_k), v' = f_u v (+ f_q).

    Arguments one by one: handing over all of `FlightMemory` takes longer than a small model's formulas.
    """
    n = u.size
    for k in range(n):
        u[k] = y[k]
    if forced:
        p[p.size - 1] = t
    if y.size == n:
        call3(value, u, p, f)
    else:
        call4(jacobian, u, p, f, J)
    for k in range(n):
        slopes[row, k] = f[k]
    for c in range(columns.size):
        at = (c + 1) * n
        column = columns[c]
        for k in range(n):
            s = J[k, column] if column >= 0 else 0.0
            for q in range(n):
                s += J[k, q] * y[at + q]
            slopes[row, at + k] = s


@part
def slope_at(flow, m, t, y, row):
    """`slope` into m.slopes."""
    slope(flow.value, flow.jacobian, flow.forced, flow.columns, t, y, m.p, m.u, m.f, m.J, m.slopes, row)


@kernel("Flow, FlightMemory, f, f1, f1, f1, f1")
def rates(flow, m, t, y, f, g, d):
    """g_j and dg_j/dt at (t, y), where the state moves with f, for all surfaces and the section."""
    n = flow.n
    if flow.surface_count > 0:
        for k in range(n):
            m.u[k] = y[k]
        if flow.forced:
            m.p[m.p.size - 1] = t
        call4(flow.surfaces, m.u, m.p, m.h, m.dh)
        for j in range(flow.surface_count):
            g[j] = m.sigma[j] * m.h[j]
            d[j] = m.sigma[j] * crossing_speed(flow, m, j, f)
    j = flow.surface_count
    value, speed = -flow.section[n], 0.0
    for k in range(n):
        value += flow.section[k] * y[k]
        speed += flow.section[k] * f[k]
    g[j] = m.sigma[j] * value
    d[j] = m.sigma[j] * speed


@part
def crossing_speed(flow, m, j, f):
    """dh_j/dt along f, from the gradient in memory."""
    n = flow.n
    s = m.dh[j, m.dh.shape[1] - 1] if flow.forced else 0.0
    for k in range(n):
        s += m.dh[j, k] * f[k]
    return s


@kernel("Flow, FlightMemory, f, f1 -> i")
def settle(flow, m, t, y):
    """Modes at a start: signs of the surface functions; on a surface, the side that the flow goes to.

    Returns the surface on which neither side is left (sliding), or -1.
    """
    n = flow.n
    for k in range(n):
        m.u[k] = y[k]
    if flow.forced:
        m.p[m.p.size - 1] = t
    if flow.surface_count > 0:
        call4(flow.surfaces, m.u, m.p, m.h, m.dh)
    for j in range(flow.surface_count):
        size = 0.0
        for k in range(n):
            size += abs(m.dh[j, k] * y[k])
        on = abs(m.h[j]) <= ON_SURFACE * size
        m.g0[j] = 1.0 if on else 0.0
        set_mode(flow, m, j, -1.0 if m.h[j] < 0.0 and not on else 1.0)
    unsettled = -1
    for _ in range(4 * flow.surface_count + 1):
        unsettled = -1
        call3(flow.value, m.u, m.p, m.f)
        for j in range(flow.surface_count):
            if m.g0[j] > 0.0:
                speed = crossing_speed(flow, m, j, m.f)
                if speed * m.sigma[j] < 0.0:
                    set_mode(flow, m, j, -m.sigma[j])
                    unsettled = j
                    break
        if unsettled < 0:
            break
    value, speed, size = -flow.section[n], 0.0, abs(flow.section[n])
    for k in range(n):
        value += flow.section[k] * y[k]
        speed += flow.section[k] * m.f[k]
        size += abs(flow.section[k] * y[k])
    side = value if abs(value) > ON_SURFACE * size else speed
    m.sigma[flow.surface_count] = -1.0 if side < 0.0 else 1.0
    return unsettled


@part
def set_mode(flow, m, j, sign):
    """Give surface j a mode."""
    m.sigma[j] = sign
    if j < flow.surface_count:
        m.p[flow.first_mode + j] = sign
