"""Normal forms of folds, period doublings and torus bifurcations of orbits by shooting, in those of the periodic orbit.

The return map P has, in coordinates along its critical eigenvector q,

    LPC   w -> w + a' w^2,   PD   w -> -w + c' w^3,   NS   w -> e^{i theta} w (1 + d' |w|^2),

and a time of return T(y). With the orbit's own normal forms (`contin.problems.orbits.normal_forms.normal_form`), whose
phase tau runs at a rate that depends on xi, the time to come round is T (1 - a |xi|^2), so that

    PD    c = -c' k / T,      NS   d = (Re d' + i Im d') k / T + i a theta / T,  a = -(DT h11 + D^2T[q, q*]) k / T,
    LPC   b = a' / DT q, where DT q != 0;  b = a' sqrt(k) / T in forced systems, and where the period does not change,

where sqrt(k) is the factor that the eigenfunction of mean square 1 has over q's. Every coefficient is computed twice,
by differences with steps h and 2 h, whose distance is its error.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.normalforms.coefficient import Coefficient
from contin.normalforms.homological import CentreManifold
from contin.normalforms.linear import null_pair
from contin.normalforms.maps import circle_manifold, flip_manifold
from contin.problems.no_derivatives import NoDerivatives
from contin.problems.orbits.normal_forms.normal_form import stated
from contin.problems.shooting.return_map import ReturnMap, lengths_of_steps
from contin.problems.tolerances import SHEARLESS

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations


def fold(returns: ReturnMap, factor: int = 1) -> Coefficient:
    """b; raises `NoDerivatives`."""
    jet = returns.jet(factor)
    pair = null_pair(jet.A - np.eye(jet.n), 1.0, jet.scale)
    manifold = CentreManifold(jet, [pair])
    q, value, size = pair.right.real, manifold.g((2,), 0).real, manifold.magnitude((2,), 0)
    drifts = _drifts(returns, q)
    unit = length_across_fold(returns, q) / returns.nodes.period
    if drifts:
        unit = float(np.copysign(unit, returns.slope_of_time(q).real))
    noise = returns.noise * float(np.linalg.norm(pair.left)) * abs(unit)
    return Coefficient(value * unit, size * abs(unit), drifts, noise)


def _drifts(returns: ReturnMap, q: Array) -> bool:
    """Whether the period changes across the fold, whose eigenvector is q."""
    size = returns.nodes.period * float(np.linalg.norm(q))
    return abs(returns.slope_of_time(q).real) > SHEARLESS * size


def length_across_fold(returns: ReturnMap, q: Array) -> float:
    """Of the coordinate along q of the map's fold, in that of the cycle's: w = length xi."""
    if _drifts(returns, q):
        return returns.nodes.period / abs(returns.slope_of_time(q).real)
    return float(np.sqrt(returns.unit_without_drift(q)))


def period_doubling(returns: ReturnMap, factor: int = 1) -> Coefficient:
    """c; raises `NoDerivatives`."""
    manifold = flip_manifold(returns.jet(factor))
    unit = returns.unit(manifold.right[0]) / returns.nodes.period
    noise = returns.noise * float(np.linalg.norm(manifold.left[0])) * unit
    return Coefficient(float(-unit * manifold.g((3,), 0).real), unit * manifold.magnitude((3,), 0), noise=noise)


def torus(returns: ReturnMap, theta: float, factor: int = 1) -> Coefficient:
    """d; raises `NoDerivatives`."""
    manifold = circle_manifold(returns.jet(factor), theta)
    q, period = manifold.right[0], returns.nodes.period
    unit = returns.unit(q) / period
    d = unit * (manifold.g((2, 1), 0) / manifold.values[0])
    if returns.problem.autonomous:
        turned = returns.slope_of_time(manifold.h(1, 1)).real + returns.bend_of_time(q, factor)
        d -= 1j * turned * unit * theta / period
    noise = returns.noise * float(np.linalg.norm(manifold.left[0])) * unit
    return Coefficient(complex(d), unit * manifold.magnitude((2, 1), 0), noise=noise)


def coefficient(returns: ReturnMap, type_: str, theta: float, factor: int = 1) -> Coefficient:
    """b of LPC, c of PD or d of NS."""
    if type_ == "LPC":
        return fold(returns, factor)
    return period_doubling(returns, factor) if type_ == "PD" else torus(returns, theta, factor)


def with_normal_form(problem: ShotEquations, point: Verified, scale: Array) -> Verified:
    """The point with b, c or d, its error, and the criticality of PD and NS; what cannot be computed is a remark."""
    sizes = lengths_of_steps(problem, point.z, problem.sizes(point.z, scale))
    returns = ReturnMap(problem, point.z, sizes)
    theta = float(point.vectors["theta"])
    try:
        fine, coarse = (coefficient(returns, point.type, theta, factor) for factor in (1, 2))
    except (NoDerivatives, np.linalg.LinAlgError, ZeroDivisionError) as error:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({error})")
    return stated(point, fine, fine.error(coarse))
