"""The end of a family of piecewise-smooth orbits whose period diverges at an equilibrium on a switching surface.

The two sides' linear parts there differ: the orbit comes in by one of them and goes out by the other, so there is no
saddle whose eigenvalues would tell how the period grows. What is seen is that the parameter stands while the orbit
spends nearly all its time next to one point of the surface.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.sample import Frame, Sample
from contin.model.printing import to_text
from contin.problems.orbits.march.slow_passage import dwelling, slowest_points
from contin.problems.shooting.boundary_end import comes_to_boundary_equilibrium

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

STANDS: Final = 1e-6  # part of the tangent in the parameter's direction below which the parameter does not change
RESTS: Final = 0.5  # part of the period that is spent next to equilibria
NEXT_TO: Final = 1e-2  # distance from the surface, in the states' sizes
STEP: Final = 1e-6  # of the states' sizes, to tell how fast a surface's function changes


def comes_to_surface(problem: ShotEquations, origin: Sample, frame: Frame) -> End | None:
    """The end in words; None where the family goes on."""
    if not problem.system.n_switches or abs(float(origin.tangent[-1])) > STANDS:
        return None
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    if not np.all(np.isfinite(profile.u)) or dwelling(problem, profile, sizes) < RESTS:
        return None
    solved = comes_to_boundary_equilibrium(problem, origin, frame, corners=True)
    if solved is not None:
        return solved
    p = problem.full_parameters(origin.z)
    for u in slowest_points(problem, profile, sizes):
        surface = _surface_next_to(problem, u, p, sizes)
        if surface is not None:
            where = ", ".join(f"{s} = {v:.6g}" for s, v in zip(problem.system.state_names, u, strict=False))
            name, value = problem.parameters[0], float(origin.z[-1])
            text = (
                f"the period grows without bound (here {profile.period:.6g}) near {name} = {value:.6g}: the orbits "
                f"come to an equilibrium near ({where}), on the surface {surface} = 0 where the equations have a corner"
            )
            return End("surface", text, {"at": {name: value}})
    return None


def _surface_next_to(problem: ShotEquations, u: Array, p: Array, sizes: Array) -> str | None:
    """The switching function that vanishes next to u, as it is written."""
    system = problem.system
    beside = u + STEP * np.diag(sizes)
    values = np.asarray(system.switches(u, p))
    change = np.abs(np.array([system.switches(row, p) for row in beside]) - values).sum(axis=0) / STEP
    near = np.flatnonzero(np.abs(values) <= NEXT_TO * change)
    return to_text(system.switching[int(near[0])]) if near.size else None
