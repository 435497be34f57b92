"""Trigonometric interpolation on an odd number M of equal nodes of the circle [0, 1)."""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.machine import elementary


def nodes(count: int) -> Array:
    """s_j = j/M."""
    return np.arange(count) / count


def shift(count: int, turn: float) -> tuple[Array, Array]:
    """Matrices (M, M) from values at the nodes to values at s_j + turn, and to their derivatives by turn."""
    orders = np.arange(1, count // 2 + 1)
    apart = 2.0 * np.pi * (nodes(count)[:, None] + turn - nodes(count)[None, :])
    phases = apart[:, :, None] * orders
    values = (1.0 + 2.0 * elementary.cos(phases).sum(axis=2)) / count
    slopes = -4.0 * np.pi * (orders * elementary.sin(phases)).sum(axis=2) / count
    return values, slopes


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
