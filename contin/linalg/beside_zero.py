"""Eigenvalues nearest to zero, those of an operator that is singular to rounding from beside zero.

A solution with such an operator is a multiple of the null vector and rounding errors of that multiple's size: what
Arnoldi's method makes of its inverse are the null vector and noise. A shift by a part of the operator's size that lies
in the middle between one and rounding, on a scale of powers, keeps both small.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array, Vector
from contin.linalg.copies import EPSILON, rounding_of, with_copies
from contin.linalg.eigen import Inverse, Spectrum, leading
from contin.linalg.followed import improved
from contin.linalg.linear import DirectLinear, KrylovLinear, Linear
from contin.linalg.pencil import OnRange, inverse_of

SHIFT: Final = 0.6  # of a null vector's operator: rounding to this power, as a part of its size
TELLS: Final = 1e-2  # part of the shift below which an eigenvalue's inverse drowns the others'


@dataclass(frozen=True, eq=False)
class Nearest:
    """Eigenvalues l - shift of A, and what their Krylov spaces were made of."""

    inverse: Inverse
    found: Spectrum
    shift: float

    def with_copies(self, n: int, reach: float) -> Nearest:
        """With all further ones of modulus up to `reach`; 0: as they are."""
        if not reach > 0.0:
            return self
        return replace(self, found=with_copies(self.inverse, n, self.found, reach + self.shift))

    def spectrum(self) -> Spectrum:
        """Of A itself, nearest to zero first."""
        found = self.inverse.back(self.found) if isinstance(self.inverse, OnRange) else self.found
        if self.shift == 0.0:
            return found
        values = found.values + self.shift
        order = np.argsort(np.abs(values), kind="stable")
        return replace(found, values=values[order], vectors=found.vectors[:, order])


@dataclass(frozen=True, eq=False)
class OneApplication:
    """An approximate inverse as if it were exact."""

    linear: KrylovLinear

    def solve(self, right: Vector, tolerance: float = 0.0) -> Vector:
        return self.linear.precondition(right)

    def weigh(self, x: Vector) -> Vector:
        return x

    def magnitude(self, x: Vector) -> Vector:
        return self.linear.magnitude(x)

    def columns(self, right: Array) -> Array:
        """Of columns (n, k)."""
        if self.linear.precise is not None:
            return self.linear.precise.solve(right)
        return np.column_stack([self.linear.precondition(r) for r in right.T])


def beside_zero(linear: Linear, start: Array, radius: float, known: float, fewest: int) -> Nearest:
    """As `leading`; where an eigenvalue is zero to rounding, and A has factors, with a shift and factors for it."""
    n = len(start)
    inverse = inverse_of(linear)
    found = leading(inverse, n, start, radius, known, fewest)
    if not _has_factors(linear):
        return Nearest(inverse, found, 0.0)
    shift = _least_shift(inverse, n)
    if found.values.size and float(np.abs(found.values).min()) > TELLS * shift:  # none: no solution where A is singular
        return Nearest(inverse, found, 0.0)
    inverse = inverse_of(linear.shifted(shift))
    found = leading(inverse, n, start, radius + shift, known + shift, fewest)
    return Nearest(inverse, found, shift)


def by_approximation(
    linear: KrylovLinear, rate: float, start: Array, radius: float, known: float, fewest: int
) -> Nearest | None:
    """As `beside_zero` from solves that take one application of the approximate inverse each, corrected afterwards.

    The Krylov space of an approximate inverse holds about the same vectors; Davidson's method makes them those of A.
    rate : what part of an error one application leaves.  None where an eigenvalue is so small that it drowns others.
    """
    n, applied = len(start), OneApplication(linear)
    found = leading(applied, n, start, radius, known, fewest)
    if not found.values.size:
        return None
    better = improved(linear, applied.columns, rate, found.vectors)
    if float(np.abs(better.values).min(initial=np.inf)) <= TELLS * _least_shift(linear, n):
        return None
    return Nearest(linear, replace(better, certain=found.certain), 0.0)


def _least_shift(inverse: Inverse, n: int) -> float:
    return float(rounding_of(inverse, n) * EPSILON ** (SHIFT - 1.0))


def _has_factors(linear: Linear) -> bool:
    return isinstance(linear, DirectLinear) or (isinstance(linear, KrylovLinear) and linear.precise is not None)
