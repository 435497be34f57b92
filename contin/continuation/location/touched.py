"""User values that a column takes several times within one step, or touches: its rows show one of them, or none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.extrema import Extremum
from contin.continuation.location.found import Found, Note
from contin.continuation.location.turning import between, suspicious
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.segment import Row
from contin.continuation.settings import Settings

if TYPE_CHECKING:
    from contin.continuation.location.user_value import Target

TOUCHING: Final = 8 * float(np.finfo(float).eps)  # of the column's size: an extremum this near to a value touches it


def touched(
    targets: Sequence[Target], problem: Problem, chunk: Chunk, rows: int, frame: Frame, settings: Settings
) -> Iterator[Row]:
    """The values of columns met next to an extremum between rows of a chunk, the first `rows` of it.

    Of the varying parameter there are none: where it turns there is a label, which is looked at with the rows.
    """
    for target in targets:
        if target.column == problem.parameters[0]:
            continue
        values = target.values(problem, chunk.z[:rows]) - target.value
        for row in _nearest(values):
            a, b = chunk.sample(row), chunk.sample(row + 1)
            for found in _met(target, Stretch(problem, a, frame, settings), a, b):
                yield Row(row + 1, found.length, found.point, found.sample.tangent)


def turning_points(
    column: str, problem: Problem, chunk: Chunk, row: int, frame: Frame, settings: Settings
) -> list[tuple[float, Array]]:
    """Where a column turns between two rows of a chunk: lengths and points, in order; between them it is monotone."""
    extremum, rows = Extremum(column), slice(row, row + 2)
    if not len(suspicious(extremum, problem, chunk.z[rows], chunk.tangents[rows], frame)):
        return []
    a, b = chunk.sample(row), chunk.sample(row + 1)
    found = between(extremum, Stretch(problem, a, frame, settings), a, b)
    return [(item.length, item.point.z) for item in found if isinstance(item, Found)]


def _nearest(values: np.ndarray) -> list[int]:
    """The steps on one side of the value that begin or end at the row that is nearest to it."""
    size = np.abs(values)
    padded = np.concatenate([[np.inf], size, [np.inf]])
    low = np.flatnonzero((size <= padded[:-2]) & (size <= padded[2:]) & (size > 0.0))
    steps = sorted({k for row in low.tolist() for k in (row - 1, row) if 0 <= k < len(values) - 1})
    return [k for k in steps if values[k] * values[k + 1] > 0.0]


def _met(target: Target, stretch: Stretch, a: Sample, b: Sample) -> Iterator[Found]:
    extremum = Extremum(target.column)
    side = float(target.values(stretch.problem, a.z[None])[0]) - target.value
    rounding = TOUCHING * max(abs(target.value), abs(side))
    if extremum.slope(stretch, a) * side >= 0.0 or extremum.slope(stretch, b) * side <= 0.0:
        return  # it does not come nearer to the value and leave it again
    previous = a
    for found in between(extremum, stretch, a, b):
        if isinstance(found, Note):
            continue
        beyond = float(target.values(stretch.problem, found.point.z[None])[0]) - target.value
        if abs(beyond) <= rounding:
            near, bend = found.point, abs(float(found.point.normal_form["curvature"]))
            error = near.error + (float(np.sqrt(2.0 * rounding / bend)) if bend > 0.0 else 0.0)
            point = Verified("UZ", near.z, abs(beyond), error, near.eigenvalues, near.unstable)
            yield Found(found.length, point, found.sample)
        elif beyond * side < 0.0:
            for ends in ((previous, found.sample), (found.sample, b)):
                hit = target.locate(stretch, ends[0].z, ends[1].z)
                if hit is not None:
                    yield hit
        previous = found.sample
