"""Landing on a switching surface, and what happens there: new modes, and the jump of the variations (saltation).

Crossing h = 0 with speed dh/dt = h_u f- + h_t, a variation v becomes v + (f+ - f-) (h_u v + h_q) / (dh/dt): the
saltation matrix (di Bernardo, Budd, Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, sec. 2.5), with
the sensitivity h_q where v is one to a parameter q. Surfaces met together are crossed one after the other.
"""

from contin.kernels.compile import allocating, call3, kernel, part
from contin.kernels.dense import assign
from contin.kernels.dop853 import STAGES
from contin.kernels.piecewise.flow import crossing_speed, rates, set_mode, slope_at
from contin.kernels.piecewise.step import attempt, first_zero, prepare_dense, short_step

BUDGET = 40
TRIES = 6  # at the place of a minimum that may be negative
CLOSE = 3e-3  # of the step: from here a step of order 4 lands on the surface to rounding
TINY = 1e-7  # of the step: ... and from here a step of order 1 does
TOGETHER = 1e-12  # of the step: surfaces met within this time are met together
GRAZING = 1e-9  # relative speed below which the surface is touched, not crossed: no saltation


@part
def wanted(flow, m, j):
    """True for surfaces whose zero ends a piece: all of them, and the section in its direction."""
    if j < flow.surface_count:
        return True
    direction = flow.section[flow.n + 1]
    return direction == 0.0 or direction * m.sigma[j] < 0.0


@kernel("Flow, FlightMemory, f -> (i, f)")
def earliest(flow, m, h):
    """(surface, fraction of the step) met first between m.g0, m.d0 and m.g1, m.d1; (-1, 2) for none.

    A negative fraction: only a low minimum.
    """
    best, place = -1, 2.0
    for j in range(flow.surface_count + 1):
        if (m.g1[j] < 0.0 or m.d0[j] < 0.0 < m.d1[j]) and wanted(flow, m, j):
            x = first_zero(m.g0[j], h * m.d0[j], m.g1[j], h * m.d1[j])
            if abs(x) < abs(place):
                best, place = j, x
    return best, place


@kernel("Flow, FlightMemory, f, f, i, f, f, f1, f, f1 -> (i, f)")
def land(flow, m, t, h, j, place, rtol, atol, next_sample, landing):
    """Shorten the step from m.begin so that it ends on the first surface met, within a step that crosses surface j.

    Returns (surface, length): m.trial lies on it, its slope in row STAGES, g and dg/dt in m.g1, m.d1; surface -1 where
    a low minimum turned out not to cross: m.trial is then an ordinary point. landing[0]: length of the DOP853 step,
    landing[1]: length of the rest, landing[2]: 1 where the surface is only touched. The dense output is
    prepared where it reaches next_sample.
    """
    low, high, tries = 0.0, h, 0
    tentative = place < 0.0
    length = abs(place) * h
    landing[2] = 0.0
    for _ in range(BUDGET):
        attempt(flow, m, t, length, rtol, atol)
        slope_at(flow, m, t + length, m.trial, STAGES)
        rates(flow, m, t + length, m.trial, m.slopes[STAGES], m.g1, m.d1)
        if tentative and m.g1[j] >= 0.0:
            bend = (m.d1[j] - m.d0[j]) / length  # dg/dt is nearly zero here: by how much does g still fall?
            shift = -m.d1[j] / bend if bend > 0.0 else 0.0
            tries += 1
            if m.g1[j] + 0.5 * m.d1[j] * shift < 0.0 and tries < TRIES and TINY * h < length + shift < h:
                length += shift
                continue
            landing[0], landing[1] = length, 0.0
            return -1, length
        earlier, fraction = earliest_negative(flow, m, length, j)
        if earlier >= 0:
            j, high, low, tentative = earlier, length, 0.0, False
            length *= fraction
            continue
        tentative = False
        rest = -m.g1[j] / m.d1[j] if m.d1[j] < 0.0 else 2.0 * h
        if abs(rest) <= CLOSE * h or high - low <= 1e-13 * h:
            break
        if m.g1[j] > 0.0:
            low = length
        else:
            high = length
        length = length + rest if low < length + rest < high else 0.5 * (low + high)
    landing[0] = length
    if next_sample <= t + length + CLOSE * h:  # now: the short steps take the slopes that it needs
        prepare_dense(flow, m, t, length)
    total, before = 0.0, h
    for _ in range(8):
        if not m.d1[j] < 0.0:
            landing[2] = 1.0
            break
        rest = -m.g1[j] / m.d1[j]
        if abs(rest) > CLOSE * h or abs(rest) >= 0.5 * before or abs(rest) <= 1e-16 * h:
            break
        before = abs(rest)
        total += rest
        if before < TINY * h:
            for k in range(m.trial.size):
                m.trial[k] += rest * m.slopes[STAGES, k]
            slope_at(flow, m, t + length + total, m.trial, STAGES)
        else:
            short_step(flow, m, t + length + total - rest, rest)
        rates(flow, m, t + length + total, m.trial, m.slopes[STAGES], m.g1, m.d1)
    landing[1] = total
    return j, length + total


