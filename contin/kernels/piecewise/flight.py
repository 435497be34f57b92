"""The trajectory of a piecewise-smooth flow: DOP853 piece by piece, landing on every surface and on a section.

Step control as in `contin.kernels.runge_kutta`. Memory does not grow with the time.
"""

import math

from contin.kernels.compile import allocating, kernel
from contin.kernels.dense import assign
from contin.kernels.dop853 import STAGES
from contin.kernels.piecewise.crossing import cross
from contin.kernels.piecewise.flow import rates, settle, slope_at
from contin.kernels.piecewise.landing import earliest, land
from contin.kernels.piecewise.step import attempt, prepare_dense
from contin.kernels.runge_kutta import COLLAPSED, GROW, SAFETY, SHRINK, interpolate

DONE, EVENTS, STEPS, SMALL, NOT_FINITE, SLIDING, ESCAPED = range(7)
RESOLVED = 3.0  # step times rate: an oscillation has at least two steps a turn
SHORT_PIECES = 200  # consecutive pieces much shorter than a step: crossings accumulate


@kernel("Flow, FlightMemory, f1, f, f, f1 -> f")
def initial_step(flow, m, y, span, rtol, atol):
    """0.01 |y| / |y'|, weighted as errors are; a part of the time where nothing moves yet."""
    top, bottom = 0.0, 0.0
    for k in range(y.size):
        scale = atol[k] + rtol * abs(y[k])
        top += (y[k] / scale) ** 2
        bottom += (m.slopes[0, k] / scale) ** 2
    moves = top > 1e-10 and bottom * span * span > 1e-10
    return 0.01 * math.sqrt(top / bottom) if moves else 1e-6 * span


@kernel("FlightMemory, i -> f")
def longest(m, n):
    """The longest step that resolves what the last one saw: |change of slope| / |change of state| is a rate.

    The error estimate does not see to it where the state is much smaller than the absolute tolerance.
    """
    top, bottom = 0.0, 0.0
    for k in range(n):
        top += (m.trial[k] - m.begin[k]) ** 2
        bottom += (m.slopes[STAGES, k] - m.slopes[0, k]) ** 2
    return RESOLVED * math.sqrt(top / bottom) if bottom > 0.0 and top > 0.0 else math.inf


