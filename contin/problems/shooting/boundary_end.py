"""The end of a family of orbits at an equilibrium that arrives at a surface where the equations jump or have a corner.

An orbit that passes beside it stays ever longer there, as beside a saddle, and the family ends where the equilibrium is
on the surface, from where nothing leaves on its own side (as a biased relay, whose oscillation stops).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.sample import Frame, Sample
from contin.problems.orbits.ends.saddles import equilibria_of
from contin.problems.orbits.march.slow_passage import dwelling, slowest_points
from contin.problems.surfaces.boundary import solved_on_surface
from contin.problems.surfaces.jumps import jumps_of
from contin.systems.described import states_in_words

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

RESTS: Final = 0.3  # part of the period that is spent next to equilibria
NEAR: Final = 1e-2  # distance of the orbit from the boundary equilibrium, relative to the states' sizes, ...
AHEAD: Final = 1e-4  # ... and of the parameter, relative to its range
DIGITS: Final = 12  # of states in words, relative to their sizes


def comes_to_boundary_equilibrium(
    problem: ShotEquations, origin: Sample, frame: Frame, corners: bool = False
) -> End | None:
    """The end in words, beside such a point; corners: also where the equations do not jump."""
    jumps = jumps_of(problem.system) if problem.autonomous and not problem.winding.any() else ()
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    if not jumps or not np.all(np.isfinite(profile.u)) or dwelling(problem, profile, sizes) < RESTS:
        return None
    rest, scale = equilibria_of(problem), np.append(sizes, frame.scale[-1])
    name = problem.parameters[0]
    for u in slowest_points(problem, profile, sizes):
        z = np.append(u, origin.z[-1])
        beside = Sample(z, np.zeros(len(z)), origin.tests, 0, origin.eigenvalues)
        for jump, upper in ((jump, upper) for jump in jumps for upper in (False, True)):
            found = solved_on_surface(rest, jump, upper, beside, Frame(scale), corners)
            if found is None:
                continue
            off = np.abs(found.z - z) / scale
            if off[:-1].max() > NEAR or off[-1] > AHEAD:
                continue
            jumps_there = jump.is_jump(found.z[:-1], rest.full_parameters(found.z))
            at = np.round(found.z[:-1] / sizes, DIGITS) * sizes + 0.0
            text = (
                f"the period grows without bound (here {profile.period:.6g}) towards {name} = {found.z[-1]:.10g}: the "
                f"orbits come to the {'boundary ' * jumps_there}equilibrium ({_in_words(problem, at)}) on the surface "
                f"{jump.surface.text}, where the equations {'jump' if jumps_there else 'have a corner'}"
            )
            data = {"at": {name: float(found.z[-1])}, "error": found.error, "surface": jump.surface.text}
            return End("surface", text, data)
    return None


def _in_words(problem: ShotEquations, u: Array) -> str:
    return states_in_words(problem.system.state_names, u, lambda k: f"= {u[k]:.6g}")
