"""Trajectories by DOP853 with dense output and a section; the model is a pointer, memory does not grow with the time.

Step control as in Hairer's code: error estimate of orders 5 and 3 combined, h_new = h 0.9 err^(-1/8). The state may
carry k solutions v of the variational equation v' = f_u v behind u: y = (u, v_1, .., v_k).
"""

import math

import numpy as np

from contin.kernels.compile import call3, call4, kernel
from contin.kernels.dop853 import E3, E5, STAGES, A, B, C, D

DONE, EVENTS, STEPS, SMALL, NOT_FINITE = range(5)
SAFETY, SHRINK, GROW = 0.9, 0.333, 6.0
COLLAPSED = 1e-14  # of the time: a step this short that is not finite ends the integration


@kernel("i, i, b, f, f1, f1, f1, f1, f2, f2, i")
def slope(value, jacobian, forced, t, y, p, u, F, J, out, row):
    """out[row] = dy/dt at (t, y)."""
    n = u.size
    for k in range(n):
        u[k] = y[k]
    if forced:
        p[p.size - 1] = t
    if y.size == n:
        call3(value, u, p, F)
        for k in range(n):
            out[row, k] = F[k]
        return
    call4(jacobian, u, p, F, J)
    for k in range(n):
        out[row, k] = F[k]
    for j in range(1, y.size // n):
        for k in range(n):
            s = 0.0
            for q in range(n):
                s += J[k, q] * y[j * n + q]
            out[row, j * n + k] = s


@kernel("f2, f1, f, f1")
def interpolate(dense, start, x, y):
    """y at the fraction x of the step, from its dense output (7, size) and its start."""
    for k in range(y.size):
        s = 0.0
        for j in range(6, -1, -1):
            s += dense[j, k]
            s *= x if (6 - j) % 2 == 0 else 1.0 - x
        y[k] = start[k] + s


@kernel("i, i, b, f1, f1, f1, f1, i, f1, f1, f2, f2, i1, f2, f1, f1, f2, f2, f2 -> i")
def integrate(
    value, jacobian, forced, y, p, controls, atol, max_steps, section, times, samples, events, counts, work, u, F, J,
    slopes, dense,
):  # fmt: skip
    """Integrate y in place from controls[0] to controls[1]; returns DONE, EVENTS, STEPS, SMALL (step) or NOT_FINITE.

    controls : [t, t_end, h, h_max, rtol]; t and h are updated.  atol : (size,), absolute tolerances.
    section : (n + 2,) [normal, offset, direction]: crossings of normal . u = offset, upwards for direction > 0,
        downwards for < 0, both for 0; where normal is zero there are none. `events` (K, 1 + size) receives (t, y) of up
        to K of them.
    times : increasing, samples (len(times), size) receives y there.
    counts : [samples filled, events found, steps, rejected]; counts[0] and [1] continue from what they are.
    work (3, size), u, F (n,), J (n, n + p_size), slopes (16, size), dense (7, size) : memory.
    """
    size, n = y.size, u.size
    t, t_end, h, h_max, rtol = controls[0], controls[1], controls[2], controls[3], controls[4]
    span = t_end - t
    sectioned = False
    for k in range(n):
        if section[k] != 0.0:
            sectioned = True
    begin, trial, point = work[0], work[1], work[2]
    slope(value, jacobian, forced, t, y, p, u, F, J, slopes, 0)
    if h <= 0.0:
        top, bottom = 0.0, 0.0
        for k in range(size):
            scale = atol[k] + rtol * abs(y[k])
            top += (y[k] / scale) ** 2
            bottom += (slopes[0, k] / scale) ** 2
        moves = top > 1e-10 and bottom * span * span > 1e-10
        h = 0.01 * math.sqrt(top / bottom) if moves else 1e-6 * span
    rejected = False
    for _ in range(max_steps):
        if t >= t_end:
            break
        h = min(h, h_max, t_end - t)
        if h < 1e-14 * max(abs(t), 1e-300) and t_end - t > h:
            controls[0] = t
            return SMALL
        for k in range(size):
            begin[k] = y[k]
        for stage in range(1, STAGES):
            for k in range(size):
                s = 0.0
                for j in range(stage):
                    s += A[stage, j] * slopes[j, k]
                trial[k] = begin[k] + h * s
            slope(value, jacobian, forced, t + C[stage] * h, trial, p, u, F, J, slopes, stage)
        error5, error3 = 0.0, 0.0
        for k in range(size):
            s, e5, e3 = 0.0, 0.0, 0.0
            for j in range(STAGES):
                s += B[j] * slopes[j, k]
                e5 += E5[j] * slopes[j, k]
                e3 += E3[j] * slopes[j, k]
            trial[k] = begin[k] + h * s
            scale = atol[k] + rtol * max(abs(begin[k]), abs(trial[k]))
            error5 += (e5 / scale) ** 2
            error3 += (e3 / scale) ** 2
        bottom = math.sqrt((error5 + 0.01 * error3) * size)
        error = h * error5 / bottom if bottom != 0.0 else 0.0  # NaN stays NaN
        counts[2] += 1
        if not math.isfinite(error):
            if h < COLLAPSED * max(abs(t), span):
                controls[0] = t
                return NOT_FINITE
            h *= 0.1
            rejected = True
            counts[3] += 1
            continue
        factor = SAFETY * error ** (-0.125) if error > 0.0 else GROW
        if error > 1.0:
            h *= max(factor, SHRINK)
            rejected = True
            counts[3] += 1
            continue
        slope(value, jacobian, forced, t + h, trial, p, u, F, J, slopes, STAGES)
        g0, g1 = -section[n], -section[n]
        if sectioned:
            for k in range(n):
                g0 += section[k] * begin[k]
                g1 += section[k] * trial[k]
        crossed = sectioned and (
            (g0 < 0.0 <= g1 and section[n + 1] >= 0.0) or (g0 > 0.0 >= g1 and section[n + 1] <= 0.0)
        )
        sampled = counts[0] < times.size and times[counts[0]] <= t + h
        if crossed or sampled:
            for stage in range(STAGES + 1, STAGES + 4):
                for k in range(size):
                    s = 0.0
                    for j in range(stage):
                        s += A[stage, j] * slopes[j, k]
                    point[k] = begin[k] + h * s
                slope(value, jacobian, forced, t + C[stage] * h, point, p, u, F, J, slopes, stage)
            for k in range(size):
                change = trial[k] - begin[k]
                dense[0, k] = change
                dense[1, k] = h * slopes[0, k] - change
                dense[2, k] = 2.0 * change - h * (slopes[STAGES, k] + slopes[0, k])
                for i in range(4):
                    s = 0.0
                    for j in range(STAGES + 4):
                        s += D[i, j] * slopes[j, k]
                    dense[3 + i, k] = h * s
            while counts[0] < times.size and times[counts[0]] <= t + h:
                interpolate(dense, begin, (times[counts[0]] - t) / h, point)
                for k in range(size):
                    samples[counts[0], k] = point[k]
                counts[0] += 1
            if crossed:
                low, high = 0.0, 1.0
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    interpolate(dense, begin, middle, point)
                    g = -section[n]
                    for k in range(n):
                        g += section[k] * point[k]
                    if (g < 0.0) == (g0 < 0.0):
                        low = middle
                    else:
                        high = middle
                if counts[1] < events.shape[0]:
                    interpolate(dense, begin, high, point)
                    events[counts[1], 0] = t + high * h
                    for k in range(size):
                        events[counts[1], 1 + k] = point[k]
                    counts[1] += 1
        t = t_end if t + h >= t_end else t + h
        for k in range(size):
            y[k] = trial[k]
            slopes[0, k] = slopes[STAGES, k]
        controls[0] = t
        h *= min(max(factor, SHRINK), 1.0 if rejected else GROW)
        controls[2] = h
        rejected = False
        if sectioned and counts[1] >= events.shape[0]:
            return EVENTS
    return DONE if t >= t_end else STEPS


def new_work(size, n, p_size):
    """Memory for `integrate`: work, u, F, J, slopes, dense."""
    return (
        np.zeros((3, size)), np.zeros(n), np.zeros(n), np.zeros((n, n + p_size)), np.zeros((STAGES + 4, size)),
        np.zeros((7, size)),
    )  # fmt: skip
