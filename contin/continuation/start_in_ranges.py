"""A start and the ranges of the parameters that vary: on a bound to rounding, outside one, or leaving at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.continuation.branch import End
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Sample
from contin.continuation.seed import Seed
from contin.errors import InputError

BEYOND: Final = 1e-9  # of the range: a start this far outside it was solved for, and lies on its bound

Bounds = tuple[float, float]


def with_rounding(bounds: Bounds, value: float) -> Bounds:
    """The bounds, moved to a start that was solved for and lies beyond one by no more than a solution's errors."""
    low, high = bounds
    slack = BEYOND * (high - low) if np.isfinite(high - low) else 0.0
    return value if low - slack <= value < low else low, value if high < value <= high + slack else high


def within_further_ranges(seed: Seed) -> Seed:
    """The seed with ranges that hold its start's rounding, too; InputError where a further parameter is outside one."""
    problem = seed.problem
    if not in_two_parameters(problem):
        return seed
    walls = [(index, *with_rounding((low, high), float(seed.z[index]))) for index, low, high in problem.walls]
    ranges = [(low, high) for _, low, high in walls[::-1]]
    wider = seed if walls == list(problem.walls) else replace(seed, problem=problem.within(*ranges))  # type: ignore[attr-defined]
    for name, index, lowest, highest in _further(wider.problem):
        if not lowest <= seed.z[index] <= highest:
            raise InputError(
                f"the start has {name} = {seed.z[index]:.10g}, outside the range [{lowest:g}, {highest:g}]"
            )
    return wider


def leaves_at_once(seed: Seed, start: Sample, sense: int, bounds: Bounds) -> End | None:
    """Of an arm that would leave the range at once: that end."""
    ranges = [*_further(seed.problem), (seed.problem.parameters[0], -1, *bounds)]
    for name, index, lowest, highest in ranges:
        value, rate = start.z[index], sense * start.tangent[index]
        if (value >= highest and rate > 0) or (value <= lowest and rate < 0):
            return End("bound", f"{name} starts on its bound {value:.10g}", {"value": float(value)})
    return None


def _further(problem: Problem) -> list[tuple[str, int, float, float]]:
    """(name, place in z, lowest, highest value) of the parameters behind the first, which is the last unknown."""
    names = problem.parameters
    if not in_two_parameters(problem):
        return []
    walls = problem.walls
    return [(name, *wall) for name, wall in zip(names[: len(walls)][::-1], walls, strict=True)][:-1]
