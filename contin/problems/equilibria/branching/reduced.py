"""The reduced equations at a branch point, exact at finite distance.

At a point where J = [F_u F_p] (n, n + 1) has corank k, points near it are y + N c + v with the columns of N (n + 1, k +
1) an orthonormal basis of ker J and v normal to them. For given c the equations F = P mu (the columns of P (n, k) a
basis of the left null space) and N^T v = 0 determine v and mu = h(c): the branches are the zeros of h
(Lyapunov-Schmidt; Golubitsky and Schaeffer 1985, ch. VII).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.newton import Rules, newton, solution
from contin.linalg.vectors import norm
from contin.problems.equilibria.defining import singular_basis
from contin.problems.equilibria.scaled import ScaledSystem

NEWTON: Final = Rules(settled=1e-14, stalled=1e-9, far=1.0, budget=15)
ON_SPHERE: Final = Rules(settled=1e-14, stalled=1e-9, budget=30)


@dataclass(frozen=True, eq=False)
class Value:
    """h(c) (k,), its derivatives (k, k + 1), v (n + 1,), and the rounding errors of h by the size of its terms."""

    h: Array
    slopes: Array
    v: Array
    noise: float


@dataclass(frozen=True, eq=False)
class ReducedEquations:
    """h at the point y of a scaled system."""

    local: ScaledSystem
    y: Array
    kernel: Array  # N
    left: Array  # P

    @classmethod
    def at(cls, local: ScaledSystem, y: Array, corank: int) -> ReducedEquations:
        left, kernel = singular_basis(local.linearise(y)[1], corank)
        return cls(local, y, kernel, left)

    @property
    def corank(self) -> int:
        return int(self.left.shape[1])

    def value(self, c: Array, v: Array) -> Value | None:
        """At c (k + 1,), from a guess v; None where the other equations have no solution near it."""
        n, k = self.left.shape
        matrix = np.zeros((n + 1 + k, n + 1 + k))
        matrix[:n, n + 1 :] = -self.left
        matrix[n:, : n + 1] = self.kernel.T
        right = np.zeros((n + 1 + k, k + 2))

        def correct(at: tuple[Array, Array, Array]) -> tuple[float, tuple[Array, Array, Array]] | None:
            v = at[0]
            f, jacobian = self.local.linearise(self.y + self.kernel @ c + v)
            if not (np.all(np.isfinite(f)) and np.all(np.isfinite(jacobian))):
                return None
            matrix[:n, : n + 1] = jacobian
            right[:n, 0], right[n:, 0] = -f, -self.kernel.T @ v
            right[:n, 1:] = -jacobian @ self.kernel
            step = solution(matrix, right)
            return None if step is None else (norm(step[: n + 1, 0]), (v + step[: n + 1, 0], step, jacobian))

        found = newton(correct, (v, right, matrix), NEWTON)
        if found is None:
            return None
        v, step, jacobian = found.at
        terms = np.abs(self.left.T) @ (np.abs(jacobian) @ np.abs(self.kernel @ c + v))
        return Value(step[n + 1 :, 0], step[n + 1 :, 1:], v, float(np.finfo(float).eps * terms.max()))

    def on_sphere(self, at: Array, radius: float) -> Array | None:
        """The zero of h with |c| = radius that Newton's method finds from the point `at`; None where it finds none."""

        def correct(at: Array) -> tuple[float, Array] | None:
            f, jacobian = self.local.linearise(at)
            c = self.kernel.T @ (at - self.y)
            matrix = np.vstack([jacobian, (self.kernel @ c)[None] / radius])
            step = solution(matrix, np.append(-f, 0.5 * (radius - float(c @ c) / radius)))
            if step is None:
                return None
            size = norm(step)
            at = at + step * min(1.0, 0.5 * radius / max(size, 1e-300))
            return None if norm(at - self.y) > 4.0 * radius else (size, at)

        found = newton(correct, at, ON_SPHERE)
        return None if found is None else found.at

    def sign(self, at: Array) -> float:
        """The sign of the determinant of h and |c|^2 by c at a zero; NaN where it is not known.

        Over all zeros on a sphere these add up to 0, as h maps the sphere to a plane (its degree is 0).
        """
        c = self.kernel.T @ (at - self.y)
        found = self.value(c, at - self.y - self.kernel @ c)
        return float("nan") if found is None else float(np.linalg.slogdet(np.vstack([found.slopes, c]))[0])
