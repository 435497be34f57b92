"""Tests that are lost in the rounding errors of the Jacobian's terms, which err alike at neighbouring points.

An entry of the Jacobian in skewed coordinates is a sum of terms that cancel. Of a small singular value or eigenvalue
with the vectors w, v nothing is known that is not larger than some eps |w|' |J| |v| (Higham,
Accuracy and Stability, ch. 3), and no comparison of points beside each other shows it.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array

EPSILON: Final = float(np.finfo(float).eps)
ROUNDING: Final = 30.0 * EPSILON  # of an entry: it is itself a sum of larger terms


def branch_point_is_lost(jacobian: Array) -> bool:
    """True where the smallest singular value of [F_u F_p] (n, n + 1) may be zero for all that rounding lets see."""
    left, singular, right = np.linalg.svd(jacobian, full_matrices=False)
    felt = np.abs(left[:, -1]) @ np.abs(jacobian) @ np.abs(right[-1])
    return bool(singular[-1] <= max(ROUNDING * float(felt), EPSILON * float(singular[0])))


def pair_is_lost(matrix: Array) -> bool:
    """True where the real part of the pair of F_u (n, n) nearest the imaginary axis may be zero."""
    values, right = np.linalg.eig(matrix)
    pairs = np.flatnonzero(values.imag > 0.0)
    if not pairs.size:
        return False
    k = pairs[np.argmin(np.abs(values[pairs].real))]
    left: NDArray[np.complex128] = np.linalg.inv(right)[k].astype(complex)
    felt = np.abs(left) @ np.abs(matrix) @ np.abs(right[:, k])
    return bool(abs(values[k].real) <= ROUNDING * float(felt))
