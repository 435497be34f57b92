"""The matrix of the linearised equations, down to what the inner stages of every interval are left with."""

from contin.kernels.collocation import LANES, forcing_period
from contin.kernels.compile import kernel
from contin.kernels.stages_dense import (
    fill_borders_dense,
    fill_columns_dense,
    fill_local_dense,
    fill_timing_dense,
    invert_pair_dense,
)
from contin.kernels.stages_lanes import fill_borders, fill_columns, fill_local, invert_pair


@kernel("Equations, Points, f1, f1, f1, Factors, f2 -> i")
def fill(e, w, z, tangent, scale, s, border):
    """s.local and s.stages of `Factors`; border (2, 2): coefficients of T and p. Needs `evaluate` with the Jacobian.

    Returns the sign of the determinant of what is eliminated; 0 where a pivot vanishes.
    """
    arc, g = w.arc, s.stages
    n, m = e.n, e.m
    intervals = w.u.shape[2]
    nodes = (intervals * m + 1) * n
    period = z[nodes]
    last = z.size - 1
    for j in range(m):
        for k in range(n):
            for i in range(intervals):
                index = (i * m + j) * n + k
                arc[j, k, i] = tangent[index] / scale[index]
    for k in range(n):  # the last node of an interval is the first of the next one
        arc[m, k, intervals - 1] = tangent[nodes - n + k] / scale[nodes - n + k]
    border[0, 0] = 0.0
    border[0, 1] = 0.0
    if e.forcing != 0:
        _, derivative = forcing_period(e, w, z)
        border[0, 0] = 1.0
        border[0, 1] = -derivative
    border[1, 0] = tangent[nodes] / scale[nodes]
    border[1, 1] = tangent[last] / scale[last]
    if n <= LANES:
        sign = invert_pair(e, w, period, g, s.work)
        if sign != 0:
            fill_columns(e, w, period, g)
            fill_borders(e, w, arc, g)
            fill_local(e, w, period, g, s.local)
        return sign
    sign = 1
    start = 0.0
    for i in range(intervals):
        sign *= invert_pair_dense(e, w, period, g, i, s.panel)
        if sign == 0:
            return 0
        fill_columns_dense(e, w, period, g, i, start)
        fill_borders_dense(e, w, arc, g, i)
        fill_local_dense(e, w, period, g, i, s.local)
        fill_timing_dense(e, g, i, s.local)
        start += w.h[i]
    return sign
