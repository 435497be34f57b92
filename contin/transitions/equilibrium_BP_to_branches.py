"""Branch switching at branch points of equilibria and fixed points: directions.

Curvature and metric of the new branch.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.normalforms.result import TRUST
from contin.problems.equilibria import defining, special_points
from contin.problems.equilibria.branching.degenerate import fan_at, is_degenerate, other_curves, scaled_own
from contin.problems.equilibria.branching.multiple_kernel import reduced_branches
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.symmetry import reversing_symmetries
from contin.transitions.equivariant_branches import rotated_branches
from contin.transitions.registry import Explored, born

PARALLEL = 0.9999  # cosine between tangents from which two branches are the same


@born(EquilibriumProblem, "BP", "the branches that cross", explored=Explored())
def branches(problem: EquilibriumProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the branches that cross the point's own branch there, with `parameter` free."""
    if parameter == problem.parameters[0]:
        turning = rotated_branches(problem, point)
        if turning is not None:
            return [replace(seed, measured=_measured(point)) for seed in turning]
    parent = Parent.of(point)
    own = point.tangent / point.scale
    own = own / np.linalg.norm(own)
    local = ScaledSystem(problem, point.scale)
    y = point.z / point.scale
    anchor = scaled_own(point, point.scale)
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
        local, own, anchor = ScaledSystem(problem, point.scale), np.zeros_like(own), None
    kernel = int(point.vectors.get("kernel", 1))
    outsets = None
    if is_degenerate(point):
        fan = fan_at(problem, point.z, point.scale, kernel)
        outsets = None if fan is None else other_curves(fan, anchor, own)
    seeds = []
    for outset in crossing_branches(local.rated(y), y, own, kernel) if outsets is None else outsets:
        scale, d, k = point.scale, outset.direction, outset.curvature
        beside = {arm: at * scale for arm, at in outset.beside.items()}
        if not beside:  # a point is known only as well as the metric resolves it that it was found in
            scale, d, k = renewed_metric(local, point.z, d, k)
        symmetries = reversing_symmetries(problem, point.z, d * scale, scale)
        arms = (1,) if symmetries else tuple(sorted(beside)) or (-1, 1)
        seeds.append(
            Seed(problem, point.z, d, k, scale, arms, parent, symmetries, beside=beside, measured=_measured(point))
        )
    if not seeds:
        verb = "crosses" if outsets is None else "meets this one"
        raise InputError(f"{point.branch}.{point.label}: no second real branch {verb} here")
    return seeds


def _measured(point: SpecialPoint) -> tuple[int, NDArray[np.complex128]] | None:
    """The count of unstable eigenvalues there, without critical ones, and all of them; a solve there may fail."""
    count = point.values.get("unstable")
    return None if count is None else (int(count), point.eigenvalues)


def crossing_branches(local: ScaledSystem, y: Array, own: Array, corank: int) -> list[Outset]:
    """The branches other than the one with tangent `own`."""
    if corank == 1:
        tangents = special_points.crossing_tangents(local, y)
        others = [t for t in tangents if abs(float(t @ own)) < PARALLEL]
        if len(others) > 1:  # neither is exactly the branch's own: drop the nearer one
            others = [min(others, key=lambda t: abs(float(t @ own)))] if np.any(own) else others
        return [Outset(_oriented(t), simple_curvature(local, y, _oriented(t))) for t in others]
    return reduced_branches(local, y, own, corank)


def _oriented(tangent: Array) -> Array:
    """With the parameter, or where that does not move with the first unknown that does."""
    leading = tangent[-1] if abs(tangent[-1]) > 1e-6 else tangent[np.flatnonzero(np.abs(tangent) > 1e-6)[0]]
    return tangent if leading > 0 else -tangent


def simple_curvature(local: ScaledSystem, y: Array, d: Array) -> Array:
    """z''(0) of the branch with tangent d at a simple branch point, normal to d.

    J z'' = -D^2F[d, d] leaves the component along the rest of ker J open; it follows from the third order,
    psi . (3 D^2F[d, z''] + D^3F[d, d, d]) = 0.
    """
    _, jacobian = local.linearise(y)
    left, kernel = defining.singular_basis(jacobian, 1)
    psi = left[:, 0]
    rest = kernel @ np.array([-(kernel[:, 1] @ d), kernel[:, 0] @ d])  # in the kernel, normal to d
    particular = np.linalg.lstsq(jacobian, -local.form(y, d, d), rcond=1e-10)[0]
    particular = particular - (particular @ d) * d
    slope = 3.0 * float(psi @ local.form(y, d, rest))
    if slope == 0.0:
        return np.asarray(particular)
    parts = 3.0 * psi * local.form(y, d, particular), psi * local.form(y, d, d, d)
    known = float(np.sum(parts))
    if abs(known) <= TRUST * float(np.sum(np.abs(parts))):  # zero to rounding: higher orders bend the branch
        known = 0.0
    return np.asarray(particular - known / slope * rest)


def renewed_metric(local: ScaledSystem, z: Array, d: Array, k: Array) -> tuple[Array, Array, Array]:
    """Metric of the new branch: states that begin to move get the size they reach over the parameter's range.

    Where the parameter's slope and bend are zero to rounding, that is not known, and they keep the size they have.
    """
    old = local.scale
    n = local.n
    slope = float(d[-1]) if abs(d[-1]) > TRUST * float(np.linalg.norm(d)) else 0.0
    bend = float(k[-1]) if abs(k[-1]) > TRUST * float(np.linalg.norm(k)) else 0.0
    reach = _reach(slope, bend)
    scale = old.copy()
    if np.isfinite(reach):
        periods = local.problem.angle_periods
        amplitude = old[:-1] * np.abs(reach * d[:-1])
        size = np.maximum(np.sqrt(n) * np.abs(z[:-1]), amplitude)
        moves = (np.abs(d[:-1]) > 1e-9) & (periods == 0.0) & (size > 0.0)
        scale[:-1] = np.where(moves, size, old[:-1])
    ratio = old / scale
    direction, curvature = d * ratio, k * ratio
    norm = float(np.linalg.norm(direction))
    direction = direction / norm
    curvature = curvature / elementary.square(norm)
    return scale, direction, curvature - float(curvature @ direction) * direction


def _reach(slope: float, bend: float) -> float:
    """Smallest s > 0 at which |slope s + bend s^2 / 2| = 1."""
    roots = []
    for target in (1.0, -1.0):
        for root in (
            np.roots([0.5 * bend, slope, -target]) if bend != 0.0 else ([target / slope] if slope != 0.0 else [])
        ):
            if abs(np.imag(root)) < 1e-12 and np.real(root) > 0.0:
                roots.append(float(np.real(root)))
    return min(roots) if roots else np.inf
