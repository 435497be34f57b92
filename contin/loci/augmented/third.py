"""On curves of points of codimension two in three parameters: where a third degeneracy is met.

CP  SW: the cubic coefficient vanishes.      BT: a second zero eigenvalue (a = 0 there).
BT  DBT: a or b vanishes.                    TZ: a third zero eigenvalue.
GH  DGH: l2 vanishes.
BP  DBP: the reduced equation's Hessian is degenerate, or b20 vanishes (a pitchfork).
All of them: FZ, FH: a further eigenvalue is zero, a further pair imaginary.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.outcome import NOTHING, Outcome, Verified
from contin.continuation.sample import Sample
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.one_event import one_event
from contin.loci.codim2.forms import jet_at
from contin.loci.codim2.functions import critical_indices
from contin.loci.codim2.matrices import eigenvalues, own_critical, scaled_matrix
from contin.loci.codim2.monitors import pair_test, real_test
from contin.loci.tolerances import REAL
from contin.machine import elementary
from contin.normalforms.branching import branch_point
from contin.normalforms.point import normal_form
from contin.normalforms.result import NO_FORM, NormalForm

if TYPE_CHECKING:
    from contin.loci.equilibria.equilibrium_locus import LocusProblem

COUNTS: Final = {"FZ": 1, "TZ": 1, "BT": 1, "FH": 2}  # eigenvalues that change sides
TYPES: Final = {  # of curve -> what is looked for, in the order of its tests
    "CP": ("SW", "BT", "FH"), "BT": ("DBT", "DBT", "TZ", "FH"), "GH": ("DGH", "FZ", "FH"), "ZH": ("FZ", "FH"),
    "HH": ("FZ", "FH"), "BP": ("DBP", "DBP", "FZ", "FH"),
}  # fmt: skip
NAMES: Final = {  # where two functions belong to one type: what the engine watches
    "BT": ("DBT", "DBT:b", "TZ", "FH"), "BP": ("DBP", "DBP:b20", "FZ", "FH"),
}  # fmt: skip

TYPE_OF: Final = {  # of what the engine watches
    name: type_ for curve, known in TYPES.items() for name, type_ in zip(NAMES.get(curve, known), known, strict=True)
}

VANISHING: Final = {"SW": "c", "DBT": "a", "DBT:b": "b", "DGH": "l2", "DBP:b20": "b20"}  # the coefficient that is zero
OWN: Final = frozenset({*VANISHING, "BT", "DBP"})  # zeros of functions of the curve's own critical eigenvectors


def types(curve: str) -> Sequence[str]:
    """What is watched on a curve, in the order of its tests."""
    return NAMES.get(curve, TYPES.get(curve, ()))


def tests_at(problem: LocusProblem, curve: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
    """Tests from index 2 on, the number of unstable eigenvalues without the critical ones, and all of them."""
    values = eigenvalues(problem, z)
    others = np.delete(values, _critical(problem, curve, z, values))
    zero = real_test(others, 0.0, float(np.abs(values).max(initial=0.0)))
    further = {"FZ": zero, "TZ": zero, "FH": pair_test(others, False)}
    if len(others) < 2:
        further["FH"] = 1.0
    found = [further[name] if name in further else _value(problem, curve, name, z) for name in types(curve)]
    return np.array(found), int(np.sum(others.real > 0.0)), values


def _critical(problem: LocusProblem, curve: str, z: Array, values: Vector) -> list[int]:
    """Indices of the eigenvalues that are critical along the curve."""
    if curve not in TYPES or curve == "BP":  # no more than on curves in two parameters
        return own_critical(problem, z, values)
    return critical_indices(problem, curve, z, values) or []


def _value(problem: LocusProblem, curve: str, name: str, z: Array) -> float:
    """A test along the curve, NaN where it has no value."""
    try:
        return _own(problem, curve, name, z)(z)
    except NO_FORM:  # a test without a value has no sign: nothing is labelled by it there, and the curve goes on
        return float("nan")


def _own(problem: LocusProblem, curve: str, name: str, near: Array) -> Callable[[Array], float]:
    """A degeneracy of the normal form as a function near the curve, oriented by the curve's borders."""
    if (curve, name) == ("CP", "SW"):
        return _with_borders(problem, near, lambda z, v, psi, solve: _cubic(problem, z, v, psi, solve))
    if (curve, name) == ("CP", "BT"):
        return _with_borders(problem, near, lambda z, v, psi, solve: float(psi @ v))
    if curve == "BT":
        return lambda z: _jordan(problem, z)[VANISHING[name]]
    if name == "DGH":
        return lambda z: float(_form(problem, "GH", z).coefficients["l2"])
    return lambda z: _hessian(problem, z)[name]


Solve = Callable[[Array], Array]


def _with_borders(
    problem: LocusProblem, near: Array, value: Callable[[Array, Array, Array, Solve], float]
) -> Callable[[Array], float]:
    """value(z, v, psi, A^-1) from [A b; c^T 0] with the curve's own borders."""
    borders, n = problem.curve.parameters(near), problem.n
    shift = np.eye(n) if problem.system.kind == "map" else 0.0

    def function(z: Array) -> float:
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = scaled_matrix(problem, z) - shift
        matrix[:n, n], matrix[n, :n] = borders.left[:, 0], borders.right[:n, 0]
        try:
            inverse = np.asarray(np.linalg.inv(matrix), dtype=float)
        except np.linalg.LinAlgError:  # no value there
            return float("nan")
        return value(z, inverse[:n, n], inverse[n, :n], lambda right: inverse[:n, :n] @ right)

    return function


