"""Landing on a switching surface: the step is shortened so that it ends on the first one met."""

from contin.kernels.compile import kernel, part
from contin.kernels.dop853 import STAGES
from contin.kernels.piecewise.flow import rates, slope_at
from contin.kernels.piecewise.step import attempt, first_zero, prepare_dense, short_step

BUDGET = 40
TRIES = 6  # at the place of a minimum that may be negative
CLOSE = 3e-3  # of the step: from here a step of order 4 lands on the surface to rounding
TINY = 1e-7  # of the step: ... and from here a step of order 1 does
TOGETHER = 1e-8  # of the step: surfaces met within this time are met together, at an error of its square


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
    total = 0.0
    for _ in range(flow.surface_count + 1):
        total = refine(flow, m, t + length, total, h, j, landing)
        passed = earlier_by_little(flow, m, h, j)  # the cubics do not tell crossings apart that are this close
        if passed < 0 or landing[2] > 0.0:
            break
        j = passed
    landing[1] = total
    return j, length + total


@kernel("Flow, FlightMemory, f, f, f, i, f1 -> f")
def refine(flow, m, t, total, h, j, landing):
    """Land on surface j to rounding from m.trial at t + total, which is very near it; returns the new total."""
    before = h
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
            slope_at(flow, m, t + total, m.trial, STAGES)
        else:
            short_step(flow, m, t + total - rest, rest)
        rates(flow, m, t + total, m.trial, m.slopes[STAGES], m.g1, m.d1)
    return total


@kernel("Flow, FlightMemory, f, i -> i")
def earlier_by_little(flow, m, h, j):
    """The surface that was passed the longest before m.trial, on surface j, where that is near; -1 for none.

    Only in the order in which they are met has the flow the derivatives that the saltations give it.
    """
    best, place = -1, -TOGETHER * h
    for i in range(flow.surface_count + 1):
        if i != j and m.g1[i] < 0.0 and m.d1[i] < 0.0 and wanted(flow, m, i):
            x = -m.g1[i] / m.d1[i]
            if -CLOSE * h < x < place:
                best, place = i, x
    return best


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
