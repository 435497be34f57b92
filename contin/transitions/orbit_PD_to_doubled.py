"""The orbits of twice the period that leave a family of periodic orbits at a period doubling."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Vector
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.seed import Seed
from contin.machine import elementary
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.transitions.orbits_at_point import in_another, unstable_count
from contin.transitions.registry import Explored, born
from contin.transitions.several_multipliers import refuse_several

CASCADE: Final = Explored(generation=True, cascade=True, crowded=True)


@born(OrbitProblem, "PD", "the orbits of twice the period", explored=CASCADE)
def doubled(problem: OrbitProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the doubled orbits, with any parameter free that moves the point."""
    refuse_several(point, "the families of twice the period are not told apart")
    return [_doubled(*in_another(problem, point, parameter))]


def _doubled(problem: OrbitProblem, point: SpecialPoint) -> Seed:
    profile = problem.profile(point.z)
    n, m = problem.n, problem.points
    sizes = problem.sizes(point.z, point.scale)
    nodes = profile.u.size
    v = (point.vectors["right"][:, 0] * point.scale[:nodes]).reshape(-1, n)
    h = np.tile(profile.h / 2.0, 2)
    u = np.concatenate([profile.u, profile.u[1:] + problem.winding])
    doubled = Profile(m, u, 2.0 * profile.period, h, profile.parameter)
    scale = make_scale(h, m, sizes, 2.0 * float(point.scale[nodes]), float(point.scale[-1]))
    direction = np.zeros(scale.size)
    direction[: u.size] = np.concatenate([v, -v[1:]]).ravel()
    direction /= scale
    direction /= np.linalg.norm(direction)
    intervals = None if problem.intervals is None else len(h)
    family = replace(problem, winding=2.0 * problem.winding, multiple=2 * problem.multiple, intervals=intervals)
    return Seed(
        family, doubled.vector(), direction, None, scale, (1,), Parent.of(point), (HALF_PERIOD,),
        measured=(unstable_count(point), _squared(point.eigenvalues)),
    )  # fmt: skip


def _squared(values: object) -> Vector:
    return elementary.square(np.asarray(values))
