"""Normal forms of folds, period doublings and torus bifurcations of large orbits: b, c and d of FORMATS.

Each is computed on two meshes, the special orbit being located on both; their difference is the error, with rounding
and, where derivatives are differences, the change by wider ones.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.outcome import Verified
from contin.normalforms.coefficient import Coefficient
from contin.normalforms.cycles import coefficient
from contin.problems.large_orbits.cycle import LargeCycle
from contin.problems.orbits.normal_forms.normal_form import stated
from contin.problems.tolerances import SHEARLESS

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
        first, second = (LargeCycle.of_type(*orbit, point.type) for orbit in (coarse, fine))
        if point.type == "LPC":
            drift = drifts(first.shear, second.shear)
            first, second = replace(first, drifts=drift), replace(second, drifts=drift)
        found = _with_noise(first, point.type)
        error = found.error(coefficient(second, point.type, second.theta))
    except (np.linalg.LinAlgError, ZeroDivisionError, UnresolvedShearError) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    made = stated(point, found, error)
    return replace(made, normal_form={**point.normal_form, **made.normal_form})


def drifts(coarse: float, fine: float) -> bool:
    """Whether the period changes across a fold, from the shears on two meshes; raises where they do not tell."""
    if fine > SHEARLESS and abs(fine - coarse) < RESOLVED * fine:
        return True
    if fine <= SHEARLESS or fine < RESOLVED * coarse:
        return False
    raise UnresolvedShearError


def _with_noise(cycle: LargeCycle, type_: str) -> Coefficient:
    found, wider = coefficient(cycle, type_, cycle.theta), with_wider_stencils(cycle)
    return found if wider is None else found.with_noise_from(coefficient(wider, type_, cycle.theta))


def with_wider_stencils(cycle: LargeCycle) -> LargeCycle | None:
    """The cycle with other differences for its derivatives, which tell their errors; None where these are exact."""
    wider = cycle.problem.system.with_wider_stencils(WIDER)
    return None if wider is None else replace(cycle, system=wider)
