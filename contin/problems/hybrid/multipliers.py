"""Multipliers of a periodic orbit with jumps: eigenvalues of the map's derivative on the quotient by the flow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.spectrum import count_and_tests, spectrum

if TYPE_CHECKING:
    from contin.problems.hybrid.problem import HybridOrbits


def quotient(problem: HybridOrbits, z: Array) -> Array:
    """(n - 1, n - 1): DP on the quotient by f, which it maps to zero, in scaled states; NaN where there is none.

    In an orthonormal basis of which f is the first vector, DP = [[0, *], [0, Q]].
    """
    n, sizes = problem.n, problem.map.sizes
    u, p = z[:-1], problem.inner.full_parameters(z)
    matrix = problem.map.jacobian(u, p)[1][:, :n] * sizes / sizes[:, None]
    field = problem.flow.system.value(u, p) / sizes
    length = float(np.linalg.norm(field))
    if not (np.isfinite(matrix).all() and length > 0.0):
        return np.full((n - 1, n - 1), np.nan)
    rest = np.linalg.svd((field / length)[None])[2][1:]
    return np.asarray(rest @ matrix @ rest.T)


def stability(problem: HybridOrbits, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
    """(tests of pairs and flips, multipliers outside the unit circle, multipliers: first the trivial one, if any)."""
    matrix = quotient(problem, z)
    own = np.zeros(0) if problem.flow.forced else np.ones(1)
    if not len(matrix):
        return np.ones(2), 0, own.astype(complex)
    if not np.isfinite(matrix).all():
        return np.full(2, np.nan), 0, np.concatenate([own, np.full(len(matrix), np.nan)]).astype(complex)
    values, rates = spectrum(matrix)
    count, tests = count_and_tests(values, True, rates)
    return tests[2:], count, np.concatenate([own, values]).astype(complex)
