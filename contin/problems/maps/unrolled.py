"""Special points of long cycles of maps, solved for in all points of the cycle at once.

The k-th iterate multiplies rounding errors by the cycle's largest multiplier: beside one of 1e7 nothing about its fixed
points is known to better than 1e-9, and the place of a special point, whose defining system has second derivatives, to
better than 1e-2. In all points (x_1, ..., x_k, p) every equation is as tame as the map. With E the projector to the
components of x_1, the Jacobian of

    F(x_1, ..., x_k, p) = (f(x_k) - x_1, f(x_1) - x_2, ..., f(x_{k-1}) - x_k)

less (m - 1) E is singular where m is a multiplier: v_{j+1} = f'(x_j) v_j, f'(x_k) v_k = m v_1. So the defining systems
of `contin.problems.equilibria.defining` serve as they are, with E in the place of the identity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.continuation.sample import Frame, Sample
from contin.machine import elementary
from contin.problems.equilibria import defining
from contin.problems.equilibria.solved_to_rounding import Solved
from contin.problems.equilibria.special_points import CONSISTENT, nearest_pair
from contin.problems.tolerances import RESIDUAL_LIMIT
from contin.systems.accuracy import accuracy_of_equations, error_of_grain

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem
    from contin.systems.iterate import IteratedSystem

WIDE = 1e-12  # of the range: an error beyond it is one of the iterate's rounding, not of the map's
REGULAR = 1e-10  # of the range: a branch point solves the fold's system too, to the root of rounding only
NEAR = 1e-2  # scaled: how far from a located point its special point may be
TURNED = 0.3  # of the angle of a pair, by which it may change from the located point


class Cycle(Protocol):
    """What is asked of the problem of cycles, `contin.problems.maps.cycle.CycleProblem`."""

    @property
    def n(self) -> int: ...

    @property
    def active(self) -> int: ...

    @property
    def period(self) -> int: ...

    @property
    def inner(self) -> EquilibriumProblem: ...

    @property
    def system(self) -> IteratedSystem: ...

    def linearise(self, z: Array) -> tuple[Array, Array]: ...

    def multipliers(self, z: Array) -> NDArray[np.complex128]: ...

    def with_iterates_form(self, point: Verified, frame: Frame) -> Outcome: ...


@dataclass(frozen=True, eq=False)
class AllPoints:
    """`Local` view of a cycle in scaled unknowns y = (x_1, ..., x_k, p) / scale."""

    problem: Cycle
    scale: Array

    @property
    def n(self) -> int:
        return len(self.scale) - 1

    @property
    def grained(self) -> bool:
        """The map's values are rounded to some digits, or noisy."""
        return error_of_grain(self.problem.system.base) > 0.0

    @property
    def identity(self) -> Array:
        """E, (k n, k n)."""
        diagonal = np.zeros(self.n)
        diagonal[: self.problem.n] = 1.0
        return np.diag(diagonal)

    def linearise(self, y: Array) -> tuple[Array, Array]:
        f, jacobian = self.problem.linearise(y * self.scale)
        rows = self.scale[:-1]
        return f / rows, jacobian * self.scale / rows[:, None]

    def linearised(self, y: Array) -> tuple[Array, Array]:
        """`linearise` at places (m, k n + 1)."""
        both = [self.linearise(row) for row in y]
        return np.array([f for f, _ in both]), np.array([jacobian for _, jacobian in both])

    def hessian(self, y: Array, v: Vector) -> Vector:
        """The matrix D^2F(y)[v, .], (k n, k n + 1): second derivatives of the map at each point."""
        problem, n, k = self.problem, self.problem.n, self.problem.period
        z, direction = y * self.scale, v * self.scale
        p, base = problem.inner.full_parameters(z), problem.system.base
        wide = np.zeros(n + base.m, v.dtype)
        wide[n + problem.active] = direction[-1]
        matrix = np.zeros((k * n, k * n + 1), v.dtype)
        for j in range(k):
            here, row = slice(j * n, (j + 1) * n), (j + 1) % k
            wide[:n] = direction[here]
            bent = base.gradient(z[here], p, wide)
            there = slice(row * n, (row + 1) * n)
            matrix[there, here], matrix[there, -1] = bent[:, :n], bent[:, n + problem.active]
        return np.asarray(matrix * self.scale / self.scale[:-1, None])

    def bordered(self, kind: int, b: Vector, c: Vector, shift: float = 0.0, unit: float = 1.0) -> None:
        """No kernel has these equations."""
        return


def sharper(problem: Cycle, found: Outcome, type_: str, near: Sample, frame: Frame) -> Outcome:
    """What the iterate found, or the same point to the map's rounding where the iterate's hides its place.

    `found` is in all points of the cycle, and returned as it is where these know no better.
    """
    width = float(frame.scale[-1])
    if type_ not in ("LP", "PD", "NS") or not _hidden(found, type_, width):
        return found
    y = near.z / frame.scale
    solved, critical = _solved(AllPoints(problem, frame.scale), y, type_, near)
    if solved is None or not solved.residual <= min(RESIDUAL_LIMIT, CONSISTENT * solved.noise):
        return found
    error = (solved.error + accuracy_of_equations(problem.system) * solved.sensitivity) * width
    error += 0.5 * float(np.finfo(float).eps) * abs(float(solved.y[-1] * width))
    known = found.error if isinstance(found, Verified) else REGULAR * width
    if not (error < known and np.abs(solved.y - y).max() < NEAR):
        return found
    z = solved.y * frame.scale
    values = problem.multipliers(z)
    other = np.ones(len(values), bool)
    for value in critical:
        other[np.where(other, np.abs(values - value), np.inf).argmin()] = False
    unstable = int((np.abs(values[other]) > 1.0).sum())
    vectors = {"omega": abs(float(solved.extra[0])), "kernel": 1} if solved.extra.size else {}
    point = Verified(type_, z, solved.residual, error, values, unstable, vectors=vectors)
    return problem.with_iterates_form(point, frame)


def _hidden(found: Outcome, type_: str, width: float) -> bool:
    """True where the iterate's rounding may be all that is in the way of a label, or of its place."""
    if isinstance(found, Verified):
        return found.type == type_ and not found.crowded and found.error > WIDE * width
    return isinstance(found, Rejected) and found.suspect


def _solved(local: AllPoints, y: Array, type_: str, near: Sample) -> tuple[Solved | None, list[complex]]:
    """The solution of the defining system, and the multipliers that are critical there."""
    if type_ == "LP":
        return defining.fold(local, y), [1.0]
    if type_ == "PD":
        return defining.eigenvalue_at(local, y, -2.0), [-1.0]
    pair = nearest_pair(near.eigenvalues, True)
    if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
        return None, []
    angle = float(elementary.angle(pair))
    solved = defining.critical_pair(
        local, y, lambda w: elementary.exp(1j * w) - 1.0, lambda w: 1j * elementary.exp(1j * w), angle
    )
    if solved is None or abs(abs(float(solved.extra[0])) - angle) > TURNED * angle:
        return None, []
    value = complex(elementary.exp(1j * float(solved.extra[0])))
    return solved, [value, value.conjugate()]
