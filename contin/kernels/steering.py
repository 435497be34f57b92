"""What every march decides after a step: how long the next one is, and whether something happened on the way.

Parts of kernels (`contin.kernels.compile.part`): put in place where they are called; sharing them costs nothing.
"""

import math

from contin.kernels.compile import inlined

# why a march stopped
LIMIT, EVENT, DIP, BOUND, CORRECTOR, NOT_FINITE, RESCALE, LOOP, CORNER = range(9)

STAGNATION = 1e-6  # a Newton correction below this that no longer falls is at the attainable accuracy
STALLED = 0.9  # one of at least this part of the last one does not fall; less fast ones fall like a geometric series
DIP_FRACTION = 0.5  # a local minimum of |test| is looked at when its parabola falls below this part of it
GUARD = 0.6  # a step is refined while a test function differs from its linear prediction by more than this part
GUARD_FLOOR = 2e-3  # ... but not below this arclength
GROWTH = 2.0  # largest growth of a step
SHRINK = 0.3  # smallest
FAR = 20.0  # more than GROWTH to any order up to 4: a correction so far below what is wanted lets the step grow
RESCALE_AT = 2.0  # the metric is renewed when a state exceeds its scale by this factor
ROUNDING = 1e-13  # a first correction below this says nothing: the branch is a straight line
CLOSE = 1.5  # steps: distance from its start within which a branch passes it
SHORTEST = 1e-7  # arclength at which a tangent that still turns too far is a corner's

BISECTED = 1e-9  # of a step, to which it is bisected where its end may be on another curve
ONE_POINT = 1e-7  # scaled: two curves nearer to each other than this are crossing, to what rows beside that are worth
TOLD = 3e-6  # ... of orbits: on a mesh, curves that cross miss each other by the root of what their equations are off
SHIFT, LEAST = 0.7, 0.1  # parts of what is left at which it is cut, where half of it has no solution
BEFORE = 1.0  # times the distance of two curves: as far before the place where one turns off beside the other

ACCEPTED, AT_CORNER, TURNED, STRAYED = range(4)  # what a march makes of a corrected point


@inlined("f, f, f, f, f -> b")
def is_dip(before, here, after, h_before, h_after):
    """True where |test| has a local minimum at `here` that may hide two zeros.

    So say the parabola through three points, or the line through two of them, on either side (a corner's minimum).
    """
    if before * here <= 0.0 or here * after <= 0.0:
        return False
    a, b, c = abs(before), abs(here), abs(after)
    if not (b < a and b <= c):
        return False
    left = (b - a) / h_before
    right = (c - b) / h_after
    if b + left * h_after <= 0.0 or b - right * h_before <= 0.0:
        return True
    second = (right - left) / (h_before + h_after)
    if second <= 0.0:
        return False
    slope = (left * h_after + right * h_before) / (h_before + h_after)
    return b - slope * slope / (4.0 * second) < DIP_FRACTION * b


@inlined("f1, f1, f1, f1, f, f, f1, f1")
def set_out(origin, tangent, old, scale, h, h_previous, y, z):
    """Predict the point at h: along the tangent and, where the tangent before is known, its change. y is scaled."""
    bend = 0.5 * h * h / h_previous if h_previous > 0.0 else 0.0
    for j in range(y.size):
        y[j] = h * tangent[j] + bend * (tangent[j] - old[j])
        z[j] = origin[j] + scale[j] * y[j]


@inlined("f, f, f, f -> b")
def leaves(distance, h, cos_max, tolerance):
    """True where the chord to the corrected point turns too far from the tangent at which the step has set out.

    A path whose tangents turn by less than an angle has a chord that does not turn by more. Where it does, the point is
    on another branch that is nearly parallel (past a pitchfork, the trivial one), or the path bends and bends back.
    distance : of the corrected point.  Steps as short as a corner's may turn by 60 degrees.
    """
    return distance * (cos_max if h > SHORTEST else 0.5) > h + 10.0 * tolerance


@inlined("f1, f2, i, f1, i, b, f, f -> b")
def strays(tests, rows, k, previous, first, signed, h, h_previous):
    """True where a test from `first` on is far from what the two points before predict.

    `signed` : tests that change sign or are zero between those points are left out.
    """
    rough = False
    for i in range(first, tests.size):
        a = rows[k - 1, i] if k > 0 else previous[i]
        b = rows[k, i]
        if abs(tests[i] - b - (b - a) * h / h_previous) > GUARD * max(abs(a), abs(b), abs(tests[i])):
            rough = rough or not signed or a * b != 0.0
    return rough


