"""Criticality of period doublings and torus bifurcations of orbits by shooting.

The normal form of the return map, w -> -w + c' w^3 or w -> e^{i theta} w (1 + d' |w|^2), gives that of the periodic
orbit (`contin.problems.orbits.normal_form`): c = -c' k^2 / T and Re d = Re d' k^2 / T, where k is the factor that the
eigenfunction of mean square 1 has over w's eigenvector.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.normalforms.maps import circle_manifold, flip_manifold
from contin.problems.shooting.return_map import NoDerivatives, ReturnMap

UNDECIDED: Final = 1e-5  # a coefficient this small beside the terms it is the sum of has no sign


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


def criticality(problem: Any, type_: str, z: Array, sizes: Array, theta: float) -> Mapping[str, Any]:
    """{c, criticality} of a PD, {criticality} of a NS; empty where the return map has no derivatives."""
    try:
        value, size = period_doubling(problem, z, sizes) if type_ == "PD" else torus(problem, z, sizes, theta)
    except (NoDerivatives, np.linalg.LinAlgError, ValueError, ZeroDivisionError):
        return {}
    named: dict[str, Any] = {"c": value} if type_ == "PD" else {}
    if abs(value) <= UNDECIDED * size:
        return {**named, "criticality": "degenerate"}
    return {**named, "criticality": "supercritical" if value < 0.0 else "subcritical"}
