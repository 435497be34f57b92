"""The circle without size at a Neimark-Sacker point, and the direction in which it opens.

With Dphi q = exp(i theta) q the circle u0 + a Re(q exp(2 pi i s)) turns by rho = theta/(2 pi), up to a^2.
"""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.machine import elementary
from contin.tori import fourier
from contin.tori.equations import Circle, Metric
from contin.tori.strobe import Strobe


def born(strobe: Strobe, metric: Metric, u: Array, time: float, value: float, count: int) -> tuple[Circle, Array]:
    """The circle of `count` equal nodes at u, and the unit tangent of its family; raises NoSolutionError."""
    _, matrix, _, _ = strobe.derivatives(u, time, value)
    values, vectors = np.linalg.eig(matrix)
    angles = elementary.atan2(values.imag, values.real)
    moduli = np.abs(values)
    far = np.where(angles > 0.0, np.abs(moduli - 1.0), np.inf)
    if not np.isfinite(far).any():
        raise NoSolutionError("the solution there has no complex multipliers")
    k = int(np.argmin(far))
    q, rho = vectors[:, k], float(angles[k]) / (2.0 * np.pi)
    phases = 2.0 * np.pi * fourier.nodes(count)[:, None]
    ring = q.real * elementary.cos(phases) - q.imag * elementary.sin(phases)
    along = np.append((ring / metric.sizes).ravel(), 0.0)
    return Circle(np.tile(u, (count, 1)), rho, time, value), along / np.linalg.norm(along)
