"""Trigonometric interpolation on an odd number M of equal nodes of the circle [0, 1)."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary

KEPT: Final = 8  # numbers of nodes whose waves are kept: a branch is refined a few times, and looked at between


def nodes(count: int) -> Array:
    """s_j = j/M."""
    return np.arange(count) / count


def _waves(count: int, places: Array) -> tuple[Array, Array]:
    """cos(2 pi k s) and sin(2 pi k s) at the places s, (K, (M - 1)/2)."""
    phases = 2.0 * np.pi * np.asarray(places)[:, None] * np.arange(1, count // 2 + 1)
    return elementary.cos(phases), elementary.sin(phases)


@lru_cache(KEPT)
def _at_nodes(count: int) -> tuple[Array, Array]:
    """The waves at the nodes themselves, for reading alone."""
    waves = _waves(count, nodes(count))
    for wave in waves:
        wave.flags.writeable = False
    return waves


@lru_cache(KEPT)
def slope(count: int) -> Array:
    """The matrix (M, M) from values at the nodes to slopes there, for reading alone."""
    matrix = shift(count, 0.0)[1]
    matrix.flags.writeable = False
    return matrix


def shift(count: int, turn: float) -> tuple[Array, Array]:
    """Matrices (M, M) from values at the nodes to values at s_j + turn, and to their derivatives by turn."""
    (cos, sin), (even, odd) = _waves(count, nodes(count) + turn), _at_nodes(count)
    orders = np.arange(1, count // 2 + 1)
    slopes = 4.0 * np.pi * ((cos * orders) @ odd.T - (sin * orders) @ even.T) / count
    return (1.0 + 2.0 * (cos @ even.T + sin @ odd.T)) / count, slopes


def at(count: int, places: Array) -> Array:
    """Matrix (K, M) from values at the nodes to values at the places."""
    (cos, sin), (even, odd) = _waves(count, places), _at_nodes(count)
    return np.asarray((1.0 + 2.0 * (cos @ even.T + sin @ odd.T)) / count)


def resampled(values: Array, count: int) -> Array:
    """The same curve at another number of nodes."""
    return np.asarray(at(len(values), nodes(count)) @ values)


def fitted(points: Array, turn: float, count: int) -> Array:
    """Values (M, n) at the nodes of the curve that passes best through points (K, n) at s = 0, turn, 2 turn, ..."""
    orders = np.arange(1, count // 2 + 1)
    phases = 2.0 * np.pi * turn * np.arange(len(points))[:, None] * orders
    basis = np.hstack([np.ones((len(points), 1)), elementary.cos(phases), elementary.sin(phases)])
    factors = np.linalg.lstsq(basis, points, rcond=None)[0]
    at = 2.0 * np.pi * nodes(count)[:, None] * orders
    return np.asarray(np.hstack([np.ones((count, 1)), elementary.cos(at), elementary.sin(at)]) @ factors)


def tail(values: Array) -> float:
    """The part of the highest third of the orders in the curve's deviation from its mean: what is not resolved."""
    spectrum = np.abs(np.fft.rfft(values - values.mean(axis=0), axis=0)) ** 2
    whole = float(spectrum.sum())
    return float(np.sqrt(spectrum[2 * len(spectrum) // 3 :].sum() / whole)) if whole > 0.0 else 0.0


def rotation(points: Array) -> float:
    """The rotation number of points (K, n) on a curve, about their centre in the plane in which they spread most.

    Das, Saiki, Sander and Yorke (2017): a mean of the turns with the weight exp(-1/(t (1 - t))) converges faster than
    any power of K.
    """
    centred = points - points.mean(axis=0)
    flat = centred @ np.linalg.svd(centred, full_matrices=False)[2][:2].T
    flat = flat - 0.5 * (flat.max(axis=0) + flat.min(axis=0))
    angles = np.unwrap(elementary.atan2(flat[:, 1], flat[:, 0]))
    t = (np.arange(len(angles) - 1) + 0.5) / (len(angles) - 1)
    weight = elementary.exp(-1.0 / (t * (1.0 - t)))
    return float(np.diff(angles) @ weight / weight.sum() / (2.0 * np.pi))