def _cubic(problem: LocusProblem, z: Array, v: Array, psi: Array, solve: Solve) -> float:
    """<psi, C(v, v, v) + 3 B(v, h)> with A h = -B(v, v), in scaled states."""
    curve, n = problem.curve, problem.n
    d, p = curve.sizes, curve.full_parameters(z)

    def form(*directions: Array) -> Array:
        wide = np.zeros((len(directions), n + len(p)))
        wide[:, :n] = np.array(directions) * d
        return np.asarray(curve.system.derivative(z[:n], p, *wide) / d)

    h = -solve(form(v, v))
    return float(psi @ (form(v, v, v) + 3.0 * form(v, h)))


def _form(problem: LocusProblem, type_: str, z: Array) -> NormalForm:
    kappa = problem.curve.scalar(z) if problem.locus == "HB" else 0.0
    frequency = float(np.sqrt(kappa)) if kappa > 0.0 else None
    return normal_form(type_, jet_at(problem, z), frequency=frequency)


def _jordan(problem: LocusProblem, z: Array) -> dict[str, float]:
    """a and b of a Bogdanov-Takens point, with q0 along the curve's border."""
    found = normal_form("BT", jet_at(problem, z))
    along = float(np.asarray(found.vectors["q0"]) / problem.curve.sizes @ problem.curve.reference(z))
    sense = 1.0 if along > 0.0 else -1.0
    return {key: sense * float(found.coefficients[key]) for key in ("a", "b")}


def _hessian(problem: LocusProblem, z: Array) -> dict[str, float]:
    """a02 b20 - b11^2 of the reduced equation in the first parameter, and b20 with q along the curve's border."""
    form = branch_point(jet_at(problem, z, (problem.curve.first,)))
    found = form.coefficients
    a02, b11, b20 = (float(found[key]) for key in ("a02", "b11", "b20"))
    along = float(np.asarray(form.vectors["q"]) / problem.curve.sizes @ problem.curve.reference(z))
    return {"DBP": a02 * b20 - elementary.square(b11), "DBP:b20": b20 if along > 0.0 else -b20}


def explain(curve: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
    """The event that explains what changed between two points; None where one does not."""
    known = types(curve)
    return one_event(known, [COUNTS.get(name, 0) for name in known], a, b)


def function_of(problem: LocusProblem, curve: str, name: str, z0: Array) -> Scalars | str:
    """The function that vanishes at a point on a curve; or why there is none."""
    if name in OWN:
        own = _own(problem, curve, name, z0)

        def value(z: Array) -> Array:
            try:
                return np.array([own(z)])
            except NO_FORM:  # no value: Newton ends, and the point is not verified, in words
                return np.full(1, np.nan)

        return value
    if name == "TZ":
        return lambda z: np.array([_third_coefficient(problem, z)])
    values = eigenvalues(problem, z0)
    others, size = np.delete(values, _critical(problem, curve, z0, values)), float(np.abs(values).max())
    real = np.abs(others.imag) <= REAL * size
    chosen = others[real] if name == "FZ" else others[~real]
    if curve in ("BP", "ZH") and name == "FZ":
        return "two zero eigenvalues, a point more degenerate than can be solved for here"
    if not chosen.size:
        return "the critical eigenvalues are real" if name == "FH" else "no other real eigenvalue is near 0"
    reference = complex(chosen[int(np.argmin(np.abs(chosen.real)))])

    def part(z: Array) -> Array:
        now = eigenvalues(problem, z)
        return np.array([float(now[int(np.argmin(np.abs(now - reference)))].real) / size])

    return part


def _third_coefficient(problem: LocusProblem, z: Array) -> float:
    """Of the characteristic polynomial of f_u, relative to its size: zero where three eigenvalues are."""
    matrix = scaled_matrix(problem, z)
    return float(np.poly(matrix / np.linalg.norm(matrix))[-3])


def described(problem: LocusProblem, curve: str, point: Verified) -> Outcome:
    """The point with its eigenvalues and the coefficients that the curve's own points have there."""
    name, z = point.type, point.z
    if name == "FH" and not _has_pair(problem, curve, z):
        return NOTHING
    type_ = TYPE_OF[name]
    values = eigenvalues(problem, z)
    rest = len(_critical(problem, curve, z, values))
    more = COUNTS.get(type_, 0)
    order = np.argsort(np.abs(values.real))
    others = values[order[rest + more :]]
    form: dict[str, object] = {"on": curve}
    try:
        found = branch_point(jet_at(problem, z, (problem.curve.first,))) if curve == "BP" else (
            _form(problem, "BT" if type_ == "BT" else curve, z)
        )  # fmt: skip
        form |= _without_rounding(name, dict(found.coefficients), dict(found.errors))
        remark = ""
    except NO_FORM as reason:
        remark = f"{type_}: its coefficients could not be computed ({reason})"
    form.pop("kind", None)
    return replace(
        point, type=type_, normal_form=form, remark=remark, eigenvalues=values, unstable=int(np.sum(others.real > 0.0))
    )


def _without_rounding(name: str, coefficients: dict[str, object], errors: dict[str, float]) -> dict[str, object]:
    """Coefficients with their errors; the one that the condition makes zero is 0, and what is left of it its error."""
    zero = VANISHING.get(name)
    if zero in coefficients:
        left = abs(float(cast("float", coefficients[zero])))
        coefficients, errors = coefficients | {zero: 0.0}, errors | {zero: max(left, errors.get(zero, 0.0))}
    return coefficients | ({"errors": errors} if errors else {})


def _has_pair(problem: LocusProblem, curve: str, z: Array) -> bool:
    """False where the further pair is real: a neutral saddle."""
    values = eigenvalues(problem, z)
    others = np.delete(values, _critical(problem, curve, z, values))
    size = float(np.abs(values).max())
    return bool(np.any((np.abs(others.imag) > REAL * size) & (np.abs(others.real) < 1e-6 * size)))
