"""The metric along a branch: the scale of a state grows with it.

A state outgrows its scale when it exceeds it, unless it was larger all along: then its scale is the length over which
the equations bend, and grows only where the branch moves much farther than that in one chunk.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Sample

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


def measured_in(sample: Sample, old: Array, new: Array) -> Sample:
    """A sample with its unit tangent in another metric."""
    tangent = np.where(sample.tangent == 0.0, 0.0, sample.tangent * (old / new))  # scales of what is no unknown: inf
    return replace(sample, tangent=tangent / np.linalg.norm(tangent))
