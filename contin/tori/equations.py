"""The equations of an invariant circle: phi(u(s)) = u(s + rho), u periodic in s with period 1, rho the rotation number.

u is a trigonometric polynomial through M nodes, and the equations hold there. Of an autonomous flow the circle lies
anywhere on its torus: with the time T as an unknown, <u - v, f(v)> = 0 says where, for the circle v before it, and
<u - v, v'> = 0 where s begins (Schilder, Osinga and Vogt, 2005; Gomez and Mondelo, 2001). With one equation more (an
arclength, or a parameter's value) for the parameter there are as many equations as unknowns:
z = (u(s_0), ..., u(s_M-1), rho, T where it is free, parameter).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.linalg.newton import Rules, newton, solution
from contin.tori import fourier
from contin.tori.strobe import Strobe

STEPS: Final = 10  # of Newton's method
NOISE: Final = 100.0  # tolerances, within which corrections that stay as large are the rounding of trajectories
DIVERGED: Final = 10.0  # a correction so many times longer than the one before


@dataclass(frozen=True, eq=False)
class Circle:
    """values (M, n) at the nodes, rotation number, time T, value of the parameter."""

    values: Array
    rho: float
    time: float
    value: float

    @property
    def count(self) -> int:
        return len(self.values)

    @property
    def deviation(self) -> Array:
        """(M, n): from the mean."""
        return np.asarray(self.values - self.values.mean(axis=0))

    def resampled(self, count: int) -> Circle:
        return replace(self, values=fourier.resampled(self.values, count))


@dataclass(frozen=True, eq=False)
class Metric:
    """Lengths: states in units of `sizes`, averaged over states and nodes; the parameter in units of its range."""

    sizes: Array
    width: float

    def vector(self, circle: Circle) -> Array:
        """A circle as a vector whose Euclidean length is the metric's: (M n + 1,)."""
        weight = 1.0 / np.sqrt(circle.values.size)
        return np.append((circle.values / self.sizes).ravel() * weight, circle.value / self.width)

    def amplitude(self, circle: Circle) -> float:
        """Root mean square of the deviation from the mean, in units of the sizes."""
        deviation = circle.deviation / self.sizes
        return float(np.sqrt(np.mean(deviation * deviation)))


@dataclass(frozen=True, eq=False)
class Solved:
    """A circle, the derivatives of phi at its nodes (M, n, n), and the unit tangent of the branch (M n + 1,)."""

    circle: Circle
    jacobians: Array
    tangent: Array


def solve(strobe: Strobe, metric: Metric, guess: Circle, tangent: Array, tolerance: float, *, fixed: bool) -> Solved:
    """Newton's method in the plane normal to `tangent` through the guess, or (`fixed`) at the guess's parameter.

    Raises NoSolutionError where it does not converge.
    """
    row = np.append(np.zeros(guess.values.size), 1.0) if fixed else tangent
    circle = guess if strobe.free_time else replace(guess, time=strobe.time(guess.value))

    def correct(at: Solved) -> tuple[float, Solved]:
        matrix, residual, jacobians = _linear(strobe, metric, at.circle, guess, row)
        right = np.stack([-residual, np.append(np.zeros(len(residual) - 1), 1.0)], axis=1)
        both = solution(matrix, right)
        if both is None:
            raise NoSolutionError("the equations are singular")
        step, follow = both.T
        moved = _moved(at.circle, step, metric, strobe)
        along = np.append(follow[: moved.values.size], follow[-1])
        length = float(np.linalg.norm(metric.vector(moved) - metric.vector(at.circle)))
        return length, Solved(moved, jacobians, along / (np.linalg.norm(along) or 1.0))

    rules = Rules(tolerance, NOISE * tolerance, budget=STEPS, growth=DIVERGED)  # it stalls near resonances
    found = newton(correct, Solved(circle, np.empty(0), tangent), rules)
    if found is None or found.exhausted:
        raise NoSolutionError("Newton's method does not converge to an invariant circle")
    return found.at


def _linear(strobe: Strobe, metric: Metric, circle: Circle, before: Circle, row: Array) -> tuple[Array, Array, Array]:
    """Matrix and residual in scaled unknowns (states by size and weight, parameter by width), derivatives of phi."""
    count, n = circle.values.shape
    free = strobe.free_time
    shift, turning = fourier.shift(count, circle.rho)
    found = [strobe.derivatives(u, circle.time, circle.value) for u in circle.values]
    images, jacobians = np.array([one[0] for one in found]), np.array([one[1] for one in found])
    by_time, by_value = np.array([one[2] for one in found]), np.array([one[3] for one in found])
    weight = 1.0 / np.sqrt(count * n)
    columns = np.tile(metric.sizes, count) / weight
    inner = -np.kron(shift, np.eye(n))
    for k in range(count):
        inner[k * n : (k + 1) * n, k * n : (k + 1) * n] += jacobians[k]
    if not free:
        by_value = by_value + by_time * strobe.time_slope(circle.value)
    others = [-(turning @ circle.values), *([by_time * circle.time] if free else []), by_value * metric.width]
    border = np.stack([other.ravel() for other in others], axis=1)
    size = count * n + border.shape[1]
    matrix, residual = np.zeros((size, size)), []
    matrix[: count * n] = np.hstack([inner * columns, border]) / columns[:, None]
    residual.append(strobe.difference(images, shift @ circle.values).ravel() / columns)
    slopes = [fourier.slope(count) @ before.values]
    if free:
        slopes.append(np.array([strobe.speed(u, before.value) for u in before.values]))
    apart = (circle.values - before.values).ravel() / columns
    for k, slope in enumerate(slopes):
        unit = slope.ravel() / columns
        unit = unit / (np.linalg.norm(unit) or 1.0)
        matrix[count * n + k, : count * n] = unit
        residual.append(np.array([unit @ apart]))
    matrix[-1, : count * n], matrix[-1, -1] = row[:-1], row[-1]
    residual.append(np.array([row[:-1] @ apart + row[-1] * (circle.value - before.value) / metric.width]))
    return matrix, np.concatenate(residual), jacobians


def _moved(circle: Circle, step: Array, metric: Metric, strobe: Strobe) -> Circle:
    count, n = circle.values.shape
    weight = 1.0 / np.sqrt(count * n)
    values = circle.values + step[: count * n].reshape(count, n) * metric.sizes / weight
    value = circle.value + float(step[-1]) * metric.width
    time = circle.time * (1.0 + float(step[-2])) if strobe.free_time else strobe.time(value)
    return Circle(values, circle.rho + float(step[count * n]), time, value)
