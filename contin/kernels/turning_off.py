"""Where a curve in two parameters turns off beside another one that a step has landed on.

As `contin.continuation.turning_off`, for compiled marches.
"""

import math

import numpy as np

from contin.kernels.algebraic import correct
from contin.kernels.compile import allocating
from contin.kernels.sides import side_of
from contin.kernels.steering import BISECTED, LEAST, ONE_POINT, SHIFT, leaves, set_out


@allocating(
    "i, i, i, f1, f1, f1, f, f, f, f1, f1, i, f1, f, f, f1, f2, f2, f2, i1, f1, f1, f1, f1, f1, f1 -> (f, f)"
)
def turning_off(
    address, kind, n, origin, tangent, old, h_previous, cos_max, side, z, p, active, scale, tolerance, trust, f,
    jacobian, matrix, block, pivots, step, y, below, above, lengths, v,
):  # fmt: skip
    """Where a step that ends at z, on the other side of the determinant, leaves its curve: bisected to `BISECTED`.

    side : see `side_of`, at the step's origin.  lengths : [0, of the step, the larger log at its ends]; becomes the
    longest one that ends on that side, the shortest one that does not, and by how much larger the log is at those two.
    v : of branch points, at the origin.
    Returns evaluations, and the scaled distance of the two; 0 where it is next to nothing.
    """
    sizes = np.zeros(2)
    right = np.empty(n)
    evaluations = 0.0
    lengths[0] = 0.0
    smallest = BISECTED * lengths[1]
    for j in range(z.size):
        below[j] = origin[j]
        above[j] = z[j]
    reference = lengths[2]
    log_below, log_above = reference, reference
    fraction = 0.5
    while lengths[1] - lengths[0] > smallest and fraction > LEAST:
        h = lengths[0] + fraction * (lengths[1] - lengths[0])
        set_out(origin, tangent, old, scale, h, h_previous, y, z)
        sign = correct(
            address, False, origin, tangent, h, y, z, p, active, scale, tolerance, trust, f, jacobian, matrix, block,
            pivots, step, sizes,
        )  # fmt: skip
        evaluations += sizes[1]
        length = 0.0
        for j in range(y.size):
            length += y[j] * y[j]
        if sign == 0 or sign == 2 or leaves(math.sqrt(length), h, cos_max, tolerance):
            fraction *= SHIFT
            continue
        fraction = 0.5
        there, here = side_of(kind, n, sign, matrix, jacobian, block, z, p, active, scale, v, right)
        if there == side:
            lengths[0] = h
            log_below = here
            for j in range(z.size):
                below[j] = z[j]
        else:
            lengths[1] = h
            log_above = here
            for j in range(z.size):
                above[j] = z[j]
    apart = 0.0
    for j in range(z.size):
        apart += ((above[j] - below[j]) / scale[j]) ** 2
    lengths[2] = max(log_below, log_above) - reference
    apart = math.sqrt(apart)
    return evaluations, apart if apart > ONE_POINT else 0.0
