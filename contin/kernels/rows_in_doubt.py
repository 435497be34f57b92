"""Whether any step between many rows leaves something to be asked: each inequality of three looks, in one pass.

The looks themselves are `continuation.explained`, `continuation.metric` and `continuation.unexplained_steps`, which
take some twenty arrays of all rows. Here a step is in doubt by the same inequalities, relaxed by what another order of
sums may change: where none of thousands is, as almost always, nothing else is asked; where one is, the look decides.
"""

import math

from contin.kernels.compile import inlined, kernel

NEARLY = 1.0 - 1e-6  # of a limit: from here on a value is in doubt
TINY = 1e-300

# of `explained`
UNEXPLAINED = 0.2  # part of a state's change, or of its slopes' (of resolved steps: 1e-3)
STRAY = 0.6  # part of a state's largest slope by which it differs from the line through the two before
ASIDE = 0.09  # part of a step's length by which a state is not where the mean tangent leads (of resolved: 1e-2)
VANISHED = 1e-2  # part of a state that a step leaves of it where it is zero on another branch, ...
LEVEL = 0.1  # ... and part of its slope, where it is constant there
COUNTS = 3e-4  # of its scale: a state that changes less in a step is not asked by itself (a cubic's flat middle)

# of `metric.unresolved`
SMALL = 0.01  # of a scale: states that stay below it are measured by their own size where ...
ROUNDED = 1e-7  # of a scale: less is what rounding of terms of the scale's size may leave of zero
STAYS = 0.25  # of the larger of two values, the other: on the way through zero a state's value is not its size

# of `unexplained_steps`
REMNANT = 0.05  # part of a state that a few steps leave of it where it is zero on another branch
EPSILON = 2.0**-52  # scaled: a state below it is the rounding of one that is zero
NEXT = 3  # rows: one or two that the corrector leaves between two branches are none of either


@kernel("f2, f2, f1, f1, f1, f, f, b -> b")
def are_explained(z, t, lengths, scale, before, length, noise, each):
    """True where no step may be unexplained. before, length : the tangent before row 0 and the step from there, or 0.

    each : unknowns are asked by themselves, too.
    """
    for k in range(1, lengths.size):
        h = lengths[k]
        last = lengths[k - 1] if k > 1 else length
        for j in range(scale.size):
            a = z[k - 1, j] / scale[j]
            b = z[k, j] / scale[j]
            u = t[k - 1, j]
            v = t[k, j]
            moved = b - a
            rest = abs(moved - 0.5 * h * (u + v))
            if rest > NEARLY * (ASIDE * h + noise):
                return False
            if not each:
                continue
            moved = abs(moved)
            counts = moved > NEARLY * max(noise, COUNTS)
            level = NEARLY * abs(v) < LEVEL * abs(u) and moved > NEARLY * noise
            if not counts and not level:
                continue
            if level and NEARLY * abs(b) < VANISHED * abs(a):
                return False
            steep = max(abs(u), abs(v))
            if rest > NEARLY * UNEXPLAINED * max(steep * h, moved):
                return False
            if last > 0.0:
                w = t[k - 2, j] if k > 1 else before[j]
                if abs((v - u) / h - (u - w) / last) * h > NEARLY * STRAY * max(steep, abs(w)):
                    return False
    return True


@kernel("f2, f2, f1, f1, f -> b")
def are_resolved(z, t, scale, angle_periods, noise):
    """True where no step may be too long for a state that is far below its scale."""
    n = scale.size - 1
    root = math.sqrt(n)
    for k in range(1, z.shape[0]):
        along = math.nan  # of the chord on the mean tangent, where it is asked for
        for j in range(n):
            a = z[k - 1, j] / scale[j]
            b = z[k, j] / scale[j]
            size = root * max(abs(a), abs(b))
            if NEARLY * size >= SMALL or size <= NEARLY * ROUNDED or a * b <= 0.0:
                continue
            if root * min(abs(a), abs(b)) <= NEARLY * STAYS * size or angle_periods[j] != 0.0:
                continue
            if math.isnan(along):
                along = _along(z, t, scale, k)
            moved = b - a
            led = along * 0.5 * (t[k - 1, j] + t[k, j])
            change = max(abs(moved), abs(led))
            if change > NEARLY * noise and abs(moved - led) > NEARLY * UNEXPLAINED * change:
                return False
    return True


