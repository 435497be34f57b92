"""Invariant circles of the return map P to a plane: P(u(s)) = u(s + rho), u periodic in s, with the turn rho unknown.

The curve is a trigonometric polynomial through M points of the plane; the equations hold there, and <u - v, v'> = 0 for
the curve v before it fixes where s begins (Schilder, Osinga and Vogt, 2005; Jorba, 2001). M n + 1 equations in n
coordinates of the plane. Flows may be piecewise smooth: variations jump at crossings, and the circle has kinks where it
crosses a surface, of which `tail` tells how well they are resolved.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.simulate.flight import fly
from contin.simulate.section import Section
from contin.tori import fourier

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

STEPS = 12  # of Newton's method
SETTLED = 1e-9  # of the residual, relative to the circle's size
LONGEST = 1e3  # time of a return
CHUNK = 100  # returns in one flight


@dataclass(frozen=True, eq=False)
class Plane:
    """Where state `index` crosses `value` upwards (direction 1) or downwards (-1)."""

    index: int
    value: float = 0.0
    direction: int = 1

    def section(self, n: int) -> Section:
        return Section(np.eye(n)[self.index], self.value, self.direction)

    def others(self, n: int) -> Array:
        return np.delete(np.arange(n), self.index)

    def whole(self, x: Array) -> Array:
        """The state of a point x of the plane."""
        return np.insert(x, self.index, self.value)


@dataclass(frozen=True, eq=False)
class Circle:
    """values (M, n - 1) at the nodes, rotation number rho, parameters p; `residual` and `tail` relative to its size."""

    system: CompiledSystem
    plane: Plane
    p: Array
    values: Array
    rho: float
    residual: float = np.inf

    @property
    def tail(self) -> float:
        return fourier.tail(self.values)

    @property
    def size(self) -> float:
        return float(np.abs(self.values - self.values.mean(axis=0)).max())


def returned(system: CompiledSystem, plane: Plane, p: Array, x: Array, count: int = 1) -> Array:
    """The next `count` points of the plane, (count, n - 1)."""
    n, found = int(system.n), np.empty((0, len(x)))
    while len(found) < count:
        part = min(CHUNK, count - len(found))
        flight = fly(system, plane.whole(x), p, LONGEST * part, section=plane.section(n), events=part)
        if len(flight.events) < part:
            raise NoSolutionError(f"the trajectory does not return to the plane {flight.why}".rstrip())
        found = np.vstack([found, flight.events[:, 1 : 1 + n][:, plane.others(n)]])
        x = found[-1]
    return found


def return_map(system: CompiledSystem, plane: Plane, p: Array, x: Array) -> tuple[Array, Array]:
    """P(x) and its derivative."""
    n, others = int(system.n), plane.others(int(system.n))
    flight = fly(
        system, plane.whole(x), p, LONGEST, section=plane.section(n), events=1, variations=np.eye(n)[:, others]
    )
    if len(flight.events) < 1:
        raise NoSolutionError("the trajectory does not return to the plane")
    u, moved = flight.events[0, 1 : 1 + n], flight.events[0, 1 + n :].reshape(-1, n).T
    speed = np.asarray(system.value(u, p))
    back = moved - np.outer(speed, moved[plane.index]) / speed[plane.index]
    return u[others], back[others]


def first_circle(
    system: CompiledSystem, plane: Plane, p: Array, x: Array, *, count: int = 41, transient: int = 500,
    points: int = 2000,
) -> Circle:  # fmt: skip
    """The circle on which the iterates of x settle, solved for."""
    start = returned(system, plane, p, x, transient)[-1] if transient else x
    found = returned(system, plane, p, start, points)
    rho = fourier.rotation(found)
    return solved(Circle(system, plane, p, fourier.fitted(found, rho, count), rho))


def solved(guess: Circle) -> Circle:
    """Newton's method from a guess; raises NoSolutionError where it does not converge."""
    count, n = guess.values.shape
    slope = (fourier.shift(count, 0.0)[1] @ guess.values).ravel()
    circle = guess
    for _ in range(STEPS):
        values, turning = fourier.shift(count, circle.rho)
        images = [return_map(circle.system, circle.plane, circle.p, x) for x in circle.values]
        residual = (np.array([image for image, _ in images]) - values @ circle.values).ravel()
        circle = replace(circle, residual=float(np.abs(residual).max()) / circle.size)
        if circle.residual < SETTLED:
            return circle
        matrix = np.zeros((count * n + 1, count * n + 1))
        matrix[:-1, :-1] = -np.kron(values, np.eye(n))
        for k, (_, derivative) in enumerate(images):
            matrix[k * n : (k + 1) * n, k * n : (k + 1) * n] += derivative
        matrix[:-1, -1] = -(turning @ circle.values).ravel()
        matrix[-1, :-1] = slope
        phase = slope @ (circle.values - guess.values).ravel()
        step = np.linalg.solve(matrix, -np.append(residual, phase))
        circle = replace(circle, values=circle.values + step[:-1].reshape(count, n), rho=circle.rho + float(step[-1]))
    raise NoSolutionError(f"Newton's method did not converge on the circle (residual {circle.residual:.2g})")


def continued(circle: Circle, index: int, to: float, step: float, smallest: float = 1e-4) -> Iterator[Circle]:
    """Circles for parameter `index` up to the value `to`, from secants; the last is where no further one is found."""
    before: Circle | None = None
    value, sign = float(circle.p[index]), np.sign(to - circle.p[index])
    while sign * (to - value) > 1e-12:
        aim = value + sign * min(step, abs(to - value))
        guess = replace(circle, p=_with(circle.p, index, aim))
        if before is not None:
            part = (aim - value) / (value - float(before.p[index]))
            values = circle.values + part * (circle.values - before.values)
            guess = replace(guess, values=values, rho=circle.rho + part * (circle.rho - before.rho))
        try:
            found = solved(guess)
        except (NoSolutionError, np.linalg.LinAlgError):
            step *= 0.5
            if step < smallest:
                return
            continue
        before, circle, value = circle, found, aim
        yield circle


def _with(p: Array, index: int, value: float) -> Array:
    changed = p.copy()
    changed[index] = value
    return changed
