"""The curves that leave a zero-Hopf point on an invariant plane: Hopf curves that cross there, and branch points."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import SpecialPoint
from contin.continuation.outcome import Rejected
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.loci.codim2 import zero_hopf_crossing
from contin.loci.codim2.functions import function_of
from contin.problems.symmetry import symmetry_names
from contin.problems.symmetry_group import moved

if TYPE_CHECKING:
    from contin.loci.equilibria.equilibrium_locus import LocusProblem

KEPT = 1e-6  # relative: what a symmetry leaves as it is


def hopf_curves(seed: Seed, point: SpecialPoint, own: bool) -> list[Seed]:
    """Both Hopf curves through the point, as seeds with tangents; without its own where the point is on one.

    `seed` : of a Hopf curve, at the point.
    """
    problem: Any = seed.problem
    widths = (float(point.scale[-1]), float(point.scale[-2]))
    z = point.z if own else seed.z
    scale = point.scale if own else problem.curve.scales(seed.z, widths)
    if own:
        problem = replace(problem, curve=point.problem.curve)
    problem = replace(problem, curve=problem.curve.settled(z, scale))  # with rows of one size in any unit of time
    values = np.asarray(point.eigenvalues)
    near = Sample(z, np.zeros(len(z)), np.zeros(1), 0, values)
    function = function_of(problem, "ZH", near)
    if not own and not isinstance(function, Rejected):
        met = zero_hopf_crossing.solve(problem, function, near, Frame(scale))
        z = z if met is None else met.y * scale
    tangents = zero_hopf_crossing.other_tangents(problem, z, scale, point.tangent if own else None)
    return [
        replace(seed, problem=problem, z=z, direction=t, scale=scale, arms=_arms(problem, z, t * scale))
        for t in tangents
    ]


def _arms(problem: LocusProblem, z: Array, direction: Array) -> tuple[int, ...]:
    """One arm where a declared symmetry maps the other one onto it."""
    n, system = problem.n, problem.system
    u, d = z[:n], direction[:n]
    size = float(np.abs(d).max())
    if size == 0.0 or float(np.abs(direction[-2:]).max()) > KEPT * float(np.abs(direction).max()):
        return (-1, 1)
    p = problem.curve.full_parameters(z)
    for name in symmetry_names(problem):
        rows = moved(system, name, np.stack([u, u + KEPT * d, u - KEPT * d]), np.tile(p, (3, 1)))
        kept = np.all(np.abs(rows[0] - u) <= KEPT * np.maximum(np.abs(u), size))
        turned = np.all(np.abs((rows[1] - rows[2]) / (2.0 * KEPT) + d) <= 1e-3 * size)
        if kept and turned:
            return (1,)
    return (-1, 1)
