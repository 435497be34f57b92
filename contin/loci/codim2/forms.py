"""Normal forms of points of codimension two, from exact derivatives of the model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.loci.without_coefficients import with_remark
from contin.machine import elementary
from contin.normalforms.branching import branch_point
from contin.normalforms.invariant_plane import zero_hopf_on_plane
from contin.normalforms.later import Later, stated
from contin.normalforms.point import normal_form
from contin.normalforms.result import DEGENERATE, NO_FORM, TRUST, NormalForm
from contin.normalforms.rounding import change_of, difference_errors, rounding_errors
from contin.normalforms.sources import compiled_jet
from contin.normalforms.zero_hopf import zero_hopf
from contin.problems.algebraic_states import in_own_units, unit_mass, with_units
from contin.records import Fields
from contin.special.table import table

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints
    from contin.normalforms.jet import DerivativeJet, Jet

LEADING: Final = {"CP": "c", "GH": "l2"}  # by type, the coefficient that says what the point is like
SMALL: Final = 1e4  # times the error from its terms' sizes: from there on what else is off may decide
BESIDE: Final = 1e-6  # scaled length of a step along the curve over which coefficients are differentiated
FORCED: Final = ", no parameter unfolds the multiplier 1"  # there is no fold, whose unfolding the rest of the case says


def jet_at(problem: CurveOfPoints, z: Array, active: tuple[int, ...] = ()) -> DerivativeJet:
    """Derivatives of the model at z, in the states and the parameters `active`."""
    curve = problem.curve
    kind = "map" if curve.system.kind == "map" else "flow"
    jet = compiled_jet(curve.system, z[: problem.n], curve.full_parameters(z), active, kind, curve.sizes)  # type: ignore[arg-type]
    return with_units(jet, unit_mass(curve.system))


def described(
    problem: CurveOfPoints, point: Verified, critical: Any, scale: Array, plane: bool = False,
    drift: Array | None = None,
) -> Verified:  # fmt: skip
    """The point with its normal form; with a remark in place of it, where the point is more degenerate than its type.

    `plane` : a ZH (of maps LPPD, LPNS) at which no parameter unfolds the vanishing eigenvalue (multiplier 1).
    `drift` : estimated errors of all unknowns, by which the coefficients are less well known than at the point itself;
    along the curve, and on a plane, where curves cross, each by itself.
    """
    frequencies = sorted(float(v.imag) for v in critical if v.imag > 0.0)
    frequency = frequencies[-1] if point.type in ("GH", "ZH") and frequencies else None
    if point.type == "CH" and frequencies:
        frequency = float(elementary.angle(next(v for v in critical if v.imag > 0.0)))
    forced, plane = plane and point.type != "ZH", plane and point.type == "ZH"
    vectors: Fields = {"critical": critical} | ({"plane": True} if plane else {}) | ({"forced": True} if forced else {})
    if not table()[point.type].normal_form and point.type != "DP":
        return with_remark(replace(point, vectors=vectors), "fixed points of maps")
    jet = jet_at(problem, point.z)
    try:
        if point.type == "DP":
            form = branching_form(problem, point.z)
        elif plane:
            jet = jet_at(problem, point.z, (problem.curve.first, problem.curve.second))
            form = zero_hopf_on_plane(jet, frequency, _off(problem, point, frequency, drift, scale))
        else:
            lengths = None if drift is None else np.abs(drift[: problem.n]) / unit_mass(problem.system)
            form = normal_form(point.type, jet, frequency=frequency, state_error=lengths)
            form = _without_fold(form) if forced else form
    except NO_FORM as reason:
        return replace(point, vectors=vectors, remark=f"{point.type}: its normal form could not be computed ({reason})")
    known: Mapping[str, float] = stated(form.errors)
    if point.type != "DP" and not plane:

        def form_at(jet: Jet) -> NormalForm:
            return normal_form(point.type, jet, frequency=frequency)

        at_place = point.z.copy()

        def grown() -> dict[str, float]:
            changes = [rounding_errors(form, form_at, jet), difference_errors(form, form_at, jet)]
            if drift is not None:
                changes.append(_changes(lambda z: form_at(jet_at(problem, z)), form, at_place, drift, scale))
            return _summed(form, changes)

        known = Later(grown) if form.errors else grown()  # decides nothing, and takes the time of four such forms
        leading = LEADING.get(point.type, "")
        if leading and abs(form.coefficients[leading]) <= SMALL * form.errors[leading]:  # ... but for these
            known = grown()
            if abs(form.coefficients[leading]) <= known[leading]:
                form = replace(form, coefficients={**form.coefficients, "case": DEGENERATE})
    errors = {"errors": known} if isinstance(known, Later) or known else {}
    own = dict(in_own_units(form.vectors, unit_mass(problem.system)))
    return replace(point, normal_form=dict(form.coefficients) | errors, vectors=vectors | own)


def _without_fold(form: NormalForm) -> NormalForm:
    """What is told of a point with multiplier 1 that no parameter unfolds."""
    return replace(form, coefficients={**form.coefficients, "case": f"{form.coefficients['case']}{FORCED}"})


def _off(
    problem: CurveOfPoints, point: Verified, frequency: float | None, drift: Array | None, scale: Array
) -> dict[str, float]:
    """By how much coefficients of a ZH on a plane are off, as its states and parameters are."""
    if drift is None:
        return {}

    def form_at(z: Array) -> NormalForm:
        return zero_hopf(jet_at(problem, z), frequency)

    here = form_at(point.z)
    found: dict[str, float] = {}
    for place in (*range(problem.n), len(drift) - 2, len(drift) - 1):
        alone = np.where(np.arange(len(drift)) == place, drift, 0.0)
        for key, change in _changes(form_at, here, point.z, alone, scale).items():
            found[key] = found.get(key, 0.0) + change
    return found


def _summed(form: NormalForm, changes: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """The errors of a form's coefficients, grown by these."""
    known = dict(form.errors)
    for key, change in chain.from_iterable(found.items() for found in changes):
        own = known[key] if key in known else TRUST * abs(float(form.coefficients[key]))
        known[key] = own + change
    return known


def _changes(form_at: Callable[[Array], Any], form: Any, z: Array, drift: Array, scale: Array) -> dict[str, float]:
    """By how much each coefficient changes over the drift: of what order its error from that of the point is."""
    length = float(np.linalg.norm(drift / scale))
    if not 0.0 < length < np.inf:
        return {}
    step = BESIDE / length
    try:
        beside = form_at(z + step * drift).coefficients
    except NO_FORM:  # as for a point that is placed exactly; its own error stands
        return {}
    found = {}
    for key, value in form.coefficients.items():
        change = change_of(value, beside.get(key)) if isinstance(value, float) or key in form.errors else None
        if change is not None:
            found[key] = change / step
    return found


def branching_form(problem: CurveOfPoints, z: Array) -> Any:
    """Lyapunov-Schmidt coefficients on a curve of branch points, in the parameter that unfolds the branches better."""
    forms = [branch_point(jet_at(problem, z, (active,))) for active in (problem.curve.first, problem.curve.second)]
    return max(forms, key=lambda form: abs(form.coefficients["b11"]))