@allocating("Flow, FlightMemory, f1, f1, f1, f1, i, b, f1, f2, f2, f2, i1, f1 -> i")
def fly(flow, m, y, controls, atol, box, max_steps, started, times, samples, events, crossings, counts, ends):
    """Integrate y in place from controls[0] to controls[1].

    Returns DONE, EVENTS, STEPS, SMALL, NOT_FINITE, SLIDING or ESCAPED.

    controls : [t, t_end, h, h_max, rtol, t_begin, ...]; t, h and t_begin, the time at m.begin, are updated.
    atol : (size,), absolute tolerances.  box : (n,), largest moduli of the states (ESCAPED; m.begin is then the last
        state inside).
    max_steps : of this call; call again (started = True) to go on: m keeps the modes.
    times, samples (len(times), size) : y wanted at increasing times.  events (K, 1 + size) : crossings of the section.
    crossings (K, 2) : time and surface of the last K crossings, used as a ring.
    counts : [samples, events, steps, rejected, crossings, touched, surface (where SLIDING)].
    ends : the times at which the first accepted steps of this call end.
    """
    t, t_end, h, h_max, rtol = controls[0], controls[1], controls[2], controls[3], controls[4]
    span = t_end - t
    landing = controls[6:]
    n = flow.n
    if not started:
        blocked = settle(flow, m, t, y)
        if blocked >= 0:
            counts[6] = blocked
            return SLIDING
    slope_at(flow, m, t, y, 0)
    rates(flow, m, t, y, m.slopes[0], m.g0, m.d0)
    if h <= 0.0:
        h = initial_step(flow, m, y, span, rtol, atol)
    rejected, short, limit, accepted = False, 0, math.inf, 0
    for _ in range(max_steps):
        if t >= t_end:
            break
        h = min(h, h_max)
        used = min(h, t_end - t)
        if used < 1e-14 * max(abs(t), 1e-300) and t_end - t > used:
            return SMALL
        assign(m.begin, y)
        controls[5] = t
        error = attempt(flow, m, t, used, rtol, atol)
        counts[2] += 1
        if not math.isfinite(error):
            counts[3] += 1
            if h < COLLAPSED * max(abs(t), span):
                return NOT_FINITE
            h, rejected = 0.1 * used, True
            continue
        factor = SAFETY * error ** (-0.125) if error > 0.0 else GROW
        if error > 1.0:
            counts[3] += 1
            h, rejected = used * max(factor, SHRINK), True
            continue
        slope_at(flow, m, t + used, m.trial, STAGES)
        rates(flow, m, t + used, m.trial, m.slopes[STAGES], m.g1, m.d1)
        met, place = earliest(flow, m, used)
        length, touched, dense = used, False, False
        wanted_at = times[counts[0]] if counts[0] < times.size else math.inf
        if met >= 0:
            met, length = land(flow, m, t, used, met, place, rtol, atol, wanted_at, landing)
            touched, dense = landing[2] > 0.0, met >= 0
        if wanted_at <= t + length:
            span = landing[0] if dense else length
            if not dense:
                prepare_dense(flow, m, t, length)
            while counts[0] < times.size and times[counts[0]] <= t + length:
                interpolate(m.dense, m.begin, (times[counts[0]] - t) / span, m.point)
                assign(samples[counts[0]], m.point)
                counts[0] += 1
        t = t_end if length == used and t + used >= t_end else t + length
        if accepted < ends.size:
            ends[accepted] = t
        accepted += 1
        if met >= 0:
            short = short + 1 if length < 1e-6 * used else 0
            if met == flow.surface_count and counts[1] < events.shape[0]:
                events[counts[1], 0] = t
                for k in range(m.trial.size):
                    events[counts[1], 1 + k] = m.trial[k]
                counts[1] += 1
            counts[5] += 1 if touched else 0
            blocked = cross(flow, m, used, met, touched)
            for j in range(flow.surface_count):
                if m.d0[j] == 0.0:
                    continue
                if crossings.shape[0] > 0:
                    crossings[counts[4] % crossings.shape[0], 0] = t
                    crossings[counts[4] % crossings.shape[0], 1] = j
                counts[4] += 1
            if blocked != -1 or short > SHORT_PIECES:
                counts[6] = blocked if blocked >= 0 else met
                assign(y, m.trial)
                controls[0] = t
                return SLIDING
            assign(y, m.trial)
            slope_at(flow, m, t, y, 0)
            rates(flow, m, t, y, m.slopes[0], m.g0, m.d0)
            for j in range(flow.surface_count + 1):
                if m.g0[j] < 0.0 or j == met:  # on it, to rounding
                    m.g0[j] = max(m.g0[j], 0.0)
        else:
            limit = longest(m, n)
            assign(y, m.trial)
            assign(m.slopes[0], m.slopes[STAGES])
            for j in range(flow.surface_count + 1):
                if m.g1[j] < 0.0 and j == flow.surface_count:  # the section, against its direction
                    m.sigma[j] = -m.sigma[j]
                    m.g1[j], m.d1[j] = -m.g1[j], -m.d1[j]
                m.g0[j], m.d0[j] = m.g1[j], m.d1[j]
        controls[0] = t
        grown = used * min(max(factor, SHRINK), 1.0 if rejected else GROW)
        h = min(grown if used == h or grown > h else h, max(limit, SHRINK * used))
        controls[2] = h
        rejected = False
        if counts[1] >= events.shape[0] > 0:
            return EVENTS
        for k in range(n):
            if not abs(y[k]) <= box[k]:
                return ESCAPED
    return DONE if t >= t_end else STEPS
