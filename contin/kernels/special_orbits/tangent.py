"""Changes of z that the solutions of the bordered equations stand for, and the unit tangent made from them."""

import math

import numpy as np

from contin.kernels.compile import kernel, vector_kernel
from contin.kernels.special_orbits.memory import BPC, LPC, NS, PD


@vector_kernel("i, f1, f1, f2, f1, f2")
def changes(kind, across, along, y, scale, d):
    """d (4, N): the scaled changes of z that the rows of y stand for (row 3 of NS: of k alone)."""
    size = scale.size
    nu = y.shape[1] - 3
    for row in range(4):
        for j in range(np.uint64(nu + 1)):
            d[row, j] = y[row, j] / scale[j]
        for j in range(np.uint64(nu + 1), np.uint64(size)):
            d[row, j] = 0.0
        by_s = y[row, nu + 1]
        by_r = 1.0 if row == 1 else 0.0
        d[row, size - 1] = (across[0] * by_s + along[0] * by_r) / scale[size - 1]
        d[row, size - 2] = (across[1] * by_s + along[1] * by_r) / scale[size - 2]
        if kind == BPC:
            d[row, size - 3] = y[row, nu + 2] / scale[size - 3]
    if kind == NS:
        for j in range(np.uint64(size)):
            d[3, j] = 0.0
        d[3, size - 3] = 1.0 / scale[size - 3]


@vector_kernel("f2, i, f1 -> f")
def product(d, row, direction):
    """<d[row], direction>"""
    total = 0.0
    for j in range(np.uint64(direction.size)):
        total += d[row, j] * direction[j]
    return total


@vector_kernel("f2, f, f1, i, f1 -> f")
def combined(d, first, weights, count, out):
    """out = first * d[0] + sum of weights[row] d[row + 1]; returns its length."""
    for j in range(np.uint64(out.size)):
        out[j] = first * d[0, j]
    for row in range(count):
        x = weights[row]
        for j in range(np.uint64(out.size)):
            out[j] += x * d[row + 1, j]
    total = 0.0
    for j in range(np.uint64(out.size)):
        total += out[j] * out[j]
    return math.sqrt(total)


@kernel("i, f2, f2, f1, f1, f1 -> f")
def tangent_of(kind, dG, d, weights, guide, out_t):
    """Unit tangent of the curve into out_t, along `guide`.

    Returns the determinant of [dG; tangent] in the coordinates d, 0 where no tangent is defined. Its sign changes where
    another curve crosses, and not where G has a pole: there dG goes through infinity twice.
    """
    count = 3
    if kind in (LPC, PD):
        count = 2
        weights[0] = -dG[0, 2]
        weights[1] = dG[0, 1]
    else:
        weights[0] = dG[0, 2] * dG[1, 3] - dG[0, 3] * dG[1, 2]
        weights[1] = dG[0, 3] * dG[1, 1] - dG[0, 1] * dG[1, 3]
        weights[2] = dG[0, 1] * dG[1, 2] - dG[0, 2] * dG[1, 1]
    norm = combined(d, 0.0, weights, count, out_t)
    if not 0.0 < norm < math.inf:
        return 0.0
    along = 0.0
    for j in range(out_t.size):
        along += out_t[j] * guide[j]
    if along < 0.0:
        norm = -norm
    for j in range(out_t.size):
        out_t[j] /= norm
    return norm
