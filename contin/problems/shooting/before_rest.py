"""A march whose steps pass over the equilibrium that a family of shot orbits shrinks to: its last row is before that.

Beyond amplitude zero the same orbits follow again, half a turn on. Where all of a family exists at one parameter, as
the cycles of a linear piece do, steps are as long there as anywhere, and none of their ends need be small.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Frame, Stop
from contin.continuation.settings import Settings
from contin.problems.orbits.hopf_end import TIMES, with_last_row
from contin.problems.shooting.equilibrium_on_surface import TINY
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.renewal import obliqueness
from contin.problems.shooting.sampling import states

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

LEFT: Final = 0.5 * TINY  # extent of the last row: of an orbit that has shrunk, and far above rounding
NEARER: Final = 0.5  # ... or this part of the row's before it


def cut_before_rest(problem: ShotEquations, chunk: Chunk, frame: Frame, settings: Settings) -> Chunk:
    """The chunk up to where the amplitude of its orbits is about to pass zero. Cost: two orbits where the flow at the
    first node turns round, none elsewhere."""
    if not problem.autonomous or problem.winding.any():
        return chunk
    for row in range(len(chunk) - 1):
        z = chunk.z[row + 1]
        if obliqueness(problem, z, Nodes.of(z, problem.n), problem.sizes(z, frame.scale)) >= 0.0:
            continue  # the section keeps its normal in a chunk: half a turn on, the flow passes it backwards
        shape, following = (_deviations(problem, each, frame.scale) for each in chunk.z[row : row + 2])
        near, far = float(np.sum(shape * shape)), float(np.sum(shape * following))
        if not far < 0.0:
            continue
        left = min(LEFT / float(np.ptp(shape, axis=0).max()), NEARER)
        at = float(chunk.lengths[row + 1]) * (1.0 - left) * near / (near - far)
        base = chunk.sample(row)
        found = problem.probe(base, at, base.z + at * frame.scale * base.tangent, frame, settings)
        return chunk if found is None else with_last_row(chunk.cut(row + 2, Stop.LIMIT, chunk.next_step), found)
    return chunk


def _deviations(problem: ShotEquations, z: Array, scale: Array) -> Array:
    """u - mean of u, relative to the states' sizes."""
    u = states(problem, z, TIMES)
    return np.asarray((u - u.mean(axis=0)) / problem.sizes(z, scale))
