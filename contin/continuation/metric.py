"""The metric along a branch: the scale of a state grows with it, and falls where it is too coarse for the rows.

A state outgrows its scale when it exceeds it, unless it was larger all along: then its scale is the length over which
the equations bend, and grows only where the branch moves much farther than that in one chunk.

Of a state that has become much smaller than its scale the angles between tangents say nothing: a step may lead over
two folds. Its own change from row to row does, which the slopes at both rows explain on a curve that is resolved.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Chunk, Sample
from contin.kernels.rows_in_doubt import ROUNDED, SMALL, STAYS, UNEXPLAINED, are_resolved

FAR: Final = 10.0  # scales; a state that grows is rescaled long before
JOURNEY: Final = 20.0  # scales that such a state may move in one chunk


def far_from_zero(z: Array, scale: Array, angle_periods: Array) -> NDArray[np.bool_]:
    """(n,) true for the states, other than angles, whose scale is not their size.

    z and scale are (n + 1,), the parameter last; angle_periods (n,), 0 where a state is no angle.
    """
    n = len(scale) - 1
    return np.asarray((np.abs(z[:-1]) * np.sqrt(n) > FAR * scale[:-1]) & (angle_periods == 0.0))


def travelled(before: Array, after: Array, scale: Array, angle_periods: Array) -> Array | None:
    """The scale after a chunk from `before` to `after` in which a state far from zero moved much, or None."""
    moved = np.abs(after - before)
    moved[-1] = 0.0
    much = np.append(far_from_zero(after, scale, angle_periods), False) & (moved > JOURNEY * scale)
    return np.where(much, moved, scale) if much.any() else None


def outgrown(problem: Problem, z: Array, scale: Array) -> Array:
    """The scale at a point z where a march returned because a state has outgrown its own."""
    angles = problem.angle_periods
    far = ~problem.growing[:-1] if in_two_parameters(problem) else far_from_zero(z, scale, angles)
    grown = scale.copy()
    larger = np.maximum(scale[:-1], np.sqrt(len(scale) - 1) * np.abs(z[:-1]))
    grown[:-1] = np.where(far | (angles > 0.0), scale[:-1], larger)
    return grown


def unresolved(chunk: Chunk, scale: Array, angle_periods: Array, noise: float) -> tuple[int, Array] | None:
    """The first row of a chunk from which a step does not resolve states far below their scales, and finer scales.

    noise : what the corrector leaves in scaled unknowns; smaller changes tell nothing.
    """
    if are_resolved(*map(np.ascontiguousarray, (chunk.z, chunk.tangents)), scale, angle_periods, noise):
        return None
    y, n = chunk.z / scale, len(scale) - 1
    moved, mean = np.diff(y, axis=0), 0.5 * (chunk.tangents[1:] + chunk.tangents[:-1])
    squares = np.maximum(np.sum(mean * mean, axis=1), np.finfo(float).tiny)
    explained = (np.sum(moved * mean, axis=1) / squares)[:, None] * mean
    size, least = (np.sqrt(n) * of(np.abs(y[1:]), np.abs(y[:-1])) for of in (np.maximum, np.minimum))
    change = np.maximum(np.abs(moved), np.abs(explained))
    coarse = (size < SMALL) & (size > ROUNDED) & (y[1:] * y[:-1] > 0.0) & (least > STAYS * size) & (change > noise)
    coarse &= np.abs(moved - explained) > UNEXPLAINED * change
    coarse[:, :n] &= angle_periods == 0.0
    coarse[:, n] = False
    rows = np.flatnonzero(coarse.any(axis=1))
    if not rows.size:
        return None
    row = int(rows[0])
    return row, np.where(coarse[row], scale * size[row], scale)


def measured_in(sample: Sample, old: Array, new: Array) -> Sample:
    """A sample with its unit tangent in another metric."""
    tangent = np.where(sample.tangent == 0.0, 0.0, sample.tangent * (old / new))  # scales of what is no unknown: inf
    return replace(sample, tangent=tangent / np.linalg.norm(tangent))
