"""Branches that the reduced equations to third order do not tell apart, at a branch point with a kernel of dimension 2.

With the symmetry of a ring of n >= 5 cells, or of three cells and u -> -u, the reduced equations are rotationally
symmetric to third order: a whole circle of directions solves them, and only a higher order picks the branches. So the
reduced equations are evaluated exactly at a finite distance s: for the direction v(t) in the kernel, the components
normal to the kernel and the parameter are solved for, which leaves one scalar g(t), the angular equation. Its zeros are
the branches; where it vanishes for all t, the continuum is true (a continuous symmetry).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.defining import singular_basis
from contin.problems.scaled import ScaledSystem

DISTANCE = 0.15  # s, scaled
SAMPLES = 64  # of t on the circle: twice the branches of a ring of 16 cells
ROUNDING = 1e-13  # g below this everywhere is zero
ACCURATE = 1e-10  # of t
BUDGET = 25


def fine_directions(local: ScaledSystem, y: Array, bend: float) -> list[tuple[Array, Array]]:
    """Unit tangents and second derivatives z''(0) of the branches near y; [] where every direction is one.

    bend : second derivative of the parameter along the branches, as the third order gives it for all of them.
    """
    circle = _Circle.at(local, y, bend)
    angles = np.pi * np.arange(SAMPLES + 1) / SAMPLES + 0.01  # half the circle: opposite directions are one branch
    values = [circle.angular(t) for t in angles]
    if any(v is None for v in values) or max(abs(v) for v in values if v is not None) < ROUNDING:
        return []
    branches = []
    for k in range(SAMPLES):
        a, b = values[k], values[k + 1]
        assert a is not None
        assert b is not None
        if a * b > 0.0:
            continue
        t = circle.zero(float(angles[k]), float(angles[k + 1]), a)
        offset = None if t is None else circle.solve(t)[0]
        if t is None or offset is None:
            return []
        v = circle.direction(t)
        branches.append((v, 2.0 * (offset - (offset @ v) * v) / elementary.square(DISTANCE)))
    return branches


@dataclass(frozen=True, eq=False)
class _Circle:
    """The directions in the kernel of F_u at y, and the reduced equations at the distance s from y."""

    local: ScaledSystem
    y: Array
    kernel: Array  # (n + 1, 2), no component along the parameter
    left: Array  # (n, 2), the left null space
    mixed: Array  # (2, 2): left . F_up . kernel, how the parameter acts on the kernel
    bend: float

    @classmethod
    def at(cls, local: ScaledSystem, y: Array, bend: float) -> _Circle:
        n = local.n
        left, right = singular_basis(local.linearise(y)[1][:, :n], 2)
        kernel = np.vstack([right, np.zeros((1, 2))])
        along = np.append(np.zeros(n), 1.0)
        mixed = np.column_stack([left.T @ local.form(y, kernel[:, j], along) for j in range(2)])
        return cls(local, y, kernel, left, mixed, bend)

    def direction(self, t: float) -> Array:
        """v(t), a unit vector."""
        return np.asarray(self.kernel @ np.array([elementary.cos(t), elementary.sin(t)]))

    def solve(self, t: float) -> tuple[Array | None, float]:
        """The offset from y with F = 0 but for the angular equation, and the value g of that."""
        n = self.local.n
        v = self.direction(t)
        radial = self.mixed @ np.array([elementary.cos(t), elementary.sin(t)])  # what the parameter balances
        angular = self.left @ np.array([-radial[1], radial[0]]) / np.linalg.norm(radial)
        offset = DISTANCE * v
        offset[n] = 0.5 * self.bend * elementary.square(DISTANCE)
        for _ in range(BUDGET):
            f, jacobian = self.local.linearise(self.y + offset)
            g = float(angular @ f)
            # F = 0 up to a multiple of `angular`, the kernel's components fixed: unknowns (offset, multiplier)
            matrix = np.zeros((n + 2, n + 2))
            matrix[:n, : n + 1], matrix[:n, n + 1] = jacobian, angular
            matrix[n:, : n + 1] = self.kernel.T
            try:
                step = np.linalg.solve(matrix, np.append(-f, np.zeros(2)))
            except np.linalg.LinAlgError:
                return None, g
            if not np.all(np.isfinite(step)) or np.linalg.norm(offset) > 2.0 * DISTANCE:
                return None, g
            offset = offset + step[: n + 1]
            if float(np.linalg.norm(step[: n + 1])) < 1e-13:
                return offset, g
        return offset, g

    def angular(self, t: float) -> float | None:
        """g(t), None where the other equations have no solution."""
        offset, g = self.solve(t)
        return None if offset is None else g

    def zero(self, a: float, b: float, g_a: float) -> float | None:
        """The zero of g between a and b, by bisection."""
        while b - a > ACCURATE:
            middle = 0.5 * (a + b)
            g = self.angular(middle)
            if g is None:
                return None
            if (g > 0.0) == (g_a > 0.0):
                a = middle
            else:
                b = middle
        return 0.5 * (a + b)
