"""Bordered systems of small dense matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class DenseBordered:
    """[E'; B] with its inverse, and E'."""

    residual: Array
    sign: float
    log_determinant: float
    _jacobian: Array
    _inverse: Array

    def image(self, x: Array) -> Array:
        """E' x, both scaled."""
        return np.asarray(self._jacobian @ x)

    def solve(self, right: Array) -> Array:
        return np.asarray(self._inverse @ right)


def dense_bordered(residual: Array, jacobian: Array, rows: Array) -> DenseBordered | None:
    """Both scaled; None where something is not finite."""
    matrix = np.vstack([jacobian, rows])
    if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(residual))):
        return None
    sign, size = np.linalg.slogdet(matrix)
    try:
        inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
    except np.linalg.LinAlgError:  # its `sign` says so
        return DenseBordered(residual, 0.0, 0.0, jacobian, np.full_like(matrix, np.nan))
    return DenseBordered(residual, float(sign), float(size), jacobian, inverse)