@inlined("f2, f2, f1, i -> f")
def _along(z, t, scale, k):
    """The chord to row k on the mean tangent, over the square of that."""
    squares = 0.0
    product = 0.0
    for j in range(scale.size):
        mean = 0.5 * (t[k - 1, j] + t[k, j])
        squares += mean * mean
        product += (z[k, j] / scale[j] - z[k - 1, j] / scale[j]) * mean
    return product / max(squares, TINY)


@inlined("f2, f1, i -> f")
def _length(t, scale, k):
    """Of row k of raw tangents."""
    total = 0.0
    for j in range(scale.size):
        one = t[k, j] / scale[j]
        total += one * one
    return math.sqrt(total)


@inlined("f2, f1, i, i -> f")
def _distance(z, scale, k, other):
    total = 0.0
    for j in range(scale.size):
        one = z[other, j] / scale[j] - z[k, j] / scale[j]
        total += one * one
    return math.sqrt(total)


@kernel("f2, f2, f1, f1, f, i, i -> b")
def may_none_be_of_two(z, t, scale, angle_periods, noise, start, sense):
    """True where no step on the way from row `start` to the last row (sense 1) or the first one (-1) is suspicious.

    t : raw tangents, in the sense of rising rows.
    """
    n = scale.size - 1
    count = z.shape[0] - start if sense > 0 else start + 1
    before = 0.0  # the length of the step before, and of the tangent where it began
    at_before = 0.0
    here = _length(t, scale, start)
    for i in range(count - 1):
        k = start + sense * i
        after = k + sense
        far = start + sense * min(i + NEXT, count - 1)
        there = _length(t, scale, after)
        h = _distance(z, scale, k, after)
        way = _distance(z, scale, k, far)
        goes_on = t[k, n] * t[after, n] > 0.0
        goes_far = t[k, n] * t[far, n] > 0.0
        for j in range(angle_periods.size):
            if angle_periods[j] != 0.0:
                continue
            a = z[k, j] / scale[j]
            step = z[after, j] / scale[j] - a
            if goes_on and abs(step) > NEARLY * noise:
                u = sense * (t[k, j] / scale[j]) / here
                v = sense * (t[after, j] / scale[j]) / there
                steep = max(abs(u), abs(v))
                if abs(step - 0.5 * h * (v + u)) > NEARLY * UNEXPLAINED * max(steep * h, abs(step)):
                    return False
                if i > 0:
                    w = sense * (t[k - sense, j] / scale[j]) / at_before
                    bend = (v - u) / (h if h > 0.0 else 1.0) - (u - w) / (before if before > 0.0 else 1.0)
                    if abs(bend) * h > NEARLY * STRAY * steep:
                        return False
            u = sense * (t[k, j] / scale[j])
            v = sense * (t[far, j] / scale[j])
            b = z[far, j] / scale[j]
            little = NEARLY * abs(b) < REMNANT * abs(a) and abs(a) > NEARLY * EPSILON
            flat = goes_far and NEARLY * abs(v) < REMNANT * abs(u) and way * abs(u) > NEARLY * noise
            if little or flat:
                left = max(abs(b - a - way * v), abs(b - a - 0.5 * way * (u + v)))
                if (little and left > NEARLY * UNEXPLAINED * abs(a)) or (
                    flat and left > NEARLY * UNEXPLAINED * way * abs(u)
                ):
                    return False
        before, at_before, here = h, here, there
    return True
