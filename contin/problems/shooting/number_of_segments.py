"""How many segments an orbit is shot in: as many as keep perturbations in each from growing too much."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sampling import states
from contin.problems.shooting.segments import Segments

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

GROWTH = 1e3  # of perturbations in a segment, above which more segments are taken
MOST = 64


def enough(problem: ShotFamily, z: Array) -> int:
    """As many segments as keep perturbations in each from growing by more than GROWTH."""
    count = 1
    while count < MOST:
        segments = Segments.of(replace(problem, count=count), split(problem, z, count))
        if segments is None or float(np.abs(segments.transitions).max()) < GROWTH:
            break
        count *= 2
    return count


def split(problem: ShotFamily, z: Array, count: int) -> Array:
    """The same orbit with another number of segments."""
    nodes = Nodes.of(z, problem.n)
    if nodes.count == count:
        return z
    one = replace(problem, count=nodes.count)
    return replace(nodes, u=states(one, z, np.arange(count) / count)).vector()
