"""The end of a family at an orbit that touches a surface where the equations jump (a grazing bifurcation).

Where the equations jump, orbits that cross the surface need not be near those that do not, and the family may have no
continuation: Newton's method fails beside the orbit that touches.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.branch import End
from contin.continuation.sample import Sample
from contin.problems.shooting.grazing import SAMPLES, clearance, surfaces

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

TOUCHES: Final = 1e-6  # of how far h changes along the orbit: one that comes that near touches


def comes_to_graze(problem: ShotEquations, origin: Sample) -> End | None:
    """The end in words where the corrector has failed beside an orbit that touches a surface."""
    if not problem.system.n_switches:
        return None
    heights = surfaces(problem, origin.z, np.arange(SAMPLES) / SAMPLES)
    for j, height in enumerate(heights.T):
        if not np.isfinite(height).all():
            return None
        if clearance(problem, origin.z, [j]) < TOUCHES * float(np.ptp(height)):
            name, value = problem.parameters[0], float(origin.z[-1])
            where = problem.system.pieces.name(j)
            text = f"at {name} = {value:.10g} the orbit touches the surface {where}"
            text += ": beyond, it would cross it, and no orbit that does was found beside it"
            return End("grazing", text, {"at": {name: value}, "surface": where})
    return None
