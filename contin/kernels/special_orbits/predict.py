"""Where in time the next orbit is sought, and whether the way there led through a point."""

import numpy as np

from contin.kernels.compile import vector_kernel

POINT = 1e-12  # of its states' sizes: an orbit that is as small is a point and rounding


@vector_kernel("f1, f1, f1, f1, i, i, f1")
def bring_in_phase(guess, here, scale, weights, n, nodes, drift):
    """Shift the orbit `guess` in time until it is in phase with `here`, to first order.

    weights : of differences between the neighbours of the inner nodes.  drift : memory.
    """
    first, beyond = np.uint64(n), np.uint64(nodes - n)
    step = np.uint64(n)
    size = 0.0
    shift = 0.0
    for j in range(first, beyond):
        d = (here[j + step] - here[j - step]) * weights[j - step] / scale[j]
        drift[j] = d * scale[j]
        size += d * d
        shift += d * (guess[j] - here[j]) / scale[j]
    if size > 0.0:
        for j in range(first, beyond):
            guess[j] -= shift / size * drift[j]


@vector_kernel("f1, f1, i, i, f1 -> b")
def turned_over(a, b, n, nodes, sizes):
    """True where the orbit between a and b has shrunk to a point: seen from its mean it lies on the other side.

    States are measured in their sizes (n,). A forced orbit may be a point all along the curve, where what is seen from
    its mean is rounding.
    """
    total = 0.0
    count = nodes // n
    for k in range(n):
        mean = 0.0
        other = 0.0
        for i in range(count):
            mean += a[i * n + k] / count
            other += b[i * n + k] / count
        for i in range(count):
            total += (a[i * n + k] - mean) / sizes[k] * ((b[i * n + k] - other) / sizes[k])
    return total < -POINT * POINT * nodes
