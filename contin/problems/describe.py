"""Normal forms of verified points, from exact derivatives of the compiled equations."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Verified

if TYPE_CHECKING:
    from contin.normalforms.jet import DerivativeJet


def jet_at(problem: Any, z: Array, scale: Array | None = None) -> DerivativeJet:
    """Derivatives at z of f in the states and the varying parameter, in the user's units."""
    from contin.normalforms.jet import DerivativeJet

    def derivative(directions: tuple[Array, ...]) -> NDArray[Any]:
        return np.asarray(problem.form(z, *directions))

    return DerivativeJet(problem.linear_part(z), derivative, 1, "map" if problem.is_map else "flow", scale)


def with_normal_form(problem: Any, point: Verified, scale: Array) -> Verified:
    """The point with FORMATS' coefficients and its vectors.

    Unchanged where the type has none or they are not defined.
    """
    try:
        form = _normal_form(problem, point, scale[:-1])
    except (ZeroDivisionError, np.linalg.LinAlgError):
        return point
    if form is None:
        return point
    vectors = {**point.vectors, **form.vectors}
    return replace(point, normal_form={**form.coefficients, **point.normal_form}, vectors=vectors)


def _normal_form(problem: Any, point: Verified, scale: Array) -> Any:
    from contin.normalforms import branching, fold, hopf
    from contin.normalforms.result import NormalForm

    kernel = int(point.vectors.get("kernel", 1))
    if point.type == "BP" and kernel > 1:
        from contin.normalforms.directions import any_branch_point

        return any_branch_point(jet_at(problem, point.z, scale), kernel=kernel)
    if kernel > 1:
        return NormalForm(point.type, {"kernel": kernel}, f"{kernel} pairs at once")
    if point.type not in ("LP", "BP", "HB", "PD", "NS") or point.normal_form.get("kind") == "nonsmooth":
        return None
    jet = jet_at(problem, point.z, scale)
    if point.type == "LP":
        return fold.fold(jet)
    if point.type == "BP":
        return branching.branch_point(jet)
    if point.type == "HB":
        return hopf.hopf(jet, float(point.vectors["omega"]))
    from contin.normalforms import maps

    return maps.period_doubling(jet) if point.type == "PD" else maps.neimark_sacker(jet, float(point.vectors["omega"]))