@inlined("f1, f2, i, f1, i, b, f, f, f, f, f, b -> i")
def judged(tests, rows, k, previous, first, signed, cosine, cos_max, h, h_min, h_previous, may_stray):
    """What the march makes of a corrected point: ACCEPTED; TURNED too far from row k, or AT_CORNER where no step can be
    shorter; STRAYED from what tests are predicted (`strays`), where it `may_stray`.

    h_previous : 0 where the row before is unknown.
    """
    if not cosine >= cos_max:
        return AT_CORNER if h <= max(h_min, SHORTEST) else TURNED
    guarding = may_stray and h > GUARD_FLOOR and h_previous > 0.0
    return STRAYED if guarding and strays(tests, rows, k, previous, first, signed, h, h_previous) else ACCEPTED


@inlined("i, f, f -> f")
def shortened(verdict, h, h_min):
    """The step after one that TURNED or STRAYED."""
    return max(0.5 * h, 0.5 * GUARD_FLOOR) if verdict == STRAYED else max(0.5 * h, h_min, SHORTEST)


@inlined("f1, f2, i, f1, i, f, f -> i")
def dipping(tests, rows, k, previous, first, h_previous, h):
    """The test from `first` on that may have touched zero at row k, between the row before and the new point; or -1."""
    found = -1
    for i in range(first, tests.size):
        a = rows[k - 1, i] if k > 0 else previous[i]
        if found < 0 and is_dip(a, rows[k, i], tests[i], h_previous, h):
            found = i
    return found


@inlined("f1, f2, i -> b")
def crossed(tests, rows, k):
    """True where a test has changed sign since row k, or is zero at one of the two."""
    found = False
    for i in range(tests.size):
        found |= tests[i] * rows[k, i] < 0.0 or (tests[i] == 0.0) != (rows[k, i] == 0.0)
    return found


@inlined("f1, f2, i, f1, i, b, f, f, f1 -> i")
def met(tests, rows, k, previous, first, changed, h_previous, h, info):
    """EVENT where something `changed`, DIP where a test has dipped (which one: info[4]), else LIMIT: nothing."""
    if changed:
        return EVENT
    dipped = -1
    if h_previous > 0.0:
        dipped = dipping(tests, rows, k, previous, first, h_previous, h)
    if dipped < 0:
        return LIMIT
    info[4] = dipped
    return DIP


@inlined("f1, f1, f2, f2, i")
def record(z, tests, rows, rows_of_tests, k):
    """Row k becomes this point and its tests."""
    for j in range(z.size):
        rows[k, j] = z[j]
    for i in range(tests.size):
        rows_of_tests[k, i] = tests[i]


@inlined("f2, f1, i, f1")
def recall(rows, previous, k, out):
    """out : row k - 1; `previous` is that before row 0."""
    for j in range(out.size):
        out[j] = rows[k - 1, j] if k > 0 else previous[j]


@inlined("f, f -> f")
def turn(cosine, target_angle):
    """The angle between two unit tangents, 0 where it is certainly less than a half of `target_angle`."""
    if 20.0 * (1.0 - cosine) < target_angle * target_angle:  # acos(c) <= pi sqrt((1 - c) / 2)
        return 0.0
    return math.acos(min(max(cosine, -1.0), 1.0))


@inlined("f, f, f, f, f, f, f, f, f, f -> f")
def next_step(h, angle, target_angle, correction, wanted, order, iterations, most, h_min, h_max):
    """The next step from the tangent's turn, the corrector's first correction (~ h^order) and its iterations."""
    factor = GROWTH
    if angle > 0.0:
        factor = min(factor, target_angle / angle)
    if correction > ROUNDING and wanted < FAR * correction:
        factor = min(factor, (wanted / correction) ** (1.0 / order))
    if iterations > most:
        factor = min(factor, most / iterations)
    return min(max(h * max(factor, SHRINK), h_min), h_max)


@inlined("f1, f1, f1, f1, f1, f1, f1, f -> b")
def passes_start(z, last_z, loop_z, loop_tangent, seen, periods, scale, h):
    """True where the branch passes its start between `last_z` and `z`, in its sense.

    seen (N,) : 0 for unknowns that are ignored.  periods (<= N,) : of the leading unknowns, 0 where one is no angle.
    """
    here = 0.0
    last = 0.0
    distance = 0.0
    for j in range(z.size):
        if seen[j] == 0.0:
            continue
        d = z[j] - loop_z[j]
        e = last_z[j] - loop_z[j]
        if j < periods.size and periods[j] > 0.0:
            shift = periods[j] * math.floor(d / periods[j] + 0.5)
            d -= shift
            e -= shift
        d /= scale[j]
        e /= scale[j]
        here += loop_tangent[j] * d
        last += loop_tangent[j] * e
        distance += d * d
    return last < 0.0 and here >= 0.0 and math.sqrt(distance) <= CLOSE * h
