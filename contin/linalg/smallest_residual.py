"""What GMRES minimises in its Krylov space: a small least-squares problem that grows by columns."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Vector
from contin.linalg.vectors import norm
from contin.machine import elementary

RESTART = 60
SINGULAR = 1e-13  # ratio of a triangle's diagonal entries, and of singular values, that rounding makes


class SmallestResidual:
    """y of the smallest |beta e_1 - H y| for a Hessenberg matrix H that grows by columns: its QR factors by rotations.

    Where H is singular to rounding, y is the shortest one, by singular values.
    """

    def __init__(self, beta: float, kind: np.dtype[Any]) -> None:
        self.hessenberg, self.triangle = np.zeros((RESTART + 1, RESTART), kind), np.zeros((RESTART, RESTART), kind)
        self.right = np.zeros(RESTART + 1, kind)
        self.beta = self.right[0] = beta
        self.rotations: list[tuple[complex, complex]] = []
        self.sizes: list[float] = []  # of the triangle's diagonal

    def with_column(self, column: Vector) -> float:
        """The residual's norm with one more column, (k + 2,), the last entry of which is >= 0."""
        k = len(self.rotations)
        self.hessenberg[: k + 2, k] = column
        entries = column.tolist()
        for i, (a, b) in enumerate(self.rotations):
            upper, lower = entries[i], entries[i + 1]
            entries[i], entries[i + 1] = a.conjugate() * upper + b * lower, a * lower - b * upper
        upper, below = entries[k], entries[k + 1].real
        size = float(elementary.hypot(abs(upper), below))
        a, b = (upper / size, below / size) if size > 0.0 else (1.0, 0.0)
        self.rotations.append((a, b))
        self.sizes.append(size)
        self.triangle[:k, k], self.triangle[k, k] = entries[:k], size
        here = self.right[k]
        self.right[k], self.right[k + 1] = np.conj(a) * here, -b * here
        return self.residual() if self._is_singular() else abs(complex(self.right[k + 1]))

    def _is_singular(self) -> bool:
        return min(self.sizes) <= SINGULAR * max(self.sizes)

    def residual(self) -> float:
        """|beta e_1 - H y| of the solution as it is, with its rounding errors."""
        k = len(self.rotations)
        left = -(self.hessenberg[: k + 1, :k] @ self.solution())
        left[0] += self.beta
        return norm(left)

    def solution(self) -> Vector:
        """y (k,)."""
        k = len(self.rotations)
        triangle, right = self.triangle[:k, :k], self.right[:k]
        if self._is_singular():
            return np.asarray(np.linalg.lstsq(triangle, right, rcond=SINGULAR)[0])
        y = right.copy()
        for i in range(k - 1, -1, -1):
            y[i] /= triangle[i, i]
            y[:i] -= triangle[:i, i] * y[i]
        return y
