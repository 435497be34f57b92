"""The bounds of a run: which of them a point is beyond, and the point of the curve on one."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.curve import Stretch
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Sample

SMALL: Final = 1e-3  # part of a step within which a test vanishes that is looked at on the other side of a bound
ROUNDED: Final = 1e-14  # of the bound, or of the parameter's width in the metric


def walls_passed(problem: Problem, z: Array, bounds: tuple[float, float]) -> list[tuple[int, float, str]]:
    """(unknown, bound, name) of every bound that z is beyond; `bounds` are those of the last unknown."""
    walls = problem.walls if in_two_parameters(problem) else [(len(z) - 1, *bounds)]
    names = reversed(problem.parameters[: len(walls)])
    passed = []
    for (index, lowest, highest), name in zip(walls, names, strict=True):
        if not lowest <= z[index] <= highest:
            passed.append((index, lowest if z[index] < lowest else highest, name))
    return passed


def at_wall(stretch: Stretch, beyond: Sample, bounds: tuple[float, float]) -> tuple[Sample, End]:
    """The first point of the stretch on a bound that `beyond` has passed, and the end of the arm there."""
    reached = []
    for index, value, name in walls_passed(stretch.problem, beyond.z, bounds):
        sample = _at_value(stretch, stretch.base, beyond, value, index)
        reached.append((stretch.length_of(sample), sample, value, name))
    _, sample, value, name = min(reached, key=lambda item: item[0])
    return sample, End("bound", f"{name} reached {value:.10g}", {"value": value})


def just_beyond(stretch: Stretch, on_bound: Sample, beyond: Sample) -> Sample:
    """A point of the stretch behind a bound, where a test that vanishes on the bound has its other sign.

    `on_bound` itself where no test is small there; `beyond` is farther out.
    """
    here, start = on_bound.tests, stretch.base.tests
    with np.errstate(invalid="ignore"):
        small = np.abs(here) <= SMALL * np.abs(here - start)
    if here.shape != start.shape or not small.any():
        return on_bound
    wanted, there = SMALL * stretch.distance(stretch.base, on_bound), stretch.distance(on_bound, beyond)
    if there <= wanted:
        return beyond
    return stretch.between(on_bound, beyond, wanted / there) or on_bound


def on_bound_itself(problem: Problem, point: Verified, bounds: tuple[float, float], scale: Array) -> Verified | None:
    """A point that its error, or rounding, may have put beyond a bound: on the bound. None where it lies beyond it.

    An error is that of the first parameter, or the larger one of two: of another it is taken in the metric's proportion
    at most.
    """
    z, moved = point.z.copy(), 0.0
    for index, value, _ in walls_passed(problem, point.z, bounds):
        off, unit = abs(float(z[index]) - value), float(scale[index])
        if not off <= max(point.error * min(1.0, unit / float(scale[-1])), ROUNDED * max(abs(value), unit)):
            return None
        z[index], moved = value, max(moved, off)
    return replace(point, z=z, error=max(point.error, moved)) if moved else point


def _at_value(stretch: Stretch, a: Sample, b: Sample, value: float, index: int) -> Sample:
    """The point between a and b where unknown `index` has exactly this value, solved to full precision."""
    problem, scale = stretch.problem, stretch.frame.scale
    low, high = stretch.zero(lambda s: float(s.z[index] - value), a, b, 1e-7 * stretch.distance(a, b))
    near = low if abs(low.z[index] - value) < abs(high.z[index] - value) else high
    if in_two_parameters(problem):
        solved = problem.at_unknown(index, near.z, value, scale)
    else:
        solved = problem.at_parameter(near.z, value, scale)
    if solved is None or np.linalg.norm((solved - near.z) / stretch.frame.scale) > stretch.distance(a, b) + 1e-6:
        low, high = stretch.zero(lambda s: float(s.z[index] - value), a, b, 1e-13)
        solved = high.z.copy()
        solved[index] = value
    return replace(near, z=solved)
