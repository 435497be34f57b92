"""Where a curve of special orbits turns off beside another one that a step has landed on.

As `contin.continuation.turning_off`, for the compiled march.
"""

import math

from contin.kernels.collocation_steps import predict
from contin.kernels.compile import kernel
from contin.kernels.special_orbits.correct import correct_special
from contin.kernels.special_orbits.memory import LPC
from contin.kernels.special_orbits.predict import bring_in_phase
from contin.kernels.special_orbits.sides import relative
from contin.kernels.steering import BISECTED, LEAST, ONE_POINT, SHIFT


@kernel(
    "Equations, Curve, Points, Factors, Scratch, Borders, CurveMemory, f1, f1, f1, f, f, f, f, f, f1, f1, i, i, b -> f"
)
def turning_off(
    e, c, w, s, x, f, o, scale, sizes, weights, h, h_previous, cos_max, tolerance, side, info, lengths, n, nodes,
    autonomous,
):  # fmt: skip
    """Where the step of length h from o.z0 to o.zn leaves its curve: bisected to `BISECTED`.

    side : the determinant at o.z0.  lengths : [., its modulus at o.zn relative to that]; becomes the longest step that
    ends on that side, and its larger modulus there and at the shortest step that does not.
    Returns the scaled distance of the two ends; 0 where it is next to nothing, or the modulus has grown on the way to
    both: to a pole, also where no correction comes near it.
    """
    below, above, here, z = o.below, o.above, o.z0, o.zn
    size = scale.size
    for j in range(size):
        below[j] = 0.0
        above[j] = (z[j] - here[j]) / scale[j]
    end = lengths[1]
    low, high, at_low, at_high, fraction = 0.0, h, 1.0, end, 0.5
    while high - low > BISECTED * h and fraction > LEAST:
        length = low + fraction * (high - low)
        predict(here, o.t0, o.before, o.old, scale, length, h_previous, o.guess)
        if autonomous:
            bring_in_phase(o.guess, here, scale, weights, n, nodes, o.drift)
        info[3] = math.inf
        found = correct_special(e, c, w, s, x, f, o, scale, sizes, length, tolerance, True, info) >= 0
        info[2] += 1.0
        moved = 0.0
        if found:
            for j in range(size):
                moved += ((z[j] - here[j]) / scale[j]) ** 2
        if not found or math.sqrt(moved) * cos_max > length + 10.0 * tolerance:
            fraction *= SHIFT
            continue
        fraction = 0.5
        there = relative(c.kind, side, info[7], o)
        if there < 0.0:
            high, at_high = length, -there
            for j in range(size):
                above[j] = (z[j] - here[j]) / scale[j]
        else:
            low, at_low = length, there
            for j in range(size):
                below[j] = (z[j] - here[j]) / scale[j]
    lengths[0], lengths[1] = low, max(at_low, at_high)
    if c.kind != LPC and at_low >= 1.0 and at_high >= end and lengths[1] > max(1.0, end):
        return 0.0
    apart = 0.0
    for j in range(size):
        apart += (above[j] - below[j]) ** 2
    apart = math.sqrt(apart)
    return apart if apart > ONE_POINT else 0.0
