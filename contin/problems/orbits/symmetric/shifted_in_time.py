"""The start of a family, shifted in time to be compared with an orbit that the family has come to.

The phase condition of every step refers to the orbit before. Round a closed family the phases need not add up to zero,
so a family comes back to its start with another phase.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Sample, Stop
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile, Transfer
from contin.problems.orbits.symmetric.symmetry import shifted

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

SAMPLES: Final = 256  # of the orbits, for the first guess of the shift
REFINEMENTS: Final = 4
NEAR: Final = 1.5  # steps: distance from the start at which a branch passes it, as in `contin.kernels.steering`


def in_phase(problem: OrbitEquations, start: Sample, near: Array, scale: Array) -> Sample:
    """The start with its time shifted so that it is as close to the orbit `near`, on the same mesh, as it can be."""
    own, other, sizes = problem.profile(start.z), problem.profile(near), problem.sizes(near, scale)
    shift = best_shift(problem, own, other, sizes)
    times = (own.times + shift) % 1.0
    tangent = start.tangent.copy()
    nodes = own.u.size
    raw = (tangent[:nodes] * scale[:nodes]).reshape(-1, own.n)
    tangent[:nodes] = Transfer.to_times(own.m, own.h, times)(raw).ravel() / scale[:nodes]
    z = replace(own, u=shifted(problem, own, shift)).vector()
    return replace(start, z=z, tangent=tangent / np.linalg.norm(tangent))


def apart(problem: OrbitEquations, start: Array, near: Array, scale: Array) -> float:
    """A distance that no shift in time brings two orbits closer than, in the metric of `near`.

    Parameter and period know no phase, nor do mean and standard deviation of a state over the orbit, and a mean square
    of differences is at least the sum of the squares of theirs. Up to the error of quadrature.
    """
    own, other, sizes = problem.profile(start), problem.profile(near), problem.sizes(near, scale)
    gaps = [(own.parameter - other.parameter) / scale[-1], (own.period - other.period) / scale[other.u.size]]
    periodic = np.asarray(problem.winding) == 0.0
    moments = []
    for orbit in (own, other):
        mean = orbit.weights @ orbit.u
        moments.append(np.array([mean, np.sqrt(orbit.weights @ elementary.square(orbit.u - mean))]))
    states = ((moments[0] - moments[1]) / sizes)[:, periodic] / np.sqrt(own.n)
    return float(np.sqrt(np.sum(np.square(gaps)) + np.sum(elementary.square(states))))


def best_shift(problem: OrbitEquations, own: Profile, other: Profile, sizes: Array) -> float:
    """s for which own(x + s) is nearest to other(x) in the mean, in parts of the period."""
    times = np.arange(SAMPLES) / SAMPLES
    drift = times[:, None] * problem.winding
    a, b = ((orbit.at(times) - drift) / sizes for orbit in (own, other))
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    likeness = np.fft.irfft(np.sum(np.fft.rfft(a, axis=0) * np.conj(np.fft.rfft(b, axis=0)), axis=1), SAMPLES)
    shift = float(np.argmax(likeness)) / SAMPLES
    eps = 1e-4
    for _ in range(REFINEMENTS):
        before, here, after = (shifted(problem, own, shift + d) / sizes for d in (-eps, 0.0, eps))
        slope = (after - before) / (2.0 * eps)
        shift -= float(own.weights @ np.sum(slope * (here - other.u / sizes), axis=1)) / max(
            float(own.weights @ np.sum(slope * slope, axis=1)), 1e-300
        )
    return shift


def cut_at_start(problem: OrbitEquations, chunk: Chunk, loop: Sample | None, scale: Array) -> Chunk:
    """The chunk up to the first step in which the family passes its start, whatever its phase there."""
    if loop is None or not problem.autonomous or len(chunk) < 2 or chunk.z.shape[1] != loop.z.size:
        return chunk
    ahead = (chunk.z[:, -1] - loop.z[-1]) * np.sign(loop.tangent[-1])
    for k in np.flatnonzero((ahead[:-1] < 0.0) & (ahead[1:] >= 0.0)):
        step = float(chunk.lengths[k + 1])
        if _passes(lambda z: in_phase(problem, loop, z, scale), chunk.z[k], chunk.z[k + 1], scale, NEAR * step):
            return chunk.cut(int(k) + 2, Stop.LOOP, step)
    return chunk


def _passes(matched: Callable[[Array], Sample], last: Array, here: Array, scale: Array, near: float) -> bool:
    start = matched(here)
    offsets = [(z - start.z) / scale for z in (last, here)]
    moves = [float(start.tangent @ offset) for offset in offsets]
    return moves[0] < 0.0 <= moves[1] and float(np.linalg.norm(offsets[1])) <= near
