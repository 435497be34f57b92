"""Normal forms of folds, period doublings and torus bifurcations of large orbits: b, c and d of FORMATS.

Each is computed on two meshes, the special orbit being located on both; their difference is the error, with rounding
and, where derivatives are differences, the change by wider ones.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Vector
from contin.continuation.outcome import Verified
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.normalforms.coefficient import SAFETY, Coefficient
from contin.normalforms.cycles import fold, period_doubling, torus
from contin.problems.large_orbits.cycle import SHEARLESS, LargeCycle
from contin.problems.large_orbits.multipliers import critical_index
from contin.problems.orbits.normal_forms.normal_form import stated

if TYPE_CHECKING:
    from contin.abi import Array
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations

WIDER: Final = 1.4  # stencils that tell errors of differences
RESOLVED: Final = 0.25  # of a shear: how much it may change with the mesh; from this factor on it falls with the mesh


class UnresolvedShearError(ArithmeticError):
    """It is not known whether the period changes across a fold."""

    def __str__(self) -> str:
        return "whether the period changes across the fold is not resolved by these meshes"


def with_normal_form(
    point: Verified, coarse: tuple[LargeOrbitEquations, Array], fine: tuple[LargeOrbitEquations, Array] | None
) -> Verified:
    """The point with its coefficient, error and criticality, or the remark why it has none.

    coarse, fine : the orbit on two meshes; None where the second one was not found.
    """
    if fine is None:
        return replace(point, remark=f"{point.type}: its normal form is not known (no orbit on a finer mesh)")
    try:
        first, second = _cycle(point.type, *coarse), _cycle(point.type, *fine)
        if point.type == "LPC":
            drift = drifts(first[0].shear, second[0].shear)
            first, second = ((replace(cycle, drifts=drift), theta) for cycle, theta in (first, second))
        found = _with_noise(point.type, *first)
        error = found.error(_coefficient(point.type, *second))
    except (np.linalg.LinAlgError, ZeroDivisionError, UnresolvedShearError) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    made = stated(point, found, error)
    return replace(made, normal_form={**point.normal_form, **made.normal_form})


def _cycle(type_: str, problem: LargeOrbitEquations, z: Array) -> tuple[LargeCycle, float]:
    values, vectors = problem.multipliers(z, exactly=True)
    k = critical_index(values, type_)
    if k is None:
        raise np.linalg.LinAlgError("the multiplier that crosses is lost on one of the meshes")
    q: Vector = vectors[:, k]
    return LargeCycle(problem, z, q / norm(q)), float(elementary.angle(values[k]))


def drifts(coarse: float, fine: float) -> bool:
    """Whether the period changes across a fold, from the shears on two meshes; raises where they do not tell."""
    if fine > SHEARLESS and abs(fine - coarse) < RESOLVED * fine:
        return True
    if fine <= SHEARLESS or fine < RESOLVED * coarse:
        return False
    raise UnresolvedShearError


def _coefficient(type_: str, cycle: LargeCycle, theta: float) -> Coefficient:
    if type_ == "LPC":
        return fold(cycle)
    return period_doubling(cycle) if type_ == "PD" else torus(cycle, theta)


def _with_noise(type_: str, cycle: LargeCycle, theta: float) -> Coefficient:
    found = _coefficient(type_, cycle, theta)
    wider = cycle.problem.system.with_wider_stencils(WIDER)
    if wider is None:
        return found
    other = _coefficient(type_, replace(cycle, system=wider), theta)
    return replace(found, noise=SAFETY * abs(found.value - other.value))
