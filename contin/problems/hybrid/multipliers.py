"""Multipliers of a periodic orbit with jumps: eigenvalues of the map's derivative on the quotient by the flow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.spectrum import count_and_tests, spectrum

if TYPE_CHECKING:
    from contin.problems.hybrid.cycle_of_events import CycleOfEvents


def quotient(problem: CycleOfEvents, z: Array) -> Array:
    """DP on its quotient by one vector that it maps to zero, in scaled states; NaN where there is none.

    That vector is the axis of a state that the last jump sets, which is no unknown, or else f: in an orthonormal basis
    of which it is the first vector, DP = [[0, *], [0, Q]].
    """
    returns, p = problem.map, problem.inner.full_parameters(z)
    sizes, n = returns.sizes[returns.kept], returns.n
    if returns.entered.all():
        return np.zeros((0, 0))
    matrix = returns.jacobian(z[:-1], p)[1][:, :n] * sizes / sizes[:, None]
    if returns.entered.any():
        return matrix
    field = problem.flow.system.value(z[:-1], p) / sizes
    length = float(np.linalg.norm(field))
    if not (np.isfinite(matrix).all() and length > 0.0):
        return np.full((n - 1, n - 1), np.nan)
    rest = np.linalg.svd((field / length)[None])[2][1:]
    return np.asarray(rest @ matrix @ rest.T)


def stability(problem: CycleOfEvents, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
    """(tests of pairs and flips, multipliers outside the unit circle, multipliers: first the trivial one, if any)."""
    matrix = quotient(problem, z)
    own = np.zeros(0) if problem.flow.forced else np.ones(1)
    lost = np.zeros(problem.flow.n - 1 - len(matrix))  # of states that jumps set
    if not len(matrix):
        return np.ones(2), 0, np.concatenate([own, lost]).astype(complex)
    if not np.isfinite(matrix).all():
        return np.full(2, np.nan), 0, np.concatenate([own, np.full(len(matrix), np.nan), lost]).astype(complex)
    values, rates = spectrum(matrix)
    count, tests = count_and_tests(values, True, rates)
    return tests[2:], count, np.concatenate([own, values, lost]).astype(complex)
