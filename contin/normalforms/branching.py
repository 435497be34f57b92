"""Simple branch points (BP): kind, coefficients, criticality, and the tangents and curvatures of both branches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.normalforms.jet import Jet, Real, along_units, lift, size_of_terms, uncertain
from contin.normalforms.linear import solve
from contin.normalforms.reduction import Reduction, reduce
from contin.normalforms.result import NO_ERRORS, TRUST, Errors, NormalForm
from contin.normalforms.static import (
    ROUNDING,
    StateError,
    quadratic_error,
    second_order_error,
    state,
    state_lengths,
    static_matrix,
)


@dataclass(frozen=True, eq=False)
class Direction:
    """A branch through the point: z0 + s tangent + s^2 curvature + O(s^3), z = (u, p), |tangent| = 1.

    `vertical` marks a branch along which the parameter has an extremum at the point (a pitchfork's side branch);
    `primary` the branch along which the kernel state is driven by the parameter (for a known branch: that one).
    """

    tangent: Real  # (n + 1,)
    curvature: Real  # (n + 1,)
    vertical: bool
    primary: bool
    note: str = ""

    def predict(self, s: float) -> Real:
        """z - z0 at signed distance s."""
        return s * self.tangent + s * s * self.curvature


def branch_point(
    jet: Jet,
    *,
    state_error: StateError = None,
    parameter_error: float = 0.0,
    reduction: Reduction | None = None,
    further: Errors = NO_ERRORS,
) -> NormalForm:
    """BP with a one-dimensional kernel: a01 dp + a02/2 dp^2 + b11 x dp + b20/2 x^2 + b30/6 x^3 = 0 (FORMATS).

    Pitchfork where b20 is zero to its estimated error: rounding in <p, B(q, q)> (from the magnitudes of its summands)
    plus what an error `state_error` of the states (a length, or one for each state; by default 1e-10 of their typical
    sizes) makes through the third derivative, and what else it is off by, `further`.
    Supercritical where b30 < 0: since <p, q> = 1, the reduced equation is the motion on the centre manifold,
    x' = b11 dp x + b30/6 x^3, so x^2 = -6 b11 dp/b30 lies where b11 dp > 0, the side on which the primary branch has
    the extra unstable eigenvalue, and the new branch has x' = -2 b11 dp x there: it takes over the stability.
    `discriminant` = b11^2 - a02 b20 > 0 where two branches cross; negative: an isolated point; zero to its error: the
    two have one tangent (a tangency), or, where b20 and b11 are both zero, higher orders decide what happens.
    """
    r = reduction or reduce(jet, 1)
    q, p = r.right[:, 0], r.left[:, 0]
    if parameter_error > 0.0:  # as far as that the states move along the branch too
        state_error = state_lengths(jet, state_error) + parameter_error * np.abs(r.h)
    (b20, b11), (_, a02) = r.T2[0].tolist()
    a01, b30 = float(r.a01[0]), float(r.T3[0, 0, 0, 0])
    errors = _errors(jet, r, state_error, parameter_error, further)
    discriminant = b11 * b11 - a02 * b20
    coefficients: dict[str, object] = {"kind": "", "a01": a01, "a02": a02, "b11": b11, "b20": b20, "b30": b30}
    if abs(b20) <= errors["b20"] and abs(b11) > errors["b11"]:
        criticality = "degenerate" if abs(b30) <= errors["b30"] else "supercritical" if b30 < 0 else "subcritical"
        coefficients |= {"kind": "pitchfork", "criticality": criticality}
        words = f"{criticality} pitchfork"
    elif abs(b20) <= errors["b20"]:
        coefficients["kind"] = "degenerate"
        words = "degenerate branch point: the quadratic terms are zero to their errors"
    elif discriminant > errors["discriminant"]:
        coefficients["kind"] = "transcritical"
        words = "transcritical branch point: two branches cross and exchange stability"
    elif discriminant >= -errors["discriminant"]:
        coefficients["kind"] = "tangency"
        words = "branch point where two branches have one tangent"
    else:
        coefficients["kind"] = "isolated"
        words = "isolated solution: the quadratic form is definite, no second branch passes"
    coefficients["discriminant"] = discriminant
    return NormalForm("BP", coefficients, words, {"q": q, "p": p, "h": r.h}, errors)


def _errors(
    jet: Jet, r: Reduction, state_error: StateError, parameter_error: float, further: Errors
) -> dict[str, float]:  # fmt: skip
    """Estimated errors of the coefficients of the reduced equation."""
    q, p = r.right[:, 0], r.left[:, 0]
    drift = np.append(state_lengths(jet, state_error), parameter_error)
    kernel, response = r.lifted[0], r.lifted[1]
    along, parameter = state(jet, r.h), lift(np.zeros(jet.n), 1, 0)
    (b20, b11), (_, a02) = r.T2[0].tolist()
    errors = {
        "a01": second_order_error(jet, p, ((1.0, (parameter,)),), (parameter,), drift),
        "a02": second_order_error(
            jet, p, ((1.0, (parameter, parameter)), (2.0, (parameter, along)), (1.0, (along, along))),
            (response, response), drift,
        ),
        "b11": second_order_error(
            jet, p, ((1.0, (kernel, parameter)), (1.0, (kernel, along))), (kernel, response), drift
        ),
        "b20": quadratic_error(jet, p, q, q, state_error)
        + parameter_error * abs(float(p @ jet.form(kernel, kernel, parameter))),
        "b30": _b30_error(jet, r) + _unseen(jet, q, b11, parameter_error),
    }  # fmt: skip
    errors = {key: error + further.get(key, 0.0) for key, error in errors.items()}
    errors["discriminant"] = (
        (2.0 * abs(b11) + errors["b11"]) * errors["b11"]
        + abs(a02) * errors["b20"]
        + (abs(b20) + errors["b20"]) * errors["a02"]
    )
    return errors


def simple_directions(r: Reduction, *, known: Real | None = None, b20_error: float = 0.0) -> list[Direction]:
    """Both branches at a simple branch point, the primary one first; none where the discriminant is negative.

    The roots y = (x, dp) of b20 x^2 + 2 b11 x dp + a02 dp^2 = 0 are taken as (t, b20) and (a02, t) with
    t = -(b11 + sign(b11) sqrt(discriminant)), which is exact for vertical (b20 = 0) and horizontal (a02 = 0) branches.
    With `known`, the tangent of the branch at hand, that one is primary.
    """
    (b20, b11), (_, a02) = r.T2[0]
    if abs(b20) <= b20_error:
        b20 = 0.0
    discriminant = b11 * b11 - a02 * b20
    if not discriminant > 0.0:
        return []
    t = -(b11 + np.copysign(np.sqrt(discriminant), b11))
    roots = [np.array([a02, t]), np.array([t, b20])]  # for b20 = 0: the primary branch, the vertical one
    directions = [_direction(r, y) for y in roots]
    order = [0, 1]
    if known is not None:
        match = [_alignment(r, y, known) for y in roots]
        order = [0, 1] if match[0] >= match[1] else [1, 0]
    elif b20 != 0.0 and abs(roots[1][1]) * _length(r, roots[0]) > abs(roots[0][1]) * _length(r, roots[1]):
        order = [1, 0]
    first, second = (directions[i] for i in order)
    return [
        Direction(first.tangent, first.curvature, first.vertical, True, first.note),
        Direction(second.tangent, second.curvature, second.vertical, False, second.note),
    ]


def _direction(r: Reduction, y: Real) -> Direction:
    """Tangent and curvature of the branch with reduced direction y: T2[y, y2] = -T3[y, y, y]/6, y2 across y.

    Where the branch is not vertical, y2 has no dp part, so s stays proportional to the parameter; where it is
    vertical, y2 = (0, p2) with p2 = -b30/(6 b11): the pitchfork's parabola.
    """
    y = y / np.linalg.norm(y @ r.lifted)
    vertical = y[1] == 0.0
    if y[0] < 0.0 if vertical else y[1] < 0.0:
        y = -y
    cubic = float(np.einsum("ijk,i,j,k", r.T3[0], y, y, y))
    across = np.array([0.0, 1.0]) if vertical else np.array([1.0, 0.0])
    y2 = -cubic / 6.0 / float(y @ r.T2[0] @ across) * across
    tangent, curvature = r.predictor(y, y2)
    return Direction(tangent, curvature, bool(vertical), False)


def _alignment(r: Reduction, y: Real, known: Real) -> float:
    a, b = r.coordinates(known), y
    scale = np.linalg.norm(r.lifted, axis=1)  # lengths of (q, 0) and (h, 1): reduced coordinates in equal units
    a, b = a * scale, b * scale
    return float(abs(a @ b) / (np.linalg.norm(a) * np.linalg.norm(b)))


def _length(r: Reduction, y: Real) -> float:
    return float(np.linalg.norm(y @ r.lifted))


def _unseen(jet: Jet, q: Real, b11: float, parameter_error: float) -> float:
    """b30 of a branch that, out to a state's typical size, moves the parameter by no more than its error."""
    if jet.scale is None:
        return 0.0
    length = 1.0 / float(np.max(np.abs(q) / jet.scale))
    return 6.0 * abs(b11) * parameter_error / (length * length)


def _b30_error(jet: Jet, r: Reduction) -> float:
    """Estimated error of <p, C(q, q, q) + 3 B(q, h20)>: cancellation, that of differences, and what is off in h20.

    A h20 = -B(q, q), whose terms may cancel: where they do, h20 is made of their rounding, and so is b30. With w the
    solution of A^T w = p B(q, .) (bordered as A is), <p, B(q, dh)> is w times what is off in B(q, q).
    """
    q, p = state(jet, r.right[:, 0]), np.abs(r.left[:, 0])
    terms = (1.0, (q, q, q)), (3.0, (q, state(jet, r.second[0, 0])))
    size = sum(weight * np.abs(jet.form(*given)) for weight, given in terms)
    noise = sum(weight * uncertain(jet, *given) + ROUNDING * size_of_terms(jet, *given) for weight, given in terms)
    driven = along_units(jet, q)[: jet.n] @ r.left[:, 0]
    try:
        back = np.abs(solve(static_matrix(jet).T, driven, r.left, r.right))
    except np.linalg.LinAlgError:  # singular to rounding beyond the kernel: nothing is known of h20
        return float(p @ size)
    off = back @ (uncertain(jet, q, q) + ROUNDING * size_of_terms(jet, q, q))
    return float(p @ (TRUST * size + noise) + 3.0 * off)
