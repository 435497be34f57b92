"""What the Python march needs of a dense problem without machine code: LU factors of [J; t], tests of stability."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.kernels.algebraic import MET
from contin.linalg.spectrum import count_and_tests, spectrum
from contin.linalg.vectors import generic, norm
from contin.machine import elementary

if TYPE_CHECKING:
    from contin.problems.contracts import Dense

MANY = 20


@dataclass(frozen=True, eq=False)
class DenseLinearisation:
    """Scaled residual (n,) and LU factors of M = [J; t^T] (n + 1, n + 1).

    log_determinant : of |det M|; of `MANY` states or more, when that swings by powers of ten from row to row though
        nothing happens, of 1 / |M^-1 r|, r random, about the smallest singular value.
    """

    residual: Array
    factors: tuple[Array, Vector]
    sign: float
    log_determinant: float
    met: bool = True  # what is left of every equation is small beside its linear terms

    def solve(self, right: Array) -> Array:
        """M x = right."""
        from scipy.linalg import lapack

        return np.asarray(lapack.dgetrs(*self.factors, right)[0])


def dense_linearisation(
    f: Array, jacobian: Array, tangent: Array, scale: Array, z: Array | None = None
) -> DenseLinearisation | None:
    """F and J (unscaled) at z with the border row `tangent`, factored; None where they are not finite."""
    from scipy.linalg import lapack

    d = scale[:-1]
    matrix = np.vstack([jacobian * scale / d[:, None], tangent])
    if not (np.all(np.isfinite(f)) and np.all(np.isfinite(matrix))):
        return None
    lu, pivots, _ = lapack.dgetrf(matrix)
    diagonal = np.diagonal(lu)
    changes = np.count_nonzero(pivots != np.arange(len(pivots))) + np.count_nonzero(diagonal < 0.0)
    sign = 0.0 if not np.all(diagonal) else -1.0 if changes % 2 else 1.0
    if sign == 0.0:
        logarithm = -np.inf
    elif len(f) < MANY:
        logarithm = float(np.sum(elementary.log(np.abs(diagonal))))
    else:
        logarithm = -elementary.log(norm(np.asarray(lapack.dgetrs(lu, pivots, generic(len(matrix)))[0])))
    met = z is None or bool(np.all(np.abs(f) <= MET * (np.abs(jacobian) @ np.abs(z))))
    return DenseLinearisation(f / d, (lu, pivots), sign, logarithm, met)


@dataclass(frozen=True, eq=False)
class DenseMarch:
    """A problem with `linearise`, `linear_part`, `is_map`, `angle_periods`, as `contin.continuation.march` takes it."""

    problem: Dense

    @property
    def angle_periods(self) -> Array:
        return np.asarray(self.problem.angle_periods)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> DenseLinearisation | None:
        f, jacobian = self.problem.linearise(z)
        return dense_linearisation(f, jacobian, tangent, scale, z)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        values, rates = spectrum(self.problem.linear_part(z))
        count, tests = count_and_tests(values, self.problem.is_map, rates)
        return tests[2:], count, values
