"""Normal forms of points of codimension two, from exact derivatives of the model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from contin.abi import Array
from contin.continuation.problem import Verified
from contin.machine import elementary
from contin.normalforms.branching import branch_point
from contin.normalforms.invariant_plane import zero_hopf_on_plane
from contin.normalforms.point import normal_form
from contin.normalforms.result import NO_FORM
from contin.normalforms.sources import compiled_jet


def jet_at(problem: Any, z: Array, active: tuple[int, ...] = ()) -> Any:
    """Derivatives of the model at z, in the states and the parameters `active`."""
    curve = problem.curve
    kind = "map" if curve.system.kind == "map" else "flow"
    return compiled_jet(curve.system, z[: problem.n], curve.full_parameters(z), active, kind, curve.sizes)  # type: ignore[arg-type]


def described(problem: Any, point: Verified, critical: Any, plane: bool = False) -> Verified:
    """The point with its normal form; with a remark in place of it, where the point is more degenerate than its type.

    `plane` : a ZH at which no parameter unfolds the vanishing eigenvalue.
    """
    frequencies = sorted(float(v.imag) for v in critical if v.imag > 0.0)
    frequency = frequencies[-1] if point.type in ("GH", "ZH") and frequencies else None
    if point.type == "CH" and frequencies:
        frequency = float(elementary.angle(next(v for v in critical if v.imag > 0.0)))
    active = (problem.curve.first,) if point.type == "DP" else ()
    vectors: dict[str, Any] = {"critical": critical} | ({"plane": True} if plane else {})
    try:
        if point.type == "DP":
            form = branching_form(problem, point.z)
        elif plane:
            form = zero_hopf_on_plane(jet_at(problem, point.z, (problem.curve.first, problem.curve.second)), frequency)
        else:
            form = normal_form(point.type, jet_at(problem, point.z, active), frequency=frequency)
    except NO_FORM as reason:
        return replace(point, vectors=vectors, remark=f"{point.type}: its normal form could not be computed ({reason})")
    errors = {"errors": dict(form.errors)} if form.errors else {}
    return replace(point, normal_form=dict(form.coefficients) | errors, vectors=vectors | dict(form.vectors))


def branching_form(problem: Any, z: Array) -> Any:
    """Lyapunov-Schmidt coefficients on a curve of branch points, in the parameter that unfolds the branches better."""
    forms = [branch_point(jet_at(problem, z, (active,))) for active in (problem.curve.first, problem.curve.second)]
    return max(forms, key=lambda form: abs(form.coefficients["b11"]))
