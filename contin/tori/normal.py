"""Lyapunov exponents of a torus across itself, from the derivatives of phi along an orbit of the rotation s -> s + rho.

A(s) = N(s + rho)' Dphi(u(s)) N(s), with orthonormal N(s) across the circle (and across the flow, where T is free), is
multiplied along the orbit, orthonormalised as it goes; the logarithms' weighted means (Das, Saiki, Sander and Yorke,
2017) converge fast where the motion is quasiperiodic.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.tori import fourier
from contin.tori.equations import Circle, Metric
from contin.tori.strobe import Strobe

LENGTH: Final = 1000  # of the orbit at least, in returns
TURNS: Final = 8.0  # of it round the circle, of a motion that nearly closes after up to `CLOSING` returns
CLOSING: Final = 6
LONGEST: Final = 20_000


def exponents(strobe: Strobe, metric: Metric, circle: Circle, jacobians: Array) -> Array:
    """(n - 1,), (n - 2,) where T is free: a return multiplies disturbances by exp of them; the greatest first."""
    n, count = strobe.n, circle.count
    across = n - 1 - strobe.free_time
    if across < 1:
        return np.empty(0)
    length = _length(circle.rho)
    places = np.asarray((circle.rho * np.arange(length + 1)) % 1.0, dtype=float)
    between = fourier.at(count, places)
    scaled = jacobians * metric.sizes[None, None, :] / metric.sizes[None, :, None]
    matrices = np.tensordot(between[:-1], scaled, axes=1)
    slopes = fourier.slope(count) @ circle.values
    along = [between @ (slopes / metric.sizes)]
    if strobe.free_time:
        speeds = np.array([strobe.speed(u, circle.value) for u in circle.values])
        along.append(between @ (speeds / metric.sizes))
    bases = np.linalg.qr(np.stack(along, axis=2), mode="complete")[0][:, :, len(along) :]
    cocycle = np.transpose(bases[1:], (0, 2, 1)) @ matrices @ bases[:-1]
    logs = elementary.log(np.maximum(_stretched(cocycle), np.finfo(float).tiny))
    t = (np.arange(length) + 0.5) / length
    weight = elementary.exp(-1.0 / (t * (1.0 - t)))
    return np.sort(weight @ logs / weight.sum())[::-1]


def _stretched(cocycle: Array) -> Array:
    """(length, across) factors by which each return stretches the orthonormal vectors that the ones before it left."""
    across = cocycle.shape[1]
    if across == 1:
        return np.abs(cocycle[:, 0])
    factors, frame = np.empty(cocycle.shape[:2]), np.eye(across)
    for k, matrix in enumerate(cocycle):
        frame, triangle = np.linalg.qr(matrix @ frame)
        factors[k] = np.abs(np.diag(triangle))
    return factors


def _length(rho: float) -> int:
    """Returns after which every part of the circle has been visited."""
    slowest = min(abs(q * rho - round(q * rho)) for q in range(1, CLOSING + 1))
    return int(np.clip(TURNS / max(slowest, TURNS / LONGEST), LENGTH, LONGEST))
