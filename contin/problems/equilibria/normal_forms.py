"""Normal forms of verified points, from exact derivatives of the compiled equations."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.machine import elementary
from contin.normalforms.branching import branch_point
from contin.normalforms.directions import any_branch_point, turning_branch_point
from contin.normalforms.fold import fold
from contin.normalforms.hopf import hopf
from contin.normalforms.jet import DerivativeJet, Jet, Kind
from contin.normalforms.later import Later, stated
from contin.normalforms.linear import solve
from contin.normalforms.maps import neimark_sacker, period_doubling
from contin.normalforms.multiple import LargeKernelError
from contin.normalforms.poles import ROUNDED
from contin.normalforms.result import NO_ERRORS, STATE_ERROR, Errors, NormalForm
from contin.normalforms.rounding import difference_errors, rounding_errors
from contin.normalforms.sources import jet_of
from contin.problems.algebraic_states import in_own_units, unit_mass, with_units
from contin.problems.coinciding import SEVERAL_MULTIPLIERS, SEVERAL_PAIRS
from contin.problems.equilibria.branching import degenerate
from contin.problems.equilibria.branching.rotated import turning_kernel
from contin.problems.equilibria.critical_actions import critical_actions

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations


SUSPECT: Final = 1e-8  # singular value over the largest, below which rounding is asked for
SOLVED: Final = 1e-14  # relative error of states at least: their points are solved to rounding


def jet_at(problem: AlgebraicEquations, z: Array, scale: Array | None = None) -> DerivativeJet:
    """Derivatives at z of f in the states and the varying parameter, in the user's units."""
    u, p = z[: problem.n], problem.full_parameters(z)
    kind: Kind = "map" if problem.is_map else "flow"
    return jet_of(problem.linear_part(z), problem.system, u, p, [problem.active], kind, scale)


def with_normal_form(problem: AlgebraicEquations, point: Verified, scale: Array) -> Verified:
    """The point with FORMATS' coefficients, their errors and its vectors; what cannot be computed is a remark."""
    try:
        form = _normal_form(problem, point, scale)
    except LargeKernelError as reason:
        known = {"kind": "multiple", "kernel": int(point.vectors["kernel"])}
        return replace(point, normal_form=known, remark=f"{point.type}: {reason}")
    except (ZeroDivisionError, np.linalg.LinAlgError) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    if form is None:
        return point
    numbers = [v for v in form.coefficients.values() if isinstance(v, float)]
    if not np.all(np.isfinite(numbers)):
        return replace(point, remark=f"{point.type}: its normal form is not finite")
    units = unit_mass(problem.system)
    vectors = {**point.vectors, **in_own_units(form.vectors, units)}
    errors = {"errors": stated(form.errors)} if isinstance(form.errors, Later) or form.errors else {}
    described = replace(point, normal_form={**form.coefficients, **point.normal_form, **errors}, vectors=vectors)
    if int(point.vectors.get("kernel", 1)) > 1:
        described = replace(described, remark=_at_once(problem, point, scale) or described.remark)
    return degenerate.described(problem, described, scale) if degenerate.is_degenerate(described) else described


def _at_once(problem: AlgebraicEquations, point: Verified, scale: Array) -> str:
    """What is not told of several eigenvalues or pairs that cross together; of Hopf points symmetries tell it."""
    if point.type != "HB":
        return SEVERAL_MULTIPLIERS.get(point.type, "")
    if not problem.system.model.symmetries:
        return SEVERAL_PAIRS
    jet, omega = jet_at(problem, point.z, scale[:-1]), float(point.vectors["omega"])
    forced = critical_actions(problem, point.z, scale[:-1], jet, omega, int(point.vectors["kernel"])).irreducible
    return "" if forced else SEVERAL_PAIRS


