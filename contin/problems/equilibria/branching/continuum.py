"""Branches that the reduced equations to third order do not tell apart, at a branch point with a kernel of dimension 2.

With the symmetry of a ring of n >= 5 cells, or of three cells and u -> -u, the reduced equations are rotationally
symmetric to third order: a whole circle of directions solves them, and only a higher order m (up to 2 n - 1) picks the
branches. So the reduced equations are evaluated exactly at a finite distance s: for the direction v(t) in the kernel,
the components normal to the kernel and the parameter are solved for, which leaves one scalar g(t) ~ s^m, the angular
equation. Its zeros are the branches. They are looked for at the smallest s at which g, and with it the sign of the
eigenvalue along the circle, is far above its rounding errors; nearer to the point no computation tells the branches
apart, so that is where they begin. Where g is rounding at all distances the continuum is true (a continuous symmetry).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.newton import Rules, newton, solution
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.defining import singular_basis
from contin.problems.equilibria.scaled import ScaledSystem

NEAREST: Final = 0.05  # s, scaled
FARTHEST: Final = 1.7
RATIO: Final = float(np.sqrt(2.0))  # of one s to the one before ...
CLOSER: Final = 1.05  # ... and the smallest one, where there is no solution farther away
SAMPLES: Final = 128  # of t on the circle: four times the half-branches of a ring of 16 cells
CLEAR: Final = 1e10  # times its rounding errors: |g| from which Newton's method places its zeros to some 1e-11
VISIBLE: Final = 1e7  # ... or this, where the equations have no solution at larger distances
LOOKED_AT: Final = 8  # samples at which rounding errors are measured, ...
NEIGHBOURS: Final = 1e-9  # ... by values at angles this far apart
ACCURATE: Final = 1e-12  # of t
NEWTON: Final = Rules(settled=1e-14, stalled=1e-9, budget=25)  # of the distance from the point
OPPOSITE: Final = 0.2  # of the distance between zeros, by which a half may lie off the other's opposite


def branches_of_continuum(local: ScaledSystem, y: Array, bend: float) -> list[Outset]:
    """The branches near y, with a point on each half; [] where every direction is one.

    bend : second derivative of the parameter along the branches, as the third order gives it for all of them.
    """
    circle = _Circle.at(local, y)
    angles = 2.0 * np.pi * (np.arange(SAMPLES) + 0.3137) / SAMPLES
    offsets = [circle.guess(t, NEAREST, bend) for t in angles]
    before = s = NEAREST
    ratio = RATIO
    outsets: list[Outset] = []
    while s <= FARTHEST:
        solved = [circle.solve(t, s, _moved(v, s / before)) for t, v in zip(angles, offsets, strict=True)]
        points = [point for point in solved if point is not None]
        if len(points) < len(solved):  # a little less far, if anything
            if s == before or ratio < CLOSER:
                return outsets
            ratio = float(np.sqrt(ratio))
            s = before * ratio
            continue
        clear = max(abs(p.g) for p in points) / circle.noise(angles, points, s)
        if clear > VISIBLE:
            outsets = _outsets(circle, circle.zeros(angles, points, s))
        if clear > CLEAR:
            return outsets
        offsets, before, s = [p.offset for p in points], s, s * ratio
    return outsets


def _moved(offset: Array, ratio: float) -> Array:
    """An offset at another distance: states in proportion to it, the parameter to its square."""
    moved = ratio * offset
    moved[-1] *= ratio
    return moved


def _outsets(circle: _Circle, zeros: list[tuple[float, Array]]) -> list[Outset]:
    """Zeros (t, offset), each half with the one that lies opposite to it."""
    angles = np.array([t for t, _ in zeros])
    gap = 2.0 * np.pi / max(len(zeros), 1)
    outsets, used = [], set()
    for k, (t, offset) in enumerate(zeros):
        if k in used:
            continue
        used.add(k)
        away = np.abs(elementary.angle(elementary.exp(1j * (angles - t - np.pi))))
        other = int(np.argmin(away))
        v = circle.direction(t)
        s = float(offset @ v)
        beside = {1: circle.y + offset}
        if away[other] < OPPOSITE * gap and other not in used:
            used.add(other)
            beside[-1] = circle.y + zeros[other][1]
        outsets.append(Outset(v, 2.0 * (offset - s * v) / elementary.square(s), beside))
    return outsets


@dataclass(frozen=True, eq=False)
class _Point:
    """The solution of all equations but the angular one."""

    offset: Array
    g: float  # the angular equation
    noise: float  # what rounding the terms of the equations makes of it


@dataclass(frozen=True, eq=False)
class _Circle:
    """The directions in the kernel of F_u at y, and the reduced equations at a distance s from y."""

    local: ScaledSystem
    y: Array
    kernel: Array  # (n + 1, 2), no component along the parameter
    left: Array  # (n, 2), the left null space
    mixed: Array  # (2, 2): left . F_up . kernel, how the parameter acts on the kernel

    @classmethod
    def at(cls, local: ScaledSystem, y: Array) -> _Circle:
        n = local.n
        left, right = singular_basis(local.linearise(y)[1][:, :n], 2)
        kernel = np.vstack([right, np.zeros((1, 2))])
        along = np.append(np.zeros(n), 1.0)
        mixed = np.column_stack([left.T @ local.form(y, kernel[:, j], along) for j in range(2)])
        return cls(local, y, kernel, left, mixed)

    def direction(self, t: float) -> Array:
        """v(t), a unit vector."""
        return np.asarray(self.kernel @ np.array([elementary.cos(t), elementary.sin(t)]))

    def guess(self, t: float, s: float, bend: float) -> Array:
        offset = s * self.direction(t)
        offset[-1] = 0.5 * bend * elementary.square(s)
        return offset

    def solve(self, t: float, s: float, offset: Array) -> _Point | None:
        """F = 0 but for the angular equation, from a guess; None where that has no solution near it."""
        n = self.local.n
        radial = self.mixed @ np.array([elementary.cos(t), elementary.sin(t)])  # what the parameter balances
        angular = self.left @ np.array([-radial[1], radial[0]]) / np.linalg.norm(radial)
        offset = offset + self.kernel @ (s * np.array([elementary.cos(t), elementary.sin(t)]) - self.kernel.T @ offset)

        def correct(at: tuple[Array, float, Array]) -> tuple[float, tuple[Array, float, Array]] | None:
            offset = at[0]
            if norm(offset[:-1]) > 3.0 * s:
                return None
            f, jacobian = self.local.linearise(self.y + offset)
            # F = 0 up to a multiple of `angular`, the kernel's components fixed: unknowns (offset, multiplier)
            matrix = np.zeros((n + 2, n + 2))
            matrix[:n, : n + 1], matrix[:n, n + 1] = jacobian, angular
            matrix[n:, : n + 1] = self.kernel.T
            step = solution(matrix, np.append(-f, np.zeros(2)))
            if step is None:
                return None
            return norm(step[: n + 1]) / s, (offset + step[: n + 1], float(step[-1]), jacobian)

        found = newton(correct, (offset, 0.0, np.zeros((n, n + 1))), NEWTON)
        if found is None:
            return None
        offset, multiplier, jacobian = found.at
        noise = float(np.finfo(float).eps * (np.abs(angular) @ (np.abs(jacobian) @ np.abs(offset))))
        return _Point(offset, -multiplier, noise)

    def noise(self, angles: Array, points: list[_Point], s: float) -> float:
        """Rounding errors of g: by the size of the terms, and by second differences of neighbouring values."""
        found = max(p.noise for p in points)
        for k in range(0, len(points), len(points) // LOOKED_AT):
            beside = [self.solve(float(angles[k]) + j * NEIGHBOURS, s, points[k].offset) for j in (1, 2)]
            values = [points[k].g, *(b.g for b in beside if b is not None)]
            found = max(found, float(np.abs(np.diff(values, 2)).max(initial=0.0)))
        return found

    def zeros(self, angles: Array, points: list[_Point], s: float) -> list[tuple[float, Array]]:
        """The zeros of g on the circle and the offsets there, by bisection between samples."""
        found = []
        for k, (a, b) in enumerate(zip(points, [*points[1:], points[0]], strict=True)):
            if (a.g > 0.0) == (b.g > 0.0):
                continue
            low, high, near = float(angles[k]), float(angles[k]) + 2.0 * np.pi / len(angles), a
            while high - low > ACCURATE:
                middle = 0.5 * (low + high)
                at = self.solve(middle, s, near.offset)
                if at is None:
                    break
                near = at
                if (at.g > 0.0) == (a.g > 0.0):
                    low = middle
                else:
                    high = middle
            found.append((0.5 * (low + high), near.offset))
        return found
