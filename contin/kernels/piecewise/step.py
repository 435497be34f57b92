"""One step of DOP853 in fixed modes, its dense output, a short step of order 4, and where a surface is met in it."""

import math

import numpy as np

from contin.kernels.compile import allocating, kernel
from contin.kernels.dense import assign
from contin.kernels.dop853 import E3, E5, STAGES, A, B, C, D
from contin.kernels.piecewise.flow import slope, slope_at

# A by rows without its zeros: stage i sums WEIGHT[q] * slopes[SOURCE[q]] for q from ROW[i] to ROW[i + 1]
SOURCE = np.ascontiguousarray(np.nonzero(A[:STAGES, :STAGES])[1])
WEIGHT = A[:STAGES, :STAGES][np.nonzero(A[:STAGES, :STAGES])]
ROW = np.concatenate((np.zeros(1, np.int64), np.cumsum(np.count_nonzero(A[:STAGES, :STAGES], axis=1))))
USED = np.flatnonzero((B != 0.0) | (E5[:STAGES] != 0.0) | (E3[:STAGES] != 0.0))
SCAN = 16  # points of a step at which the Hermite cubic of a surface function is looked at
NEAR = 0.2  # of the smaller end value: a minimum this low may hide two crossings


@kernel("Flow, FlightMemory, f, f, f, f1 -> f")
def attempt(flow, m, t, h, rtol, atol):
    """A step of length h from m.begin (slope in row 0) to m.trial; returns the error estimate (1: as allowed)."""
    begin, trial, slopes, p, u, f, J = m.begin, m.trial, m.slopes, m.p, m.u, m.f, m.J
    value, jacobian, forced, columns = flow.value, flow.jacobian, flow.forced, flow.columns
    size = begin.size
    for stage in range(1, STAGES):
        first, last = ROW[stage], ROW[stage + 1]
        for k in range(size):
            s = 0.0
            for q in range(first, last):
                s += WEIGHT[q] * slopes[SOURCE[q], k]
            trial[k] = begin[k] + h * s
        slope(value, jacobian, forced, columns, t + C[stage] * h, trial, p, u, f, J, slopes, stage)
    error5, error3 = 0.0, 0.0
    for k in range(size):
        s, e5, e3 = 0.0, 0.0, 0.0
        for q in range(USED.size):
            x = slopes[USED[q], k]
            s += B[USED[q]] * x
            e5 += E5[USED[q]] * x
            e3 += E3[USED[q]] * x
        trial[k] = begin[k] + h * s
        scale = atol[k] + rtol * max(abs(begin[k]), abs(trial[k]))
        error5 += (e5 / scale) ** 2
        error3 += (e3 / scale) ** 2
    bottom = math.sqrt((error5 + 0.01 * error3) * size)
    return h * error5 / bottom if bottom > 0.0 else error5


@allocating("Flow, FlightMemory, f, f")
def prepare_dense(flow, m, t, h):
    """Dense output of the step just attempted; the slope at its end stands in row STAGES."""
    size = m.begin.size
    for stage in range(STAGES + 1, STAGES + 4):
        assign(m.point, m.begin)
        for j in range(stage):
            a = h * A[stage, j]
            if a != 0.0:
                for k in range(size):
                    m.point[k] += a * m.slopes[j, k]
        slope_at(flow, m, t + C[stage] * h, m.point, stage)
    for k in range(size):
        change = m.trial[k] - m.begin[k]
        m.dense[0, k] = change
        m.dense[1, k] = h * m.slopes[0, k] - change
        m.dense[2, k] = 2.0 * change - h * (m.slopes[STAGES, k] + m.slopes[0, k])
        for i in range(4):
            s = 0.0
            for j in range(STAGES + 4):
                s += D[i, j] * m.slopes[j, k]
            m.dense[3 + i, k] = h * s


@kernel("Flow, FlightMemory, f, f")
def short_step(flow, m, t, h):
    """Move m.trial (slope in row STAGES) by a very short time h, of either sign: classical order 4, error h^5.

    Uses rows 1 .. 3; the slope at the end is put into row STAGES.
    """
    size = m.trial.size
    first = m.slopes[STAGES]
    for k in range(size):
        m.point[k] = m.trial[k] + 0.5 * h * first[k]
    slope_at(flow, m, t + 0.5 * h, m.point, 1)
    for k in range(size):
        m.point[k] = m.trial[k] + 0.5 * h * m.slopes[1, k]
    slope_at(flow, m, t + 0.5 * h, m.point, 2)
    for k in range(size):
        m.point[k] = m.trial[k] + h * m.slopes[2, k]
    slope_at(flow, m, t + h, m.point, 3)
    for k in range(size):
        m.trial[k] += h / 6.0 * (first[k] + 2.0 * m.slopes[1, k] + 2.0 * m.slopes[2, k] + m.slopes[3, k])
    slope_at(flow, m, t + h, m.trial, STAGES)


@kernel("f, f, f, f, f -> f")
def cubic(x, g0, d0, g1, d1):
    """Hermite cubic on [0, 1] with these values and slopes (d: times the length of the step)."""
    change = g1 - g0
    return g0 + x * (change + (1.0 - x) * ((1.0 - x) * (d0 - change) - x * (d1 - change)))


@kernel("f, f, f, f -> f")
def first_zero(g0, d0, g1, d1):
    """Where the cubic first falls through zero, as a fraction of the step; 2 where it does not.

    Minus the place of a minimum where that comes so low that the function may cross zero twice.
    """
    low, high = 0.0, 1.0
    if g1 >= 0.0:
        if not (d0 < 0.0 < d1 and g0 > 0.0):
            return 2.0
        square, cube = 3.0 * (g1 - g0) - 2.0 * d0 - d1, d0 + d1 - 2.0 * (g1 - g0)
        high = -d0 / (square + math.sqrt(square * square - 3.0 * cube * d0))  # the minimum: d0 < 0 < d1
        lowest = cubic(high, g0, d0, g1, d1)
        if lowest >= 0.0:
            return -high if lowest < NEAR * min(g0, g1) else 2.0
    else:
        for k in range(1, SCAN + 1):
            x = k / SCAN
            if cubic(x, g0, d0, g1, d1) < 0.0:
                high = x
                break
            low = x
    for _ in range(30):
        x = 0.5 * (low + high)
        if cubic(x, g0, d0, g1, d1) < 0.0:
            high = x
        else:
            low = x
        if high - low < 1e-5:
            break
    return 0.5 * (low + high)
