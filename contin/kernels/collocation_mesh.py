"""Error of a collocation solution, from the jumps of its top derivative between intervals."""

import math

from contin.kernels.compile import inlined, kernel


@inlined("f, i -> f")
def _power(x, exponent):
    """x^exponent, exponent > 0; one that is not known beforehand takes a function call."""
    y = x
    for _ in range(1, exponent):
        y *= x
    return y


@kernel("f1, i, i, i, b, f1, f, f1, f1 -> f")
def mesh_error(z, n, m, intervals, closed, top, constant, sizes, density):
    """Estimated largest error inside an interval, relative to `sizes` (n,); density (N,) receives |u^(m + 1)|.

    The m-th derivative is constant on an interval; its differences between neighbours give u^(m + 1). The error at the
    mesh points themselves (and of T and p) is of order 2 m, much smaller.

    closed : the last interval's neighbour is the first one (of periodic solutions); else both ends have one neighbour.
    """
    nodes = (intervals * m + 1) * n
    for i in range(intervals):
        density[i] = 0.0
    for k in range(n):
        previous = 0.0
        for j in range(m + 1):
            previous += top[j] * z[((intervals - 1) * m + j) * n + k]
        h_previous = z[nodes + intervals]
        previous /= _power(h_previous, m)
        for i in range(intervals):
            h = z[nodes + 1 + i]
            here = 0.0
            for j in range(m + 1):
                here += top[j] * z[(i * m + j) * n + k]
            here /= _power(h, m)
            jump = 2.0 * abs(here - previous) / ((h + h_previous) * sizes[k])
            if i > 0 or closed:
                before = i - 1 if i > 0 else intervals - 1
                density[before] = max(density[before], jump)
                density[i] = max(density[i], jump)
            previous = here
            h_previous = h
    largest = 0.0
    for i in range(intervals):
        largest = max(largest, constant * _power(z[nodes + 1 + i], m + 1) * density[i])
    return largest if math.isfinite(largest) else math.inf


@kernel("f1, i, i, f, f1 -> f")
def evened(z, n, m, constant, density):
    """The error that as many intervals leave where each has the same; density (N,) as `mesh_error` gave it."""
    intervals = density.size
    first = (intervals * m + 1) * n + 1
    total = 0.0
    for i in range(intervals):
        total += z[first + i] * density[i] ** (1.0 / (m + 1))
    return constant * (total / intervals) ** (m + 1)
