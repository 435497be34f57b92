"""The families that are born on a family of orbits of a large system: crossing ones, and doubled ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.linalg.vectors import norm
from contin.problems.large_orbits.branch_points import null_vector
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.large_orbit_equations import Memory
from contin.transitions.registry import Explored, born
from contin.transitions.several_multipliers import refuse_several


@born(LargeOrbitProblem, "BPC", "the family that crosses", explored=Explored(orbits=True))
def crossing(problem: LargeOrbitProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The family that crosses, along the null vector that is not the own tangent."""
    refuse_several(point, "the families that cross there are not told apart")
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    problem = replace(problem, memory=Memory())
    q, own = np.asarray(point.vectors["q"]), np.asarray(point.vectors["own"])
    direction = null_vector(problem, point.z, q, own, point.scale)
    measured = int(point.values["unstable"]), point.eigenvalues
    parent = Parent.of(point)
    return [Seed(problem, point.z, direction, None, point.scale, parent=parent, measured=measured)]


@born(LargeOrbitProblem, "PD", "the doubled orbits", explored=Explored(orbits=True))
def doubled(problem: LargeOrbitProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Orbits of twice the period, along the vector that changes its sign in one."""
    refuse_several(point, "the families of twice the period are not told apart")
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    sweeps, q = problem.sweeps(point.z), np.real(point.vectors["q"])
    assert sweeps is not None
    once = problem.layout.pick(sweeps.along(q), q, None)
    twice = problem.with_layout(problem.layout.doubled())
    states, period = point.z[:-2], float(point.z[-2])
    z = np.concatenate([states, states, [2.0 * period, point.z[-1]]])
    size = float(point.scale[0]) / np.sqrt(len(point.scale) - 2)
    scale = twice.scale_of(size, np.array([2.0 * point.scale[-2], point.scale[-1]]))
    direction = np.concatenate([once, -once, [0.0, 0.0]]) / scale
    parent = Parent.of(point)
    measured = int(point.values["unstable"]), point.eigenvalues**2
    return [Seed(twice, z, direction / norm(direction), None, scale, (1,), parent, measured=measured)]
