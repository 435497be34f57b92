"""User values (UZ): a parameter or a column at a wanted value, hit exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeAlias

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.extrema import Extremum
from contin.continuation.location.found import Note
from contin.continuation.location.touched import touched
from contin.continuation.location.turning import turns
from contin.continuation.location.user_value import Sought, Target
from contin.continuation.problem import Chunk, Frame, Problem
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
        for i in np.flatnonzero((values[:-1] * values[1:] < 0.0) | (values[1:] == 0.0)):
            row = int(owner[i])
            found = target.locate(Stretch(problem, chunk.sample(row), frame, settings), points[i], points[i + 1])
            if found is not None:
                yield Row(row + 1, found.length, found.point, found.sample.tangent)
