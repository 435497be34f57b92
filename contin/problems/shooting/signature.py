"""The surfaces that an orbit of a piecewise-smooth flow crosses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.shooting.sampling import flights

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

TOGETHER = 1e-6  # of the period: crossings this close have no order


def signature(problem: ShotFamily, z: Array) -> tuple[int, ...] | None:
    """The surfaces crossed in a period, in order (crossings at one time sorted); None where a trajectory fails.

    None also where z has no period: beyond a family that shrinks to a point, Newton's method arrives at T <= 0.
    """
    period = float(z[-problem.n - 3])
    if not period > 0.0:
        return None
    found = flights(problem, z, np.empty(0))
    if any(f.outcome != "done" for f in found):
        return None
    crossings = np.vstack([f.crossings for f in found])
    surfaces: list[int] = []
    group: list[int] = []
    before = -np.inf
    for time, surface in crossings:
        if time - before > TOGETHER * period:
            surfaces += sorted(group)
            group = []
        group.append(int(surface))
        before = float(time)
    return tuple(surfaces + sorted(group))
