"""User values (UZ): a parameter or a column at a wanted value, hit exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.extrema import Extremum
from contin.continuation.location.found import Note
from contin.continuation.location.touched import touched, turning_points
from contin.continuation.location.turning import turns
from contin.continuation.location.user_value import Sought, Target
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, opposite
from contin.continuation.segment import Row
from contin.continuation.settings import Settings

Wanted: TypeAlias = Sought | Extremum


def hits(
    wanted: Sequence[Wanted], problem: Problem, chunk: Chunk, z: Array, frame: Frame, settings: Settings,
    marked: Sequence[Row],
) -> Iterator[Row | Note]:  # fmt: skip
    """User values crossed between consecutive points of a chunk: rows (z: without the first) and labelled points.

    And extrema between its rows.
    """
    if not wanted or len(chunk) < 2:
        return
    extrema = [target for target in wanted if isinstance(target, Extremum)]
    yield from turns(extrema, problem, chunk, len(z) + 1, frame, settings)
    targets = [target for target in wanted if not isinstance(target, Extremum)]
    yield from touched([t for t in targets if isinstance(t, Target)], problem, chunk, len(z) + 1, frame, settings)
    rows = np.vstack([chunk.z[:1], z])
    order: list[tuple[int, float, Array]] = [(k, -np.inf, row) for k, row in enumerate(rows)]
    order += [(mark.before, mark.length, mark.point.z) for mark in marked]
    order.sort(key=lambda item: (item[0] - (item[1] != -np.inf), item[1]))
    points = np.array([item[2] for item in order])
    owner = np.array([item[0] if item[1] == -np.inf else item[0] - 1 for item in order])
    for target in targets:
        values = target.values(problem, points) - target.value
        for i in np.flatnonzero(opposite(values[:-1], values[1:]) | (values[1:] == 0.0)):
            row = int(owner[i])
            stretch = Stretch(problem, chunk.sample(row), frame, settings)
            ends = [points[i], *_turns_between(target, stretch, chunk, row, (points[i], points[i + 1])), points[i + 1]]
            for z_a, z_b in pairwise(ends):
                if len(ends) > 2 and not _crossed(target, problem, z_a, z_b):
                    continue
                found = target.locate(stretch, z_a, z_b)
                if found is not None:
                    yield Row(row + 1, found.length, found.point, found.sample.tangent)


def _turns_between(
    target: Sought, stretch: Stretch, chunk: Chunk, row: int, ends: tuple[Array, Array]
) -> list[Array]:
    """Points at which a column turns on the way between two points of a step, across the value all the same."""
    problem = stretch.problem
    if not isinstance(target, Target) or target.column == problem.parameters[0]:
        return []
    low, high = sorted(float(stretch.base.tangent @ ((z - stretch.base.z) / stretch.frame.scale)) for z in ends)
    turning = turning_points(target.column, problem, chunk, row, stretch.frame, stretch.settings)
    return [z for length, z in turning if low < length < high]


def _crossed(target: Sought, problem: Problem, z_a: Array, z_b: Array) -> bool:
    before, after = (target.values(problem, np.array([z_a, z_b])) - target.value).tolist()
    return bool(opposite(before, after) or after == 0.0)