@kernel("Flow, FlightMemory, f, i -> (i, f)")
def earliest_negative(flow, m, length, j):
    """Another surface than j that is already passed at the end of the step, and where (fraction); -1 for none."""
    best, place = -1, 2.0
    for i in range(flow.surface_count + 1):
        if i != j and m.g1[i] < -TOGETHER * length * abs(m.d1[i]) and wanted(flow, m, i):
            x = first_zero(m.g0[i], length * m.d0[i], m.g1[i], length * m.d1[i])
            if x < place:
                best, place = i, x
    return best, place


@allocating("Flow, FlightMemory, f, i, b -> i")
def cross(flow, m, h, met, touched):
    """New modes at m.trial, which lies on surface `met`, and the saltation of its variations; repairs m.g1.

    Surfaces that lie there too (the two of two equal oscillators) are crossed if the flow goes out through them in the
    modes that hold by then. Returns -1; the surface where the flow returns from the far side at once (sliding); or -2
    where the modes do not settle. m.d0 is 1 for the surfaces crossed. The slope in row STAGES is then out of date.
    """
    n, surfaces = flow.n, flow.surface_count + 1
    old, new = m.point[:n], m.begin[:n]  # free now
    assign(old, m.slopes[STAGES])
    for i in range(surfaces):
        on = i == met or m.g1[i] <= TOGETHER * h * abs(m.d1[i])
        m.g0[i] = 1.0 if on and (i < flow.surface_count or i == met) else 0.0
        m.d0[i] = 0.0
    section = flow.surface_count
    if met == section:
        m.sigma[section] = -m.sigma[section]
    forced = touched  # the sign behind a touched surface cannot be told from the speed
    for _ in range(2 * surfaces + 2):
        changed = False
        for i in range(flow.surface_count):
            if m.g0[i] == 0.0:
                continue
            speed = crossing_speed(flow, m, i, old)
            if not (speed * m.sigma[i] < 0.0 or (forced and i == met)):
                continue
            set_mode(flow, m, i, -m.sigma[i])
            assign(m.u, m.trial)
            call3(flow.value, m.u, m.p, m.f)
            assign(new, m.f)
            after = crossing_speed(flow, m, i, new)
            if after * m.sigma[i] <= 0.0 and not forced:
                return i
            size = 0.0
            for k in range(n):
                size += abs(m.dh[i, k] * old[k])
            if abs(speed) > GRAZING * size:
                for c in range(flow.columns.size):
                    at = (c + 1) * n
                    column = flow.columns[c]
                    s = m.dh[i, column] if column >= 0 else 0.0
                    for k in range(n):
                        s += m.dh[i, k] * m.trial[at + k]
                    for k in range(n):
                        m.trial[at + k] += (new[k] - old[k]) * s / speed
            assign(old, new)
            m.d0[i] = 1.0
            changed = True
            forced = False
        if not changed:
            return -1
    return -2
