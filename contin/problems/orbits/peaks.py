"""Smallest and largest values of piecewise polynomials, such as orbits on their mesh.

A polynomial of degree m rises above its values at the nodes by at most (L - 1)/2 of their range, L the Lebesgue
constant of the nodes (Trefethen, Approximation Theory and Approximation Practice, ch. 15): only intervals that can
hold the largest value are searched, wherever its node stands.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation_basis import basis, interpolation

SAMPLES: Final = 8  # parts of an interval, for each degree, at whose ends an extremum is looked for
TINY: Final = np.finfo(float).tiny
STEPS: Final = 4  # of Newton's method from the largest sample


def extrema(values: Array, m: int) -> tuple[Array, Array]:
    """Smallest and largest value over the orbit of each of k functions, (R, k) each.

    values : (R, N m + 1, k) at the nodes of orbits in rows, pieces of degree m. Error: rounding, where a piece has one
    extremum between neighbouring samples.
    """
    across = np.ascontiguousarray(values.transpose(0, 2, 1))  # of one function after the other
    count = (across.shape[2] - 1) // m
    flat = across.reshape(-1, across.shape[2])
    pieces = flat[:, (np.arange(count) * m)[:, None] + np.arange(m + 1)]  # (R k, N, m + 1)
    low, high = -_largest(-pieces), _largest(pieces)
    return low.reshape(across.shape[:2]), high.reshape(across.shape[:2])


def may_hold_largest(pieces: Array) -> NDArray[np.bool_]:
    """(F, N): the pieces (F, N, m + 1) of F functions that can rise as high as the highest node."""
    highest = pieces.max(axis=2)
    above = 0.5 * (_lebesgue(pieces.shape[2] - 1) - 1.0) * (highest - pieces.min(axis=2))
    return np.asarray(highest + above >= highest.max(axis=1)[:, None])


def _largest(pieces: Array) -> Array:
    """Largest value of each function (F,) of pieces (F, N, m + 1)."""
    best: Array = pieces.max(axis=(1, 2))
    rows, columns = np.nonzero(may_hold_largest(pieces))
    np.maximum.at(best, rows, _tops(pieces[rows, columns]))
    return best


def _tops(pieces: Array) -> Array:
    """Largest values of polynomials (K, m + 1) on their intervals: by samples, then Newton's method on the slope."""
    m = pieces.shape[1] - 1
    samples = pieces @ interpolation(m, _places(m)).T
    place = samples.argmax(axis=1)
    series = np.einsum("kij,kj->ki", _series(m)[place], pieces)  # Taylor's, about the largest sample
    middle, reach = _places(m)[place], 1.0 / (SAMPLES * m)
    low, high = np.maximum(-reach, -middle), np.minimum(reach, 1.0 - middle)
    s = np.zeros(len(pieces))
    for _ in range(STEPS):
        slope, bend = _derivative(series, s, 1), _derivative(series, s, 2)
        s = np.clip(s - slope / np.where(bend < 0.0, bend, -np.abs(slope) / (0.5 * reach) - TINY), low, high)
    values = np.einsum("kj,kj->k", interpolation(m, middle + s), pieces)
    return np.asarray(np.maximum(values, samples.max(axis=1)))


def _derivative(series: Array, s: Array, order: int) -> Array:
    """Derivative of that order of polynomials with coefficients `series` (K, m + 1) at s (K,), by Horner's rule."""
    total = np.zeros(len(s))
    for power in range(series.shape[1] - 1, order - 1, -1):
        factor = 1.0
        for k in range(order):
            factor *= power - k
        total = total * s + factor * series[:, power]
    return total


@cache
def _places(m: int) -> NDArray[np.float64]:
    """Samples of an interval."""
    return np.linspace(0.0, 1.0, SAMPLES * m + 1)


@cache
def _series(m: int) -> NDArray[np.float64]:
    """(K, m + 1, m + 1): Taylor's coefficients about each sample from the values at an interval's nodes."""
    nodes = basis(m).nodes
    powers = [np.linalg.inv(np.vander(nodes - at, increasing=True)) for at in _places(m)]
    return np.array(powers)


@cache
def _lebesgue(m: int) -> float:
    """Lebesgue constant of the nodes of an interval, (sum of |cardinal functions|) at its largest."""
    return float(np.abs(interpolation(m, np.linspace(0.0, 1.0, 40 * m + 1))).sum(axis=1).max())
