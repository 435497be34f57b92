"""The curve in two parameters through a fold, Hopf or branch point of equilibria (of maps: also PD, NS)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.start_metric import near_point
from contin.transitions.curve_through import seed_of
from contin.transitions.on_surfaces import refuse_sliding
from contin.transitions.registry import born


@born(EquilibriumProblem, "LP BP HB PD NS", "the curve of such points", parameters=2)
def loci_of_point(problem: EquilibriumProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of points of the same type."""
    refuse_sliding(problem, point)
    if point.normal_form.get("kind") == "nonsmooth":
        raise InputError(f"{point.branch}.{point.label} is a corner of piecewise equations; its curve is not followed")
    if int(point.vectors.get("kernel", 1)) > 1:
        raise InputError(
            f"{point.branch}.{point.label} has a kernel of dimension {point.vectors['kernel']}: "
            "its curve is not followed"
        )
    p = problem.full_parameters(point.z)
    known = point.scale.size > 0
    sizes = near_point(problem, point.z, point.scale) if known else np.maximum(np.abs(point.z[:-1]), 1e-3)
    scalar = 0.0
    if point.type == "HB":
        scalar = elementary.square(float(point.vectors["omega"]))
    elif point.type == "NS":
        scalar = float(elementary.cos(point.vectors["omega"]))
    parent = Parent.of(point)
    return [
        seed_of(problem.system, point.type, parameters, point.z[:-1], p, sizes, problem.angle_periods, scalar, parent)
    ]
