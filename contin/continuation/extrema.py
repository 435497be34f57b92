"""Extrema (EX) of a parameter or column along a curve: zeros of its derivative by arclength.

The derivative of a column c along the curve is that of c(z) along the tangent, by the five-point difference: of order
four in the step, so that its zero is as good as c itself is (an error of c of 1e-16 moves it by some 1e-13).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.found import Found
from contin.continuation.piece import Row
from contin.continuation.problem import Chunk, Frame, Problem, Sample, Verified
from contin.continuation.settings import Settings
from contin.machine import elementary

STEP = 1e-3  # of the differences (scaled arclength)
ACCURACY = 1e-12  # of the place (scaled arclength)
TURNING = 1e-6  # part of the tangent below which the parameter stands still
EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Extremum:
    """`column` (a varying parameter, a state or an observable) is to be labelled where it turns."""

    column: str

    def slopes(self, problem: Problem, z: Array, tangents: Array, scale: Array) -> Array:
        """dc/ds at rows z with their unit tangents (scaled), (R,)."""
        if self.column == problem.parameters[0]:
            return np.asarray(tangents[:, -1] * scale[-1])
        step = STEP * scale * tangents
        far, near = (self._values(problem, z + k * step) - self._values(problem, z - k * step) for k in (2.0, 1.0))
        return np.asarray((8.0 * near - far) / (12.0 * STEP))

    def _values(self, problem: Problem, z: Array) -> Array:
        return np.asarray(problem.columns(z)[self.column], dtype=float)

    def locate(self, stretch: Stretch, a: Sample, b: Sample) -> Found | None:
        """The extremum between two points of the stretch at which the slopes have different signs."""
        problem, scale = stretch.problem, stretch.frame.scale

        def slope(sample: Sample) -> float:
            return float(self.slopes(problem, sample.z[None], sample.tangent[None], scale)[0])

        rising = slope(a) > 0.0
        a, b = stretch.zero(slope, a, b, ACCURACY)
        near = a if abs(slope(a)) <= abs(slope(b)) else b
        bend = self._bend(stretch, near, slope)
        if bend is None:
            return None
        size = float(np.abs(self._values(problem, near.z[None]))[0])
        noise = EPSILON * size / STEP
        width = stretch.distance(a, b) + (noise / abs(bend) if bend != 0.0 else 0.0)
        rate = float(near.tangent[-1] * scale[-1])
        turning = abs(float(near.tangent[-1])) <= TURNING
        form = {
            "of": self.column,
            "kind": "maximum" if rising else "minimum",
            "curvature": bend if turning else bend / elementary.square(rate),
        }
        error = width * abs(rate) + 0.5 * elementary.square(width) * float(scale[-1]) + EPSILON * abs(float(near.z[-1]))
        residual = abs(slope(near)) / max(size, float(np.abs(bend)), 1e-300)
        point = Verified("EX", near.z, residual, error, near.eigenvalues, near.unstable, form)
        return Found(stretch.length_of(near), point, near)

    def _bend(self, stretch: Stretch, at: Sample, slope: Callable[[Sample], float]) -> float | None:
        """d^2 c/ds^2 by the five-point difference of the slopes; None where the curve cannot be followed there."""
        values = []
        for side in (-2.0 * STEP, -STEP, STEP, 2.0 * STEP):
            guess = at.z + side * stretch.frame.scale * at.tangent
            sample = stretch.problem.probe(at, side, guess, stretch.frame, stretch.settings)
            if sample is None:
                return None
            values.append(slope(sample))
        return float((8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * STEP))


def turns(
    extrema: Sequence[Extremum], problem: Problem, chunk: Chunk, rows: int, frame: Frame, settings: Settings
) -> Iterator[Row]:
    """Extrema between consecutive rows of a chunk, the first `rows` of it."""
    z, tangents = chunk.z[:rows], chunk.tangents[:rows]
    for extremum in extrema:
        slopes = extremum.slopes(problem, z, tangents, frame.scale)
        for row in np.flatnonzero(slopes[:-1] * slopes[1:] < 0.0).tolist():
            a, b = chunk.sample(row), chunk.sample(row + 1)
            found = extremum.locate(Stretch(problem, a, frame, settings), a, b)
            if found is not None:
                yield Row(row + 1, found.length, found.point, found.sample.tangent)
