"""Smallest and largest values of piecewise polynomials, such as orbits on their mesh.

A polynomial of degree m rises above its values at the nodes by at most (L - 1)/2 of their range, L the Lebesgue
constant of the nodes (Trefethen, Approximation Theory and Approximation Practice, ch. 15): only intervals that can
hold the largest value are looked at, wherever its node stands, and of these only such are sampled whose control polygon
rises above all nodes. Above its samples a polynomial rises by far less (Markov's bound of its second derivative): few
intervals are searched further.
"""

from __future__ import annotations

from functools import cache
from math import comb
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels import extrema as kernel
from contin.kernels.collocation_basis import basis, interpolation, normalisation

SAMPLES: Final = 8  # parts of an interval, for each degree, at whose ends an extremum is looked for


def extrema(values: Array, m: int) -> tuple[Array, Array]:
    """Smallest and largest value over the orbit of each of k functions, (R, k) each.

    values : (R, N m + 1, k) at the nodes of orbits in rows, pieces of degree m. Error: rounding, where a piece has one
    extremum between neighbouring samples.
    """
    low, high = np.empty(values.shape[::2]), np.empty(values.shape[::2])
    kernel.extrema(_pieces(m), np.ascontiguousarray(values), low, high)
    return low, high


def may_hold_largest(pieces: Array) -> NDArray[np.bool_]:
    """(F, N): the pieces (F, N, m + 1) of F functions that can rise as high as the highest node."""
    highest = pieces.max(axis=2)
    above = _rise(pieces.shape[2] - 1) * (highest - pieces.min(axis=2))
    return np.asarray(highest + above >= highest.max(axis=1)[:, None])


def _pieces(m: int) -> kernel.Pieces:
    """What the kernel needs to know of pieces of degree m, with memory of its own."""
    tables = _control(m), _sampling(m), _places(m), _series(m), basis(m).nodes, normalisation(m)
    memory = np.empty((2, m + 1)), np.empty(len(_places(m)))
    return kernel.Pieces(m, _rise(m), _between_samples(m), 1.0 / (SAMPLES * m), *tables, *memory)


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
