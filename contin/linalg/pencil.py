"""Eigenvalues of M u' = A u: the finite ones of the pencil A - l M, where M may be singular.

Infinite eigenvalues are zeros of M A^-1. On the range of M that matrix has as many zeros less as M has (of index 1 none
is left, of index 2 no Jordan block), so that Arnoldi's method works there. Its vectors w = M v are taken back by
v = A^-1 w, which holds no part of infinite eigenvalues but rounding (Meerbergen and Spence, SIAM J. Matrix Anal. Appl.
18 (1997) 1023, on such purification).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Vector
from contin.linalg.eigen import Inverse, Spectrum
from contin.linalg.linear import Linear
from contin.linalg.vectors import norm

GENUINE: Final = 1e-3  # relative residual of an eigenpair beyond which it is rounding of an infinite eigenvalue


@dataclass(frozen=True, eq=False)
class OnRange:
    """M A^-1 in the place of A^-1, for vectors w = M v."""

    linear: Linear

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        return self.linear.weigh(self.linear.solve(right, tolerance))

    def weigh(self, x: Vector) -> Vector:
        return self.linear.weigh(x)

    def magnitude(self, x: Vector) -> Vector:
        """|A| x in units of the masses; 0 of equations without."""
        weights = np.asarray(abs(self.linear.mass).sum(axis=1)).ravel()
        size = self.linear.magnitude(x)
        return np.asarray(np.divide(size, weights, out=np.zeros_like(size), where=weights > 0.0))

    def back(self, found: Spectrum) -> Spectrum:
        """The eigenpairs with vectors v = A^-1 w, without those that are none: rounding errors of zeros of M A^-1."""
        kept, vectors = [], []
        for k, value in enumerate(found.values):
            w = found.vectors[:, k]
            v = self.linear.solve(w.real) + (1j * self.linear.solve(w.imag) if value.imag != 0.0 else 0.0)
            moved = self.linear.weigh(v)
            if 0.0 < norm(moved) < np.inf and norm(moved - w / value) <= GENUINE * norm(moved):
                kept.append(k)
                vectors.append(v / norm(v))
        columns = np.array(vectors, dtype=complex).reshape(len(kept), len(found.vectors)).T
        return replace(found, values=found.values[kept], vectors=columns)


def inverse_of(linear: Linear) -> Inverse:
    """What stands in the place of A^-1 where eigenvalues are sought: that itself without a mass matrix."""
    return linear if linear.mass is None else OnRange(linear)
