"""The vector of a curve of Hopf points where it goes on as neutral saddles, eigenvalues +-lambda.

(f_u^2 + kappa) v = 0 has all vectors v of a plane, one of which a border chooses; w = f_u v. Beyond a Bogdanov-Takens
point this plane holds the eigenvectors of +-lambda. Were v that of -lambda, the left one of +lambda would see no change
p^T (f_u' f_u + f_u f_u') v = (-lambda + lambda) p^T f_u' v: the system is singular although the curve is smooth. As the
plane turns and lambda grows along the curve, a v that a border holds comes to one of them. The farthest from both have
w normal to v.
"""

from __future__ import annotations

import numpy as np

from contin.abi import Array
from contin.kernels.sides import ALIGNED
from contin.loci.equilibria.extended import ExtendedCurve, critical_plane
from contin.machine import elementary


def across(curve: ExtendedCurve, z: Array) -> Array:
    """z; of a neutral saddle whose v is near an eigenvector, with the v of its plane that w is normal to."""
    if curve.type != "HB" or not curve.scalar(z) < 0.0:
        return z
    v, w = curve.vector(z) / curve.sizes, z[2 * curve.n : 3 * curve.n] / curve.sizes
    product = elementary.square(float(v @ w)) / (float(v @ v) * float(w @ w))
    if not product > 1.0 - elementary.square(ALIGNED):
        return z
    scaled = curve.matrix(z) * curve.sizes / curve.sizes[:, None]
    plane = critical_plane(curve.squared(scaled, curve.scalar(z)))
    inside = plane.T @ scaled @ plane
    axes = np.linalg.eigh(0.5 * (inside + inside.T))[1]  # of a form with trace 0: it vanishes between its axes
    normal = [plane @ (axes[:, 0] + side * axes[:, 1]) for side in (1.0, -1.0)]
    best = max(normal, key=lambda u: float(np.linalg.norm(scaled @ u)))  # at BT one has none
    best = best * np.copysign(1.0 / np.linalg.norm(best), float(best @ v))
    return curve.with_vector(z, scaled, best)
