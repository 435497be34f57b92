"""Smallest and largest values of piecewise polynomials, such as orbits on their mesh.

A polynomial of degree m rises above its values at the nodes by at most (L - 1)/2 of their range, L the Lebesgue
constant of the nodes (Trefethen, Approximation Theory and Approximation Practice, ch. 15): only intervals that can
hold the largest value are looked at, wherever its node stands, and of these only such are sampled whose control polygon
rises above all nodes. Above its samples a polynomial rises by far less (Markov's bound of its second derivative): few
intervals are searched further.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb
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
    flat = across.reshape(-1, across.shape[2])
    last = flat.shape[1] - m
    lowest, highest = flat[:, 0:last:m].copy(), flat[:, 0:last:m].copy()  # of each interval's nodes
    for j in range(1, m + 1):
        nodes = flat[:, j : last + j : m]
        np.minimum(lowest, nodes, out=lowest)
        np.maximum(highest, nodes, out=highest)
    above = _rise(m) * (highest - lowest)
    low, high = -_largest(flat, -lowest, above, m, -1.0), _largest(flat, highest, above, m, 1.0)
    return low.reshape(across.shape[:2]), high.reshape(across.shape[:2])


def may_hold_largest(pieces: Array) -> NDArray[np.bool_]:
    """(F, N): the pieces (F, N, m + 1) of F functions that can rise as high as the highest node."""
    highest = pieces.max(axis=2)
    above = _rise(pieces.shape[2] - 1) * (highest - pieces.min(axis=2))
    return np.asarray(highest + above >= highest.max(axis=1)[:, None])


def _largest(flat: Array, highest: Array, above: Array, m: int, sign: float) -> Array:
    """Largest value of sign * each function (F,) of flat (F, N m + 1).

    highest, above (F, N) : the highest node of each interval, and what the function may rise above it.
    """
    best: Array = highest.max(axis=1)
    rows, columns = np.divmod(np.flatnonzero(highest + above > best[:, None]), highest.shape[1])
    pieces = sign * flat.ravel().take((rows * flat.shape[1] + columns * m)[:, None] + np.arange(m + 1))
    polygons = (pieces @ _control(m)).T
    kept = np.flatnonzero(np.maximum.reduce([*polygons[1:-1]]) > best[rows])  # its ends are nodes
    rows, pieces = rows[kept], pieces[kept]
    samples = pieces @ _sampling(m)
    place = samples.argmax(axis=1)
    tops = samples[np.arange(len(rows)), place]
    np.maximum.at(best, rows, tops)
    searched = np.flatnonzero(tops + _between_samples(m) * (tops - samples.min(axis=1)) >= best[rows])
    np.maximum.at(best, rows[searched], _tops(pieces[searched], place[searched]))
    return best


def _tops(pieces: Array, place: NDArray[np.intp]) -> Array:
    """Values of polynomials (K, m + 1) at their tops beside the largest samples: by Newton's method on the slope."""
    m = pieces.shape[1] - 1
    series = np.einsum("kij,kj->ki", _series(m)[place], pieces).T  # Taylor's, about the largest sample
    slopes = [float(power) * series[power] for power in range(m, 0, -1)]
    bends = [float(power * (power - 1)) * series[power] for power in range(m, 1, -1)]
    middle, reach = _places(m)[place], 1.0 / (SAMPLES * m)
    low, high = np.maximum(-reach, -middle), np.minimum(reach, 1.0 - middle)
    s = np.zeros(len(pieces))
    for _ in range(STEPS):
        slope, bend = _horner(slopes, s), _horner(bends, s)
        s = np.clip(s - slope / np.where(bend < 0.0, bend, -np.abs(slope) / (0.5 * reach) - TINY), low, high)
    return np.asarray(np.einsum("kj,kj->k", interpolation(m, middle + s), pieces))


def _horner(coefficients: Sequence[Array], s: Array) -> Array:
    """A polynomial at s (K,), the coefficient of its highest power first."""
    total = coefficients[0]
    for coefficient in coefficients[1:]:
        total = total * s + coefficient
    return total


@cache
def _places(m: int) -> NDArray[np.float64]:
    """Samples of an interval."""
    return np.linspace(0.0, 1.0, SAMPLES * m + 1)


@cache
def _control(m: int) -> NDArray[np.float64]:
    """(m + 1, m + 1): coefficients in Bernstein's polynomials, between which all values lie, from values at nodes."""
    x = basis(m).nodes
    below, above = np.vander(x, m + 1, increasing=True), np.vander(1.0 - x, m + 1, increasing=True)[:, ::-1]
    return np.ascontiguousarray(np.linalg.inv(np.array([comb(m, j) for j in range(m + 1)]) * below * above).T)


@cache
def _sampling(m: int) -> NDArray[np.float64]:
    """(m + 1, samples): values there from those at the nodes."""
    return np.ascontiguousarray(interpolation(m, _places(m)).T)


@cache
def _between_samples(m: int) -> float:
    """How far a polynomial of degree m can rise above its samples, as a part of their range.

    At a top between samples 1/(8 m) apart it is at most max |p''| / (8 (8 m)^2) above the nearer one, and of a range R
    max |p''| <= 2 m^2 (m^2 - 1) R / 3 on an interval of length 1 (V. A. Markov).
    """
    part = (m * m - 1.0) / (12.0 * SAMPLES * SAMPLES)
    return part / (1.0 - 2.0 * part)  # R is that of the samples and what it rises above and falls below them


@cache
def _series(m: int) -> NDArray[np.float64]:
    """(K, m + 1, m + 1): Taylor's coefficients about each sample from the values at an interval's nodes."""
    nodes = basis(m).nodes
    powers = [np.linalg.inv(np.vander(nodes - at, increasing=True)) for at in _places(m)]
    return np.array(powers)


@cache
def _rise(m: int) -> float:
    """(L - 1)/2, L the Lebesgue constant of an interval's nodes (sum of |cardinal functions|) at its largest."""
    largest = float(np.abs(interpolation(m, np.linspace(0.0, 1.0, 40 * m + 1))).sum(axis=1).max())
    return 0.5 * (largest - 1.0)
