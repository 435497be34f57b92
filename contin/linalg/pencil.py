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

NEARER: Final = 0.03  # part of an eigenvalue's modulus below which another one is much nearer to zero
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
        """The eigenpairs with vectors v = A^-1 w, without those that are none: rounding errors of zeros of M A^-1.

        Next to a singular A every v has a part along the vector of the eigenvalue that is nearly zero, as large as the
        errors of w divided by that eigenvalue; it is taken out.
        """
        kept: list[int] = []
        pairs: list[tuple[float, Vector, Vector]] = []  # |l|, v, M v with |M v| = 1
        for k, value in enumerate(found.values):
            w = found.vectors[:, k]
            v = self.linear.solve(w.real) + (1j * self.linear.solve(w.imag) if value.imag != 0.0 else 0.0)
            moved, wanted = self.linear.weigh(v), w / value
            if not _agree(moved, wanted):
                for size, other, weighed in pairs:
                    if size < NEARER * abs(value):
                        part = np.vdot(weighed, moved)
                        v, moved = v - part * other, moved - part * weighed
                        wanted = wanted - np.vdot(weighed, wanted) * weighed
                if not _agree(moved, wanted):
                    continue
            kept.append(k)
            pairs.append((abs(value), v / norm(moved), moved / norm(moved)))
        columns = np.array([v / norm(v) for _, v, _ in pairs], dtype=complex).reshape(len(kept), len(found.vectors)).T
        return replace(found, values=found.values[kept], vectors=columns)


def _agree(moved: Vector, wanted: Vector) -> bool:
    return bool(0.0 < norm(moved) < np.inf and norm(moved - wanted) <= GENUINE * norm(moved))


def inverse_of(linear: Linear) -> Inverse:
    """The operator whose largest eigenvalues are sought: A^-1 itself where there is no mass matrix."""
    return linear if linear.mass is None else OnRange(linear)
