"""User values: a parameter or a column at a wanted value, located on a stretch of the curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.extrema import SAFETY, Extremum
from contin.continuation.location.found import Found
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Sample


class Sought(Protocol):
    """A value that a function takes between rows of a branch, beside the events that the march sees."""

    @property
    def column(self) -> str:
        """What it is called."""

    @property
    def value(self) -> float: ...

    def values(self, problem: Problem, z: Array) -> Array:
        """Of a function of rows z that takes the value there."""

    def locate(self, stretch: Stretch, z_a: Array, z_b: Array) -> Found | None:
        """The point between two points of the stretch."""


@dataclass(frozen=True)
class Target:
    """`column` (the varying parameter, a state or an observable) takes `value`."""

    column: str
    value: float

    def values(self, problem: Problem, z: Array) -> Array:
        if self.column == problem.parameters[0]:
            return np.asarray(z[:, -1])
        return np.asarray(problem.column(self.column, z), dtype=float)

    def locate(self, stretch: Stretch, z_a: Array, z_b: Array) -> Found | None:
        """The point between two points of the stretch where the column has the value."""
        problem, frame = stretch.problem, stretch.frame

        def value(sample: Sample) -> float:
            return float(self.values(problem, sample.z[None, :])[0] - self.value)

        near, distance = zero_between(stretch, z_a, z_b, value)
        z = near.z
        if self.column == problem.parameters[0]:
            solved = problem.at_parameter(near.z, self.value, frame.scale)
            if solved is not None and np.linalg.norm((solved - near.z) / frame.scale) < 1e-4:
                z = solved
            else:
                z = near.z.copy()
                z[-1] = self.value
        error = self.error(stretch, near)
        if self.column != problem.parameters[0]:
            error += distance * float(frame.scale[-1])
        point = Verified("UZ", z, abs(value(replace(near, z=z))), error, near.eigenvalues, near.unstable)
        return Found(stretch.length_of(near), point, near)

    def error(self, stretch: Stretch, near: Sample) -> float:
        """Of the parameters where the column has the value, that a finer mesh tells; one that is asked for is exact."""
        problem = stretch.problem
        if self.column == problem.parameters[0] and len(problem.parameters) == 1 and not problem.free_names:
            return 0.0
        return moved_by_mesh(stretch, near, self.column, self.value)


def moved_by_mesh(stretch: Stretch, near: Sample, column: str, value: float) -> float:
    """How far the parameters move on a finer mesh where a column has its value; 0 where nothing is discretised."""
    refined = stretch.problem.refined(near, stretch.frame)
    if refined is None:
        return 0.0
    problem, sample, frame = refined

    def change(column: str, before: float) -> tuple[float, float]:
        """Of a column from the value before to the finer mesh, and its slope there along the curve."""
        extremum = Extremum(column)
        slope = float(extremum.slopes(problem, sample.z[None], sample.tangent[None], frame.scale)[0])
        return float(Target(column, before).values(problem, sample.z[None])[0]) - before, slope

    off, slope = change(column, value)
    ahead = -off / slope if slope != 0.0 else 0.0
    moved = []
    for name in (*stretch.problem.parameters, *stretch.problem.free_names):
        by, rate = change(name, float(Target(name, 0.0).values(stretch.problem, near.z[None])[0]))
        moved.append(abs(by + ahead * rate))
    return SAFETY * max(moved)


def zero_between(stretch: Stretch, z_a: Array, z_b: Array, value: Callable[[Sample], float]) -> tuple[Sample, float]:
    """The sample between two points of the stretch where a function of samples vanishes, and how well it is known."""
    ends = []
    for z in (z_a, z_b):
        length = float(stretch.base.tangent @ ((z - stretch.base.z) / stretch.frame.scale))
        sample = stretch.problem.probe(stretch.base, length, z, stretch.frame, stretch.settings)
        ends.append(replace(sample or stretch.base, z=z))  # at a branch point Newton fails, but z is known
    a, b = ends
    if value(b) == 0.0:
        return b, 0.0
    a, b = stretch.zero(value, a, b, 1e-14)
    return (b if abs(value(b)) <= abs(value(a)) else a), stretch.distance(a, b)
