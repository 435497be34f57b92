"""Where a curve in two parameters turns off beside another one that a step has landed on.

As `contin.continuation.turning_off`, for compiled marches.
"""

import math

import numpy as np

from contin.kernels.algebraic import correct, diagonal_sign
from contin.kernels.compile import allocating
from contin.kernels.steering import BISECTED, leaves, set_out


@allocating(
    "i, f1, f1, f1, f, f, f, f1, f1, i, f1, f, f, f1, f2, f2, f2, i1, f1, f1, f1, f1, f1 -> (f, f)"
)
def turning_off(
    address, origin, tangent, old, h_previous, cos_max, side, z, p, active, scale, tolerance, trust, f, jacobian,
    matrix, block, pivots, step, y, below, above, lengths,
):  # fmt: skip
    """Where a step that ends at z, on the other side of the determinant, leaves its curve: bisected to `BISECTED`.

    side : of the determinant at the step's origin.  lengths : [0, of the step]; becomes the longest one that ends on
    that side, and the shortest one that does not.
    Returns evaluations, and the scaled distance of the two ends: next to nothing where the curves cross.
    """
    sizes = np.zeros(2)
    evaluations = 0.0
    lengths[0] = 0.0
    smallest = BISECTED * lengths[1]
    for j in range(z.size):
        below[j] = origin[j]
        above[j] = z[j]
    fraction = 0.5
    while lengths[1] - lengths[0] > smallest and fraction > 0.1:
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
            fraction *= 0.7
            continue
        fraction = 0.5
        if sign * diagonal_sign(matrix) == side:
            lengths[0] = h
            for j in range(z.size):
                below[j] = z[j]
        else:
            lengths[1] = h
            for j in range(z.size):
                above[j] = z[j]
    apart = 0.0
    for j in range(z.size):
        apart += ((above[j] - below[j]) / scale[j]) ** 2
    return evaluations, math.sqrt(apart)
