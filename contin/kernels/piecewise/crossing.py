"""What happens on a surface: new modes, and the jump of the variations (saltation).

Crossing h = 0 with speed dh/dt = h_u f- + h_t, a variation v becomes v + (f+ - f-) (h_u v + h_q) / (dh/dt): the
saltation matrix (di Bernardo, Budd, Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, sec. 2.5), with
the sensitivity h_q where v is one to a parameter q. Surfaces met together are crossed one after the other, in every
order where variations are carried.
"""

import math

from contin.kernels.compile import allocating, call3, kernel, part
from contin.kernels.dense import assign
from contin.kernels.dop853 import STAGES
from contin.kernels.piecewise.flow import crossing_speed, set_mode
from contin.kernels.piecewise.landing import TOGETHER

GRAZING = 1e-9  # relative speed below which the surface is touched, not crossed: no saltation


@allocating("Flow, FlightMemory, f, i, b -> i")
def cross(flow, m, h, met, touched):
    """New modes at m.trial, which lies on surface `met`, and the saltation of its variations; repairs m.g1.

    Surfaces that lie there too (the two of two equal oscillators) are crossed if the flow goes out through them in the
    modes that hold by then, in the order of time: the state, which is beside them by up to `TOGETHER`, is corrected to
    first order. Returns -1; the surface where the flow returns from the far side at once (sliding); or -2 where the
    modes do not settle. m.d0: how often each surface is crossed. The slope in row STAGES is then out of date.
    """
    n, surfaces = flow.n, flow.surface_count + 1
    old, new = m.point[:n], m.begin[:n]  # free now, and so is the dense output
    assign(old, m.slopes[STAGES])
    assign(m.dense[0], m.trial)
    for i in range(surfaces):
        on = i == met or m.g1[i] <= TOGETHER * h * abs(m.d1[i])
        m.g0[i] = 1.0 if on and (i < flow.surface_count or i == met) else 0.0
        m.d0[i] = 0.0
        m.d1[i] = m.sigma[i] * m.g1[i] if i != met else 0.0  # the surface function; the rates are found anew
    section = flow.surface_count
    if met == section:
        m.sigma[section] = -m.sigma[section]
    if touched and met < section:  # the sign behind a touched surface cannot be told from the speed
        pass_through(flow, m, met, m.trial, old, new, True)
        m.d0[met] += 1.0
    for _ in range(surfaces * (2 * surfaces + 2)):
        i = first_out(flow, m, old)
        if i < 0:
            if flow.columns.size > 0 and not touched:
                average_over_orders(flow, m, old, new)
            return -1
        after = pass_through(flow, m, i, m.trial, old, new, True)
        if after * m.sigma[i] <= 0.0:
            return i
        m.d0[i] += 1.0
    return -2


@part
def ahead(flow, m, i):
    """The surface function of i at m.trial, to first order in what the states have been corrected by."""
    s = m.d1[i]
    for k in range(flow.n):
        s += m.dh[i, k] * (m.trial[k] - m.dense[0, k])
    return s


@kernel("Flow, FlightMemory, f1 -> i")
def first_out(flow, m, slope):
    """Of the surfaces at m.trial through which the flow goes out, the one that it comes to first; -1 for none."""
    best, place = -1, math.inf
    for i in range(flow.surface_count):
        if m.g0[i] > 0.0:
            speed = crossing_speed(flow, m, i, slope)
            if speed * m.sigma[i] < 0.0:
                x = -ahead(flow, m, i) / speed
                if x < place:
                    best, place = i, x
    return best


@part
def pass_through(flow, m, i, y, old, new, states):
    """Cross surface i at m.trial: its mode, the slope `old` of the states, the variations in y, and, where `states`
    says so, these (in m.trial); returns dh_i/dt behind it."""
    n = flow.n
    speed = crossing_speed(flow, m, i, old)
    left = ahead(flow, m, i) if states else 0.0
    set_mode(flow, m, i, -m.sigma[i])
    for k in range(n):
        m.u[k] = m.trial[k]
    call3(flow.value, m.u, m.p, m.f)
    size = 0.0
    for k in range(n):
        new[k] = m.f[k]
        size += abs(m.dh[i, k] * old[k])
    if abs(speed) > GRAZING * size:
        for c in range(flow.columns.size):
            at = (c + 1) * n
            column = flow.columns[c]
            s = m.dh[i, column] if column >= 0 else 0.0
            for k in range(n):
                s += m.dh[i, k] * y[at + k]
            for k in range(n):
                y[at + k] += (new[k] - old[k]) * s / speed
        if left != 0.0:
            for k in range(n):
                m.trial[k] += (new[k] - old[k]) * left / speed
    assign(old, new)
    return crossing_speed(flow, m, i, new)


@allocating("Flow, FlightMemory, f1, f1")
def average_over_orders(flow, m, old, new):
    """The variations in m.trial, where several surfaces have been crossed together, in the mean over their orders.

    Beside such an orbit the order changes, and the derivative of the flow with it: it has one for each of a few cones
    of directions. Their mean has the symmetries that the orbit has, and depends on no rounding error. The orders are
    the rotations of the surfaces' numbers, upwards and downwards (all there are for two and three of them); those in
    which the flow does not go out through every surface do not count. m.dense[0] has the variations before.
    """
    count = 0
    for i in range(flow.surface_count):
        if m.d0[i] > 1.0:
            return
        if m.d0[i] > 0.0:
            m.d1[count] = i
            count += 1
    if count < 2:
        return
    total, y, orders = m.dense[1], m.dense[2], 0
    for k in range(total.size):
        total[k] = 0.0
    for order in range(2 * count):
        assign(y, m.dense[0])
        assign(old, m.slopes[STAGES])
        for c in range(count):
            i = int(m.d1[c])
            set_mode(flow, m, i, -m.sigma[i])
        goes_out = True
        for c in range(count):
            place = (order + c) % count if order < count else (order + count - c) % count
            i = int(m.d1[place])
            goes_out = goes_out and crossing_speed(flow, m, i, old) * m.sigma[i] < 0.0
            pass_through(flow, m, i, y, old, new, False)
        if goes_out:
            orders += 1
            for k in range(total.size):
                total[k] += y[k]
    if orders > 0:
        for k in range(flow.n, total.size):
            m.trial[k] = total[k] / orders
