"""Criticality of period doublings and torus bifurcations of orbits by shooting.

The normal form of the return map, w -> -w + c' w^3 or w -> e^{i theta} w (1 + d' |w|^2), gives that of the periodic
orbit (`contin.problems.orbits.normal_form`): c = -c' k^2 / T and Re d = Re d' k^2 / T, where k is the factor that the
eigenfunction of mean square 1 has over w's eigenvector.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Verified
from contin.normalforms.maps import circle_manifold, flip_manifold
from contin.normalforms.result import sense
from contin.problems.shooting.return_map import NoDerivatives, ReturnMap

UNDECIDED: Final = 1e-5  # error of a coefficient beside the terms it is the sum of: derivatives are by differences


def period_doubling(problem: Any, z: Array, sizes: Array) -> tuple[float, float]:
    """c, and the size of the terms that it is made of; raises `NoDerivatives`."""
    returns = ReturnMap(problem, z, sizes)
    manifold = flip_manifold(returns.jet())
    factor = returns.unit(manifold.right[0]) / returns.nodes.period
    return float(-factor * manifold.g((3,), 0).real), factor * manifold.magnitude((3,), 0)


def torus(problem: Any, z: Array, sizes: Array, theta: float) -> tuple[float, float]:
    """Re d, and the size of the terms that it is made of; raises `NoDerivatives`."""
    returns = ReturnMap(problem, z, sizes)
    manifold = circle_manifold(returns.jet(), theta)
    factor = returns.unit(manifold.right[0]) / returns.nodes.period
    return float(factor * (manifold.g((2, 1), 0) / manifold.values[0]).real), factor * manifold.magnitude((2, 1), 0)


def with_normal_form(problem: Any, point: Verified, scale: Array) -> Verified:
    """The point with {c, criticality} of a PD, {criticality} of a NS; what cannot be computed is a remark."""
    sizes = problem.sizes(point.z, scale)
    try:
        if point.type == "PD":
            value, size = period_doubling(problem, point.z, sizes)
        else:
            value, size = torus(problem, point.z, sizes, float(point.vectors["theta"]))
    except (NoDerivatives, np.linalg.LinAlgError, ZeroDivisionError) as error:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({error})")
    form: dict[str, Any] = {"criticality": sense(value, UNDECIDED * size)}
    if point.type == "PD":
        form = {"c": value, **form, "errors": {"c": UNDECIDED * size}}
    return replace(point, normal_form=form)
