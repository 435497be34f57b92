"""Smallest and largest values of piecewise polynomials, as `contin.problems.orbits.mesh.peaks` says, row by row.

Only intervals that can rise above what has been found are looked at, of these only such are sampled whose control
polygon rises above it, and only samples that leave room are followed by Newton's method on the slope.
"""

import math
from collections import namedtuple

import numpy as np

from contin.kernels.compile import kernel, vector_kernel
from contin.kernels.signature import structure

STEPS = 4  # of Newton's method from the largest sample
TINY = 2.3e-308

Pieces = namedtuple(
    "Pieces",
    [
        "m",  # degree
        "rise",  # a piece rises above its nodes by at most this part of their range
        "between",  # ... and above its samples by this part of theirs
        "reach",  # distance of neighbouring samples
        "control",  # (m + 1, m + 1): Bernstein coefficients from the values at the nodes
        "sampling",  # (m + 1, S): values at the samples
        "places",  # (S,) samples
        "series",  # (S, m + 1, m + 1): Taylor's coefficients about each
        "nodes",  # (m + 1,)
        "normalisation",  # (m + 1,) of the cardinal functions
        "memory",  # (2, m + 1)
        "samples",  # (S,) memory
    ],
)
structure(Pieces, "i, f, f, f, f2, f2, f1, f3, f1, f1, f2, f1")


@kernel("Pieces, f3, f2, f2")
def extrema(e, values, low, high):
    """low, high (R, k): of each of k functions over each of R rows, from values (R, N m + 1, k) at the nodes.

    NaN where a value is.
    """
    rows, count, functions = values.shape
    m, piece = e.m, e.memory
    for r in range(rows):
        for q in range(functions):
            bottom = values[r, 0, q]
            top = bottom
            whole = bottom == bottom
            for i in range(1, count):
                x = values[r, i, q]
                whole &= x == x
                bottom = min(bottom, x)
                top = max(top, x)
            for first in range(0, count - m, m):
                lowest = values[r, first, q]
                highest = lowest
                for i in range(1, m + 1):
                    x = values[r, first + i, q]
                    lowest = min(lowest, x)
                    highest = max(highest, x)
                above = e.rise * (highest - lowest)
                if highest + above > top:
                    for i in range(m + 1):
                        piece[0, i] = values[r, first + i, q]
                    top = _largest(e, piece, top)
                if lowest - above < bottom:
                    for i in range(m + 1):
                        piece[0, i] = -values[r, first + i, q]
                    bottom = -_largest(e, piece, -bottom)
            low[r, q] = bottom if whole else math.nan
            high[r, q] = top if whole else math.nan


@kernel("Pieces, f2, f -> f")
def _largest(e, piece, best):
    """`best`, or what the piece rises to above it."""
    if not _polygon(e, piece) > best:
        return best
    samples = e.samples
    _sample(piece, e.sampling, samples)
    place = 0
    highest = samples[0]
    lowest = highest
    for s in range(1, samples.size):
        x = samples[s]
        if x > highest:
            highest = x
            place = s
        lowest = min(lowest, x)
    best = max(best, highest)
    return max(best, _top(e, piece, place)) if highest + e.between * (highest - lowest) >= best else best


@vector_kernel("f2, f2, f1")
def _sample(piece, sampling, samples):
    """Values of a piece at the samples."""
    count = np.uint64(samples.size)
    for s in range(count):
        samples[s] = piece[0, 0] * sampling[0, s]
    for i in range(1, sampling.shape[0]):
        x = piece[0, i]
        for s in range(count):
            samples[s] += x * sampling[i, s]


@kernel("Pieces, f2 -> f")
def _polygon(e, piece):
    """The highest inner corner of the control polygon (its ends are nodes)."""
    m, control = e.m, e.control
    highest = -math.inf
    for c in range(1, m):
        x = 0.0
        for i in range(m + 1):
            x += piece[0, i] * control[i, c]
        highest = max(highest, x)
    return highest


@kernel("Pieces, f2, i -> f")
def _top(e, piece, place):
    """The value at the top beside a sample, by Newton's method on the slope."""
    m, series, nodes, normalisation = e.m, e.series, e.nodes, e.normalisation
    for power in range(m + 1):
        x = 0.0
        for i in range(m + 1):
            x += series[place, power, i] * piece[0, i]
        piece[1, power] = x
    middle = e.places[place]
    low, high = max(-e.reach, -middle), min(e.reach, 1.0 - middle)
    s = 0.0
    for _ in range(STEPS):
        slope = 0.0
        bend = 0.0
        for power in range(m, 0, -1):
            bend = bend * s + slope
            slope = slope * s + power * piece[1, power]
        steepest = bend if bend < 0.0 else -abs(slope) / (0.5 * e.reach) - TINY
        s = min(max(s - slope / steepest, low), high)
    at = middle + s
    total = 0.0
    for j in range(m + 1):
        x = normalisation[j]
        for k in range(m + 1):
            if k != j:
                x *= at - nodes[k]
        total += x * piece[0, j]
    return total
