"""The orbits of twice the period at a period doubling of orbits found by shooting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.machine import elementary
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.transitions.orbit_PD_to_doubled import CASCADE
from contin.transitions.orbits_at_point import in_another, unstable_count
from contin.transitions.registry import born
from contin.transitions.several_multipliers import refuse_several


@born(ShootingProblem, "PD", "the orbits of twice the period", explored=CASCADE)
def doubled_by_shooting(problem: ShootingProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the doubled orbits, with any parameter free that moves the point."""
    refuse_several(point, "the families of twice the period are not told apart")
    return [_doubled(*in_another(problem, point, parameter))]


def _doubled(problem: ShootingProblem, point: SpecialPoint) -> Seed:
    """The doubled orbits: twice the segments, along the eigenvector v of the multiplier -1.

    (v, -v) and a shift in time, (f, f), solve the linear equations; their sum keeps the first node on its plane.
    """
    nodes, n = Nodes.of(point.z, problem.n), problem.n
    segments = problem.segments(point.z)
    assert segments is not None  # the orbit was just computed
    monodromy = np.eye(n)
    for matrix in segments.transitions:
        monodromy = matrix @ monodromy
    values, vectors = np.linalg.eig(monodromy)
    v = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    moved = [v]
    for matrix in segments.transitions[:-1]:
        moved.append(matrix @ moved[-1])
    half = np.array(moved)
    u = np.vstack([nodes.u, nodes.u + problem.winding])
    doubled = replace(nodes, u=u, period=2.0 * nodes.period)
    sizes = problem.sizes(point.z, point.scale)
    scale = make_scale(sizes, 2 * nodes.count, 2.0 * float(point.scale[-n - 3]), float(point.scale[-1]))
    direction = np.zeros(len(scale))
    along = _in_phase(problem, point, nodes, v)
    direction[: u.size] = np.vstack([half + along, along - half]).ravel() / scale[: u.size]
    direction /= np.linalg.norm(direction)
    free, multiple = problem.free(), 2 * problem.multiple
    family = replace(free, count=2 * nodes.count, winding=2.0 * problem.winding, multiple=multiple)
    return Seed(
        family, doubled.vector(), direction, None, scale, (1,), Parent.of(point),
        measured=(unstable_count(point), elementary.square(np.asarray(point.eigenvalues))),
    )  # fmt: skip


def _in_phase(problem: ShootingProblem, point: SpecialPoint, nodes: Nodes, v: Array) -> Array:
    """The shift in time, at the nodes (M, n), that brings u_1 + v back to the plane of the phase; 0 if forced."""
    if not np.any(nodes.normal):
        return np.zeros_like(nodes.u)
    p = problem.full_parameters(point.z)
    flow = np.array([problem.system.value(u, p) for u in nodes.u])
    return -float(nodes.normal @ v) / float(nodes.normal @ flow[0]) * flow
