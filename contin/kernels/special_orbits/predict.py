"""Where the next point of a curve of orbits is sought, and whether the way there led through a point."""

import math

import numpy as np

from contin.kernels.compile import vector_kernel


@vector_kernel
def predict(here, tangent, before, old, scale, h, h_previous, guess):
    """guess: the point at distance h along the tangent at `here`, on the cubic through the last two points with their
    tangents; on the tangent where h_previous is 0. Shifted along the tangent into the plane at distance h.
    """
    size = np.uint64(here.size)
    if h_previous == 0.0:
        for j in range(size):
            guess[j] = here[j] + scale[j] * (h * tangent[j])
        return
    chord = 0.0
    for j in range(size):
        d = (here[j] - before[j]) / scale[j]
        guess[j] = d
        chord += d * d
    reach = math.sqrt(chord)
    t = h / reach
    ahead = 0.0
    for j in range(size):
        bend = reach * (2.0 * tangent[j] + old[j]) - 3.0 * guess[j]
        twist = reach * (tangent[j] + old[j]) - 2.0 * guess[j]
        guess[j] = h * tangent[j] + t * t * (bend + t * twist)
        ahead += guess[j] * tangent[j]
    for j in range(size):
        guess[j] = here[j] + scale[j] * (guess[j] + (h - ahead) * tangent[j])


@vector_kernel
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


@vector_kernel
def turned_over(a, b, n, nodes):
    """True where the orbit between a and b has shrunk to a point: seen from its mean it lies on the other side."""
    total = 0.0
    for j in range(np.uint64(nodes)):
        total += a[j] * b[j]
    count = nodes // n
    for k in range(n):
        mean = 0.0
        other = 0.0
        for i in range(count):
            mean += a[i * n + k]
            other += b[i * n + k]
        total -= mean * other / count
    return total < 0.0
