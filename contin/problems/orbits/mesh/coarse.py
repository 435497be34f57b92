"""Whether a family of orbits was followed on a mesh that is too coarse for its columns, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.problems.orbits.mesh.adaption import estimate
from contin.problems.orbits.mesh.layout import trimmed

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

TOLD: Final = 1e-3  # error inside an interval, relative to the states' sizes: extremes may be off by ten times as much
LOOKED: Final = 12  # rows that are looked at


def remark(problem: OrbitEquations, z: Array) -> str:
    """A note on rows z (K, N) whose orbits their mesh does not resolve; else empty."""
    worst, where, count = 0.0, 0.0, 0
    for k in np.unique(np.linspace(0, len(z) - 1, LOOKED).astype(int)):
        profile = problem.profile(trimmed(z[k]))
        error = estimate(profile, problem.state_sizes(profile))[0]
        if error > worst:
            worst, where, count = error, profile.parameter, profile.intervals
    if not worst > TOLD:
        return ""
    return (
        f"the mesh of {count} intervals is coarse: between its points orbits are known to about {worst:.0e} of their "
        f"size near {problem.parameters[0]} = {where:.6g}, and columns and labels may be off by several times as much; "
        "write more `intervals` in `settings`"
    )
