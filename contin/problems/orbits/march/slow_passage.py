"""Where orbits move slowly. In the frame that turns with the state what counts is the change of shape.

A frame (`symbolic.passes.corotating`) keeps up with the state at a rate of its own, which has no meaning: the motion
along the rotation is left out of the speed, and the eigenvalue along it is none of a saddle's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

SLOW = 0.05  # speed relative to the mean below which an orbit dwells
ALONG = 1e-6  # relative residual to which the rotation is an eigenvector of a relative equilibrium


def turning(problem: FamilyOfOrbits, u: Array) -> Array | None:
    """Directions (K, n) in which the frame turns the states u (K, n); None where the model is in none."""
    matrix = problem.turning
    return None if matrix is None else np.asarray(u @ matrix.T)


def speeds(problem: FamilyOfOrbits, profile: Profile, sizes: Array) -> tuple[Array, float, Array]:
    """Speed between neighbouring nodes, in states relative to their sizes, its mean over the (scaled) period, and the
    times from node to node."""
    steps = (profile.u[1:] - profile.u[:-1]) / sizes
    along = None if problem.turning is None else turning(problem, 0.5 * (profile.u[1:] + profile.u[:-1]))
    if along is not None:
        along = along / sizes
        squares = np.maximum(np.sum(along * along, axis=1), np.finfo(float).tiny)
        steps = steps - (np.sum(steps * along, axis=1) / squares)[:, None] * along
    times = profile.times
    lengths, spans = np.sqrt(np.einsum("ij,ij->i", steps, steps)), times[1:] - times[:-1]
    return lengths / spans, float(lengths.sum()), spans


def dwelling(problem: FamilyOfOrbits, profile: Profile, sizes: Array) -> float:
    """Part of the period during which the orbit moves at less than a twentieth of its mean speed."""
    _, _, spans = speeds(problem, profile, sizes)
    return float(spans[slow_intervals(problem, profile, sizes)].sum())


def slow_intervals(problem: FamilyOfOrbits, profile: Profile, sizes: Array) -> NDArray[np.bool_]:
    """Between which nodes the orbit moves at less than a twentieth of its mean speed."""
    speed, mean, _ = speeds(problem, profile, sizes)
    return np.asarray(speed < SLOW * mean)


def slowest_points(problem: FamilyOfOrbits, profile: Profile, sizes: Array) -> list[Array]:
    """The slowest node of every stretch of the orbit (a closed curve) that is passed slowly."""
    speed, mean, _ = speeds(problem, profile, sizes)
    slow = speed < SLOW * mean
    if slow.all() or not slow.any():
        return []
    first = int(np.argmin(slow))  # begin on a fast stretch
    order = np.roll(np.arange(len(speed)), -first)
    points: list[Array] = []
    run: list[int] = []
    for k in [*order.tolist(), int(order[0])]:
        if slow[k] and not (run and k == order[0]):
            run.append(k)
        elif run:
            points.append(profile.u[min(run, key=lambda j: speed[j])])
            run = []
    return points


def of_the_frame(problem: FamilyOfOrbits, u: Array, jacobian: Array, values: NDArray[np.complex128]) -> int | None:
    """Index among the eigenvalues of an equilibrium u of the one that belongs to the frame, or None."""
    along = turning(problem, u[None])
    if along is None or not along.any():
        return None
    xi = along[0] / np.linalg.norm(along[0])
    image = jacobian @ xi
    value = float(xi @ image)
    if np.linalg.norm(image - value * xi) > ALONG * np.linalg.norm(jacobian):
        return None
    return int(np.argmin(np.abs(values - value)))
