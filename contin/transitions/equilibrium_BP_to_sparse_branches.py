"""The branches of a large system that cross its own branch at a branch point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.problems.sparse.multiple_kernel import ReducedJet
from contin.problems.sparse.special_points import kernel_at, reduction
from contin.problems.symmetry import reversing_symmetries
from contin.transitions.oriented import oriented
from contin.transitions.registry import Explored, born

PARALLEL = 0.9999  # cosine from which a direction is the branch's own


@born(LargeProblem, "BP", "the branches that cross", explored=Explored())
def sparse_branches(problem: LargeProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the branches that cross the point's own there."""
    own = point.tangent / point.scale
    own = own / norm(own)
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    problem.precisely(point.z)
    k = int(point.vectors.get("kernel", 1))
    try:
        if k > 1:
            curves = ReducedJet(kernel_at(problem, point.z, own, point.scale, k), point.z).branches()
        else:
            curves = reduction(problem, point.z, own, point.scale)[0].crossing(point.z)
    except ArithmeticError as failure:
        raise InputError(f"{point.branch}.{point.label}: {failure}") from failure
    cosines = [abs(float((d / point.scale) @ own)) / norm(d / point.scale) for d, _ in curves]
    others = [curve for curve, cosine in zip(curves, cosines, strict=True) if cosine < PARALLEL]
    if not others:
        raise InputError(f"{point.branch}.{point.label}: no second real branch crosses here")
    chosen = others if k > 1 else [curves[int(np.argmin(cosines))]]
    return [_seed(problem, point, direction, bend) for direction, bend in chosen]


def _seed(problem: LargeProblem, point: SpecialPoint, direction: Array, bend: Array) -> Seed:
    """The branch z + s direction + s^2 bend / 2 (raw)."""
    direction = oriented(direction, point.scale)
    scale = _metric(point.z, direction, bend, point.scale)
    d, c = direction / scale, bend / scale
    length = norm(d)
    d, c = d / length, c / elementary.square(length)
    symmetries = reversing_symmetries(problem, point.z, d * scale, scale)
    seed = Seed(
        problem, point.z, d, c - float(c @ d) * d, scale, parent=Parent.of(point),
        measured=(int(point.values["unstable"]), np.asarray(point.eigenvalues)),
    )  # fmt: skip
    return replace(seed, arms=(1,), symmetries=symmetries) if symmetries else seed


def _metric(z: Array, direction: Array, bend: Array, old: Array) -> Array:
    """States get the size that they reach when the parameter crosses its range along the new branch."""
    n = len(z) - 1
    unit = old[:-1] / float(np.max(old[:-1]))
    slope, curve = abs(float(direction[-1] / old[-1])), abs(float(bend[-1] / old[-1]))
    reaches = ([1.0 / slope] if slope > 1e-9 else []) + ([float(np.sqrt(2.0 / curve))] if curve > 1e-12 else [])
    amplitude = min(reaches) * float(np.max(np.abs(direction[:-1]) / unit)) if reaches else 0.0
    size = max(float(np.max(np.abs(z[:-1]) / unit)), amplitude)
    return np.append(np.sqrt(n) * size * unit, old[-1]) if size > 0.0 and np.isfinite(size) else old
