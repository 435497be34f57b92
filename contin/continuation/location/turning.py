"""Where a column turns between the rows of a chunk, and at a branch's start: every extremum of a step, not one.

Between two rows the slope dc/ds of a column has one zero, or none, or several. Two are seen by the parabola through
both slopes whose mean is the column's own change; three by slopes of the wrong sign next to the first zero found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.extrema import STEP, Extremum
from contin.continuation.location.found import Found, Note
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.segment import Row
from contin.continuation.settings import Settings

LOW: Final = 0.5  # of the smaller slope at a step's ends: a parabola that falls below it is looked at
LOOKS: Final = 6  # at the lowest slope of such a step
NEXT: Final = (0.0035, 0.0055, 0.009, 0.014, 0.023, 0.037, 0.06, 0.095, 0.15, 0.24, 0.39, 0.62)
# of the way from an extremum to the step's ends: closer than 2 to 1, so that of three equally far apart none is passed

Bracket = tuple[Sample, Sample]


def turns(
    extrema: Sequence[Extremum], problem: Problem, chunk: Chunk, rows: int, frame: Frame, settings: Settings
) -> Iterator[Row | Note]:
    """Extrema between consecutive rows of a chunk, the first `rows` of it; notes where one could not be verified."""
    for extremum in extrema:
        steps = suspicious(extremum, problem, chunk.z[:rows], chunk.tangents[:rows], frame).tolist()
        if steps and extremum.is_constant(problem, chunk, rows, frame, settings):
            continue  # slopes have the signs of rounding, in any of the steps
        for row in steps:
            a, b = chunk.sample(row), chunk.sample(row + 1)
            stretch = Stretch(problem, a, frame, settings)
            for found in between(extremum, stretch, a, b):
                if isinstance(found, Note):
                    yield found
                else:
                    yield Row(row + 1, found.length, found.point, found.sample.tangent)


def between(extremum: Extremum, stretch: Stretch, a: Sample, b: Sample) -> list[Found | Note]:
    """All extrema between two points of the stretch, in order; notes in place of those that could not be verified."""
    slopes = extremum.slope(stretch, a), extremum.slope(stretch, b)
    brackets = [(a, b)] if slopes[0] * slopes[1] <= 0.0 else _pair(extremum, stretch, (a, b), slopes)
    return [item for bracket in brackets for item in _all_of(extremum, stretch, *bracket)]


def _all_of(extremum: Extremum, stretch: Stretch, a: Sample, b: Sample) -> list[Found | Note]:
    """The extrema between two points at which the slopes have different signs: one, or three and more."""
    near, width = extremum.zero(stretch, a, b)
    before = [s for s in stretch.several(near, a, NEXT) if s is not None][::-1]
    after = [s for s in stretch.several(near, b, NEXT) if s is not None]
    samples = [a, *before, *after, b]
    z, tangents = (np.array(rows) for rows in zip(*((s.z, s.tangent) for s in samples), strict=True))
    rising = extremum.slopes(stretch.problem, z, tangents, stretch.frame.scale) > 0.0
    if a is near or b is near:  # the slope vanishes at a row
        rising[0 if a is near else -1] = rising[1 if a is near else -2]
    ends = np.flatnonzero(rising[1:] != rising[:-1]).tolist()  # of runs with one sign
    found = []
    for k, last in enumerate(ends):
        first, beyond = ends[k - 1] + 1 if k else 0, ends[k + 1] if k + 1 < len(ends) else len(samples) - 1
        if len(ends) > 1:
            near, width = extremum.zero(stretch, samples[last], samples[last + 1])
        found.append(extremum.verified(stretch, near, width, (samples[first], samples[beyond]), bool(rising[last])))
    return [item for item in found if item is not None]


def suspicious(extremum: Extremum, problem: Problem, z: Array, tangents: Array, frame: Frame) -> np.ndarray:
    """The steps between rows z in which the slope changes its sign, or may do so twice."""
    rows = len(z)
    slopes = extremum.slopes(problem, z, tangents, frame.scale)
    values = extremum.values(problem, z)
    a, b = slopes[:-1], slopes[1:]
    noise = extremum.rounding(problem, z[int(np.argmax(np.abs(values)))], frame.scale) / STEP
    real = np.maximum(np.abs(a), np.abs(b)) > noise
    changes = a * b < 0.0
    # A slope that is exactly zero at a row is an extremum there where the slopes beyond it have the other sign.
    after = np.append(slopes[2:], 0.0) if rows > 1 else np.empty(0)
    changes |= (b == 0.0) & (a != 0.0) & (a * after <= 0.0)
    length = np.linalg.norm((z[1:] - z[:-1]) / frame.scale, axis=1)
    lowest = _lowest(a, b, (values[1:] - values[:-1]) / np.maximum(length, 1e-300))[1]
    dips = (a * b > 0.0) & (lowest < LOW * np.minimum(np.abs(a), np.abs(b)))
    return np.flatnonzero(real & (changes | dips))


def _lowest(a: np.ndarray, b: np.ndarray, mean: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where between 0 and 1 the parabola through slopes a and b with this mean is lowest, and how low, towards zero.

    The parabola is a + (b - a) t + k t (1 - t) with k = 6 (mean - (a + b)/2); signs are such that a > 0.
    """
    sign = np.where(a < 0.0, -1.0, 1.0)
    a, b, mean = sign * a, sign * b, sign * mean
    k = 6.0 * (mean - 0.5 * (a + b))
    bent = k < 0.0
    t = np.clip(np.where(bent, 0.5 + 0.5 * (b - a) / np.where(bent, k, 1.0), 0.0), 0.0, 1.0)
    return t, np.where(bent, a + (b - a) * t + k * t * (1.0 - t), np.minimum(a, b))


def _pair(extremum: Extremum, stretch: Stretch, ends: Bracket, slopes: tuple[float, float]) -> list[Bracket]:
    """The two halves of a step at whose ends slopes have one sign, if they have the other one between."""
    a, b = ends
    sign, (s_a, s_b) = (1.0 if slopes[0] > 0.0 else -1.0), (stretch.length_of(a), stretch.length_of(b))
    values = extremum.values(stretch.problem, np.array([a.z, b.z]))
    mean = (values[1] - values[0]) / max(stretch.distance(a, b), 1e-300)
    t = [0.0, 1.0]
    heights = [sign * slopes[0], sign * slopes[1]]
    ahead = float(_lowest(np.array(slopes[0]), np.array(slopes[1]), np.array(mean))[0])
    for _ in range(LOOKS):
        if min(abs(ahead - known) for known in t) < 1e-6:
            return []
        sample = stretch.between(a, b, ahead)
        if sample is None or s_a == s_b:
            return []
        height = sign * extremum.slope(stretch, sample)
        if height <= 0.0:
            return [(a, sample), (sample, b)]
        t.append(ahead)
        heights.append(height)
        near = sorted(np.argsort(heights)[:3], key=lambda k: t[k])
        fit = np.polyfit([t[k] for k in near], [heights[k] for k in near], 2)
        if fit[0] <= 0.0 or height > LOW * min(heights[0], heights[1]):
            return []
        ahead = float(np.clip(-0.5 * fit[1] / fit[0], 0.0, 1.0))
    return []
