"""The other branches through a branch point of a boundary-value problem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.kernel_at_branch_point import smallest
from contin.bvp.on_mesh import OnMesh
from contin.bvp.several_modes import reduced_to_kernel
from contin.bvp.special_points import embedded, reduction
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import make_scale
from contin.transitions.oriented import oriented
from contin.transitions.registry import Explored, born

PARALLEL = 0.9999  # cosine from which a direction is the branch's own
OWN = 0.9  # cosine that the nearest direction has at least, where the branch's own is among them


@born(BoundaryProblem, "BP", "the branches that cross", explored=Explored())
def crossing(problem: BoundaryProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The seeds of the branches that cross the point's own there, with tangents and curvatures.

    One, or where several modes vanish at once all of them.
    """
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    mesh = OnMesh(problem, problem.profile(point.z).h)
    x = mesh.unknowns(point.z)
    own = mesh.unknowns(point.tangent / point.scale)
    own /= norm(own)
    scale = mesh.unknowns(point.scale)
    curves = _through(mesh, x, own, scale, point)
    cosines = np.array([abs(float((d / scale) @ own)) / norm(d / scale) for d, _ in curves])
    several = int(point.normal_form.get("branches", 1)) > 1
    chosen = _others(cosines) if several else [int(np.argmin(cosines))] if curves else []
    if not len(chosen):
        raise InputError(f"{point.branch}.{point.label}: no second real branch crosses here")
    return [_seed(problem, point, mesh, oriented(curves[i][0], scale), curves[i][1]) for i in chosen]


def _others(cosines: Array) -> list[int]:
    """Which of several directions are not the branch's own; its tangent is rough where several modes vanish."""
    own = int(np.argmax(cosines)) if cosines.size and cosines.max() > OWN else -1
    return [k for k in range(len(cosines)) if k != own and cosines[k] < PARALLEL]


def _through(mesh: OnMesh, x: Array, own: Array, scale: Array, point: SpecialPoint) -> list[tuple[Array, Array]]:
    """First and second derivatives (raw) of the branches through x.  own : tangent of one of them, scaled."""
    try:
        if int(point.normal_form.get("branches", 1)) > 1:
            jet = reduced_to_kernel(mesh, x, own, scale, smallest(mesh, x), point.error or 0.0)
            if jet is not None:
                return jet.branches()
        return list(reduction(mesh, x, own, scale)[0].crossing(x))
    except ArithmeticError as failure:
        raise InputError(f"{point.branch}.{point.label}: {failure}") from failure


def _seed(problem: BoundaryProblem, point: SpecialPoint, mesh: OnMesh, direction: Array, bend: Array) -> Seed:
    """The branch x + s direction + s^2 bend / 2."""
    metric = _metric(problem, point, mesh, direction, bend)
    d, c = direction / metric, bend / metric
    length = norm(d)
    d, c = d / length, c / elementary.square(length)
    c = c - float(c @ d) * d
    flat = np.zeros(len(mesh.h) + 1)
    curvature = np.concatenate([c[:-1], flat, c[-1:]])
    full = np.concatenate([metric[:-1], [1.0], np.ones(len(mesh.h)), metric[-1:]])
    return Seed(replace(problem, spaces={}), point.z.copy(), embedded(mesh, d), curvature, full,
                parent=Parent.of(point))  # fmt: skip


def _metric(problem: BoundaryProblem, point: SpecialPoint, mesh: OnMesh, direction: Array, bend: Array) -> Array:
    """Functions get the size that they reach when the parameter crosses its range along the new branch."""
    width = float(point.scale[-1])
    slope, curve = abs(float(direction[-1])) / width, abs(float(bend[-1])) / width
    reaches = ([1.0 / slope] if slope > 1e-9 else []) + ([float(np.sqrt(2.0 / curve))] if curve > 1e-12 else [])
    amplitude = np.abs(direction[:-1].reshape(-1, problem.n)).max(axis=0) * (min(reaches) if reaches else 0.0)
    sizes = np.maximum(problem.sizes(point.z, point.scale), np.where(np.isfinite(amplitude), amplitude, 0.0))
    return mesh.unknowns(make_scale(mesh.h, problem.points, sizes, 1.0, width))