def _normal_form(problem: AlgebraicEquations, point: Verified, metric: Array) -> NormalForm | None:
    kernel, scale = int(point.vectors.get("kernel", 1)), metric[:-1]
    units = unit_mass(problem.system)
    if point.type == "BP" and kernel > 1:
        if turning_kernel(problem, point.z, scale, kernel) is not None:
            return turning_branch_point(with_units(jet_at(problem, point.z, scale), units), kernel)
        return any_branch_point(with_units(jet_at(problem, point.z, scale), units), kernel=kernel)
    if kernel > 1:
        return NormalForm(point.type, {"kernel": kernel}, f"{kernel} at once")
    if point.type not in ("LP", "BP", "HB", "PD", "NS") or point.normal_form.get("kind") == "nonsmooth":
        return None
    jet = with_units(jet_at(problem, point.z, scale), units)
    location = max(STATE_ERROR, point.error / float(metric[-1]))  # of the states, relative: as well as the parameter
    if point.type == "BP" and "turning" in point.vectors:
        coefficients = {"kind": "degenerate", "kernel": int(point.vectors["turning"])}
        return NormalForm("BP", coefficients, "branch point at which the parameter turns on all branches")
    lengths = location * scale / units
    drift = _drift(jet, point, units, scale)

    def form_at(jet: Jet, further: Errors = NO_ERRORS) -> NormalForm:
        if point.type == "LP":
            return fold(jet, state_error=lengths, further=further)
        if point.type == "BP":
            return branch_point(jet, state_error=lengths, parameter_error=point.error, further=further)
        if point.type == "HB":
            return hopf(jet, float(point.vectors["omega"]), drift=drift, further=further)
        if point.type == "PD":
            return period_doubling(jet, drift=drift, further=further)
        return neimark_sacker(jet, float(point.vectors["omega"]), drift=drift, further=further)

    form = form_at(jet)
    if jet.rounded is not None or _is_beside_singular(jet, form):
        moved = rounding_errors(form, form_at, jet)
        unknown = {key: _size(form.coefficients[key]) for key in form.errors if key not in moved}
        return form_at(jet, unknown | moved)
    if not jet.otherwise:
        return form
    moved = difference_errors(form, form_at, jet)
    grown = {key: error + moved.get(key, 0.0) for key, error in form.errors.items()}
    if any(_size(form.coefficients[key]) <= error for key, error in grown.items()):  # what decides may not be known
        return form_at(jet, moved)
    return replace(form, errors=grown)


def _is_beside_singular(jet: Jet, form: NormalForm) -> bool:
    """Whether a matrix by which the form solves is nearly singular, in the states' sizes: rounding is then amplified.

    Scaled by its own entries (`equilibrate`) a matrix may be regular whose entries are rounding.
    """
    size = np.ones(jet.n) if jet.scale is None else jet.scale
    matrix = jet.A * size / size[:, None]
    shifts: list[complex] = [1.0 if jet.kind == "map" else 0.0]
    if form.type in ("HB", "NS"):
        angle = 1j * float(cast(float, form.coefficients["omega" if form.type == "HB" else "theta"]))
        shifts.append(complex(elementary.exp(2.0 * angle)) if form.type == "NS" else 2.0 * angle)
    kernel = 1 if form.type in ("LP", "BP") else 0
    if jet.n <= kernel or not np.isfinite(matrix).all():
        return False
    for shift in shifts:
        values = np.linalg.svd(matrix - shift * np.eye(jet.n), compute_uv=False)
        if values[-1 - kernel] < SUSPECT * values[0]:
            return True
    return False


def _size(coefficient: object) -> float:
    """Of what decides: a real coefficient, or a complex one's real part, as [re, im]."""
    return abs(coefficient) if isinstance(coefficient, float) else abs(cast(list[float], coefficient)[0])


def _drift(jet: Jet, point: Verified, units: Array, scale: Array) -> Array:
    """Estimated errors of the states and the parameter of a point that is solved to rounding, (n + 1,).

    Rounding errors of f, as large as those of its linear part, move the solution by what the inverse makes of them.
    """
    static = jet.A - np.eye(jet.n) if jet.kind == "map" else jet.A
    rounded = ROUNDED * (np.abs(jet.A) @ np.abs(point.z[: jet.n] / units))
    least = SOLVED * scale / units
    try:
        return np.append(least + np.abs(solve(static, rounded)), point.error)
    except np.linalg.LinAlgError:  # singular: nothing is known of the states along the null vector
        return np.append(STATE_ERROR * scale / units, point.error)
