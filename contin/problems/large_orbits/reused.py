"""Intervals solved by GMRES with factors that they share: one real and one complex matrix of n rows for each length.

With A = V diag(l) V^-1 of the inverse of Radau's matrix, (I - t A x J) d = r is l_k - t J for each k where J is the
same at all points (Hairer and Wanner, Solving Ordinary Differential Equations II, sec. IV.8); the mean over the orbit
takes its place. What is left, t (J - mean), is small beside what makes the equations stiff. The factors are of a third
of the rows of an interval's own and there are two of them, not one for every interval.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.linalg.factor import Factoriser
from contin.linalg.krylov import gmres
from contin.linalg.linear import DirectLinear
from contin.linalg.tally import Tally
from contin.problems.large_orbits.radau import INVERSE, STAGES, A

EXACT: Final = 1e-13  # residual of an interval's solution: M is applied again and again
_VALUES, _VECTORS = np.linalg.eig(INVERSE)
_UP: Final = int(np.argmax(_VALUES.imag))
_REAL: Final = int(np.argmin(np.abs(_VALUES.imag)))
_LEFT: Final = np.linalg.inv(_VECTORS) @ INVERSE


@dataclass(frozen=True, eq=False)
class Shared:
    """(l - t J)^-1 for the real and for a complex eigenvalue l, J the mean."""

    real: DirectLinear
    complex_: DirectLinear
    step: float

    @classmethod
    def of(cls, mean: csc_matrix, step: float, tally: Tally, mass: csc_matrix | None = None) -> Shared:
        linear = DirectLinear(mean, Factoriser(tally), mass=mass)
        return cls(linear.shifted(float(_VALUES[_REAL].real) / step), linear.shifted(_VALUES[_UP] / step), step)

    def about(self, right: Array, transposed: bool) -> Array:
        """About the interval's solution (n, 3), real."""
        into, back = (_VECTORS.T, _LEFT.T) if transposed else (_LEFT, _VECTORS)
        out = np.zeros(right.shape)
        for k, linear, twice in ((_REAL, self.real, 1.0), (_UP, self.complex_, 2.0)):
            part = right @ into[k]
            part = part.real.copy() if k == _REAL else part
            solve = linear.factor.solve_transposed if transposed else linear.factor.solve
            out += twice * np.real(np.outer(solve(part) / -self.step, back[:, k]))
        return out


@dataclass(frozen=True, eq=False)
class ReusedInterval:
    """1 x M - t (A x J) of one interval, J at its three points."""

    three: Sequence[csc_matrix]
    shared: Shared
    mass: csc_matrix | None = None

    def _apply(self, x: Array) -> Array:
        wide = x.reshape(-1, STAGES)
        moved = np.column_stack([J @ column for J, column in zip(self.three, wide.T, strict=True)])
        weighed = wide if self.mass is None else self.mass @ wide
        return np.asarray((weighed - self.shared.step * moved @ A.T).ravel())

    def _apply_transposed(self, x: Array) -> Array:
        wide = x.reshape(-1, STAGES)
        moved = np.column_stack([J.T @ column for J, column in zip(self.three, (wide @ A).T, strict=True)])
        weighed = wide if self.mass is None else self.mass.T @ wide
        return np.asarray((weighed - self.shared.step * moved).ravel())

    def _solved(self, right: Vector, apply: Callable[[Array], Array], transposed: bool) -> Vector:
        if np.iscomplexobj(right):
            return self._solved(right.real, apply, transposed) + 1j * self._solved(right.imag, apply, transposed)
        found = gmres(
            apply, lambda r: self.shared.about(r.reshape(-1, STAGES), transposed).ravel(), np.array(right), EXACT
        )
        return found[0]

    def solve(self, right: Vector) -> Vector:
        if right.ndim == 2:
            return np.column_stack([self.solve(column) for column in right.T])
        return self._solved(right, self._apply, False)

    def solve_transposed(self, right: Vector) -> Vector:
        return self._solved(right, self._apply_transposed, True)


def intervals_with_shared_factors(
    pairs: Sequence[tuple[Sequence[csc_matrix], float]], tally: Tally, mass: csc_matrix | None = None
) -> list[ReusedInterval]:
    """From J at the three points and the length T h of each interval."""
    first = pairs[0][0][0]
    total = np.zeros(first.nnz)
    for three, _ in pairs:
        for J in three:
            total += J.data
    mean = csc_matrix((total / (STAGES * len(pairs)), first.indices, first.indptr), shape=first.shape)
    known: dict[float, Shared] = {}
    for _, step in pairs:
        if step not in known:
            known[step] = Shared.of(mean, step, tally, mass)
    return [ReusedInterval(three, known[step], mass) for three, step in pairs]
