"""How far two orbits that were shot are apart, whatever their phases.

Each has a section of its own, and a plane may be met by one orbit twice; so nodes of the one are compared with points
of the other at times that are shifted alike: as the first node is nearest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.sampling import states

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

SAMPLES: Final = 256  # of the other orbit, where the nearest point is begun with
REFINED: Final = 4  # steps to the nearest point, each of which squares what is left


def apart_in_time(problem: ShotFamily, one: Array, other: Array, sizes: Array) -> Array:
    """(M, n + 1) nodes of `one` less the orbit `other`, and their periods'; NaN where that is not followed round.

    sizes : (n,) of the states.  Cost: as many trajectories round the orbit as there are refinements, and two more.
    """
    nodes, period = Nodes.of(one, problem.n), Nodes.of(other, problem.n).period
    times = np.arange(SAMPLES) / SAMPLES
    gaps = (nodes.u[0] - states(problem, other, times)) / sizes
    far = np.where(np.isnan(gaps).any(axis=1), np.inf, np.sum(elementary.square(gaps), axis=1))
    shift, p = float(times[np.argmin(far)]), problem.full_parameters(other)
    for _ in range(REFINED):
        u = _at(problem, other, np.array([shift]))
        speed = period * problem.system.values(u, p)[0] / sizes
        if not float(speed @ speed) > 0.0:  # NaN where the trajectory does not get there
            return np.full((nodes.count, problem.n + 1), np.nan)
        shift += float(speed @ ((nodes.u[0] - u[0]) / sizes)) / float(speed @ speed)
    if not np.isfinite(shift):
        return np.full((nodes.count, problem.n + 1), np.nan)
    apart = nodes.u - _at(problem, other, shift + np.arange(nodes.count) / nodes.count)
    return np.column_stack([apart, np.full(nodes.count, nodes.period - period)])


def _at(problem: ShotFamily, orbit: Array, times: Array) -> Array:
    """States at scaled times, in any period."""
    turns = np.floor(times)
    return states(problem, orbit, times - turns) + turns[:, None] * problem.winding
