"""Normal forms of points of codimension two of large systems.

CP and BT from bordered solves. The others need forms of higher order and many solves: they are computed with the dense
methods where the system is small enough for that, else with sparse factors (`large_forms`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.outcome import Verified
from contin.linalg.linear import Linear, moving
from contin.loci.sparse.forced import is_forced
from contin.loci.sparse.large_forms import DENSE, large_form
from contin.normalforms.invariant_plane import zero_hopf_on_plane
from contin.normalforms.jet import DerivativeJet
from contin.normalforms.linear import null_pair
from contin.normalforms.point import normal_form as dense_form
from contin.normalforms.result import NO_FORM, NotThisTypeError
from contin.problems.algebraic_states import UNIT
from contin.problems.sparse.forms import Derivatives, state, unit, with_errors
from contin.records import Fields

if TYPE_CHECKING:
    from contin.loci.sparse.on_large_curve import OnLargeCurve
    from contin.systems.functions.function_system import FunctionSystem


def with_normal_form(
    problem: OnLargeCurve, point: Verified, known: Fields, widths: Array, drift: Array
) -> Verified:  # fmt: skip
    """The point with coefficients (FORMATS' names) and vectors; with a remark in place of what cannot be computed.

    widths : scales of the second and of the first parameter.  drift : by how much the point's unknowns may be off.
    """
    vectors: Fields = {}
    try:
        if point.type == "CP":
            form = cusp(problem, point.z)
        elif point.type == "BT":
            form, vectors = takens(problem, point.z)
        elif _by_dense_methods(problem, point):
            form = _dense(problem, point.type, point.z, known, widths)
        else:
            form = large_form(problem, point.type, point.z, known, widths, drift)
    except NO_FORM as reason:
        remark = f"{point.type}: its normal form could not be computed ({reason})"
        return replace(point, vectors=known, remark=remark)
    return replace(point, normal_form=form, vectors=known | vectors)


def cusp(problem: OnLargeCurve, z: Array) -> Fields:
    """c = <p, C(q,q,q) + 3 B(q,h)>/6, A h = -B(q,q), <p, M h> = 0, <p, M q> = 1, |q| = 1 (Kuznetsov, sec. 8.7)."""
    branch, point = problem.curve.branch(z)
    line = problem.curve.folds_at(z).at
    linear = problem.curve.linear_at(z)
    q, weigh = unit(linear, np.real(line.v)), linear.weigh
    size = float(np.real(line.functional(weigh(q))))
    direction = state(q)

    def coefficients(form: Derivatives) -> dict[str, float]:
        h = -np.real(line.residue(form(direction, direction))[0])
        h = h - float(np.real(line.functional(weigh(h)))) / size * q
        cubic = form(direction, direction, direction) + 3.0 * form(direction, state(h))
        return {"c": float(np.real(line.functional(cubic))) / size / 6.0}

    found, errors = with_errors(branch, point, coefficients)
    return {**found, "errors": errors}


def takens(problem: OnLargeCurve, z: Array) -> tuple[Fields, Fields]:
    """a = <p1, B(q0,q0)>/2, b = <p0, B(q0,q0)> + <p1, B(q0,q1)> (Kuznetsov, sec. 8.7); |q0| = 1, q0.q1 = 0
    over the states with mass.

    `s` = sign(a b), where both differ from zero by more than their errors, else `kind` says that it is degenerate.
    """
    branch, point = problem.curve.branch(z)
    line = problem.curve.folds_at(z).at
    linear = problem.curve.linear_at(z)
    q0, weigh, counted = unit(linear, np.real(line.v)), linear.weigh, moving(linear)
    q1 = np.real(line.residue(weigh(q0))[0])
    q1 = q1 - (q0[counted] @ q1[counted]) * q0
    size = float(np.real(line.functional(weigh(q1))))

    def p1(r: Array) -> float:
        return float(np.real(line.functional(r))) / size

    def p0(r: Array) -> float:
        """<p0, r> = <p1, M x> with A x = r - <p1, r> M q1, since A^T p0 = M^T p1 and p0.M q1 = 0."""
        return p1(weigh(np.real(line.residue(r - p1(r) * weigh(q1))[0])))

    def coefficients(form: Derivatives) -> dict[str, float]:
        b00, b01 = form(state(q0), state(q0)), form(state(q0), state(q1))
        return {"a": 0.5 * p1(b00), "b": p0(b00) + p1(b01)}

    found, errors = with_errors(branch, point, coefficients)
    known = abs(found["a"]) > errors["a"] and abs(found["b"]) > errors["b"]
    sign: Fields = {"s": 1 if found["a"] * found["b"] > 0.0 else -1} if known else {"kind": "degenerate"}
    return {**found, **sign, "errors": errors}, {"null": q0, "generalised": q1}


def _by_dense_methods(problem: OnLargeCurve, point: Verified) -> bool:
    """Those do not know invariant planes of equations with a mass matrix."""
    linear = problem.curve.linear_at(point.z)
    planes = point.type == "ZH" and problem.locus == "HB"
    return problem.n <= DENSE and (linear.mass is None or linear.matrix is None or not planes)


def _dense(problem: OnLargeCurve, type_: str, z: Array, known: Fields, widths: Array) -> Fields:
    branch, point = problem.curve.branch(z)
    linear = problem.curve.linear_at(z)
    matrix = _entries(linear, problem.n)
    omegas = known["omegas"]
    frequency = max(omegas) if omegas and type_ != "HH" else None
    if type_ == "ZH" and problem.locus == "HB" and _on_plane(problem, z, matrix, widths):
        if linear.mass is not None:
            raise NotThisTypeError("with a mass matrix, on an invariant plane: it needs the Jacobian's entries")
        form = zero_hopf_on_plane(_in_both_parameters(problem, z, matrix), frequency)
    else:

        def jet_of(system: FunctionSystem | None, otherwise: tuple[DerivativeJet, ...] = ()) -> DerivativeJet:
            def derivative(directions: tuple[Array, ...]) -> Array:
                return np.real(branch.form(point, *map(state, directions), system=system))

            return DerivativeJet(matrix, derivative, 0, "flow", otherwise=otherwise)

        jet = jet_of(None, tuple(jet_of(other) for other in branch.system.with_other_differences()))
        jet = jet if linear.mass is None else _weighed(jet, linear)
        form = dense_form(type_, jet, frequency=frequency)
    return dict(form.coefficients) | ({"errors": dict(form.errors)} if form.errors else {})


def _weighed(jet: DerivativeJet, linear: Linear) -> DerivativeJet:
    """The jet of M u' = F, in units in which states without mass count nothing in the length of a vector."""
    units = np.full(jet.n, UNIT)
    units[moving(linear)] = 1.0

    def derivative(directions: tuple[Array, ...]) -> Array:
        return np.real(jet.form(*(d * units for d in directions)))

    others = tuple(_weighed(other, linear) for other in jet.otherwise)
    return DerivativeJet(jet.A * units, derivative, 0, "flow", mass=linear.mass.toarray() * units, otherwise=others)


def _on_plane(problem: OnLargeCurve, z: Array, matrix: Array, widths: Array) -> bool:
    linear = problem.curve.linear_at(z)
    mass = None if linear.mass is None else linear.mass.toarray()
    return is_forced(problem, z, linear, null_pair(matrix, mass=mass), widths)


def _in_both_parameters(problem: OnLargeCurve, z: Array, matrix: Array) -> DerivativeJet:
    """Derivatives in the states, the first and the second parameter."""
    curve, n = problem.curve, problem.n
    system, p = curve.origin.system, curve.full_parameters(z)

    def derivative(directions: Sequence[Array]) -> Array:
        wide = np.zeros((len(directions), n + system.m))
        for row, d in zip(wide, directions, strict=True):
            row[:n], row[[n + curve.first, n + curve.second]] = d[:n], d[n:]
        return np.real(system.derivative(z[:n], p, *wide))

    return DerivativeJet(matrix, derivative, 2, "flow")


def _entries(linear: Any, n: int) -> Vector:
    if linear.matrix is not None:
        return np.asarray(linear.matrix.toarray())
    return np.column_stack([linear.apply(column) for column in np.eye(n)])
