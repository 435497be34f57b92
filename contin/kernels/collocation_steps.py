"""Steps along families and curves of orbits: prediction, and lengths in the metric z / scale.

A step has u at the nodes, T and p, one after another; in z the lengths of the mesh intervals stand between T and p.
They do not move, and tangents are zero there. nodes : number of values of u.
"""

import math

import numpy as np

from contin.kernels.compile import vector_kernel


@vector_kernel("f1, f1, f1, f1, f1, f, f, f1")
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


@vector_kernel("f1, f1, f1, f1 -> f")
def along(tangent, z, z0, scale):
    """<tangent, (z - z0) / scale>"""
    total = 0.0
    for j in range(np.uint64(z.size)):
        total += tangent[j] * (z[j] - z0[j]) / scale[j]
    return total


@vector_kernel("f1, f1 -> f")
def product(a, b):
    """<a, b>"""
    total = 0.0
    for j in range(np.uint64(a.size)):
        total += a[j] * b[j]
    return total


@vector_kernel("f1, f1, f1 -> f")
def distance(z, z0, scale):
    """|(z - z0) / scale|"""
    total = 0.0
    for j in range(np.uint64(z.size)):
        d = (z[j] - z0[j]) / scale[j]
        total += d * d
    return math.sqrt(total)


@vector_kernel("f1, f1, i -> f")
def length(step, scale, nodes):
    """Length of a step."""
    last = step[nodes + 1] / scale[scale.size - 1]
    total = last * last
    for j in range(np.uint64(nodes + 1)):
        d = step[j] / scale[j]
        total += d * d
    return math.sqrt(total)


@vector_kernel("f1, f1, f1, i -> f")
def advance(z, step, scale, nodes):
    """z += step; returns its length."""
    for j in range(np.uint64(nodes + 1)):
        z[j] += step[j]
    z[z.size - 1] += step[nodes + 1]
    return length(step, scale, nodes)


@vector_kernel("f1, f1, i, f1")
def direct(step, scale, nodes, out):
    """out (like z): the unit vector (scaled) along a step."""
    factor = 1.0 / length(step, scale, nodes)
    last = out.size - 1
    for j in range(np.uint64(nodes + 1)):
        out[j] = factor * step[j] / scale[j]
    for j in range(np.uint64(nodes + 1), np.uint64(last)):
        out[j] = 0.0
    out[last] = factor * step[nodes + 1] / scale[last]
