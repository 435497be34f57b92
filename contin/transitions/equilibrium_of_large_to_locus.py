"""The curves in two parameters through folds and Hopf points of a large system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.sparse.curve import LargeCurve
from contin.loci.sparse.large_locus import LargeLocus
from contin.machine import elementary
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.problems.two_parameters import indices
from contin.transitions.registry import born


@born(LargeProblem, "LP HB", "the curve of such points", parameters=2)
def loci_of_point(problem: LargeProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold or a Hopf point of a branch of equilibria."""
    if int(point.vectors.get("kernel", 1)) > 1:  # its equations are singular all along
        raise InputError(
            f"{point.branch}.{point.label} has {point.vectors['kernel']} pairs of eigenvalues that cross together: its "
            "curve is not followed"
        )
    kappa = elementary.square(float(point.vectors["omega"])) if point.type == "HB" else 0.0
    q = np.asarray(point.vectors["q"]) if point.type == "HB" else (point.tangent * point.scale)[:-1]
    p = problem.full_parameters(point.z)
    parent = Parent.of(point)
    return [seed_of_large(problem, point.type, parameters, point.z[:-1], p, kappa, q, parent)]


def seed_of_large(
    problem: LargeProblem, type_: str, parameters: Sequence[str], u: Array, p: Array, kappa: float, q: NDArray[Any],
    parent: Parent,
) -> Seed:  # fmt: skip
    """The curve of points of a type through (u, p), with its kappa and critical vector."""
    first, second = indices(problem.system, parameters)
    curve = LargeCurve(type_, replace(problem, base=p.copy(), active=first), first, second)
    z = np.concatenate([u, [kappa] if type_ == "HB" else [], [p[second], p[first]]])
    return Seed(LargeLocus(curve.started(z, q)), z, parent=parent)
