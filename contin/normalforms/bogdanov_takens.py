"""Bogdanov-Takens points (BT): a double zero eigenvalue with one eigenvector, generic or with a reflection symmetry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.normalforms.jet import Jet, Real
from contin.normalforms.linear import normalise, singular_vectors, solve
from contin.normalforms.result import NormalForm, NotThisTypeError
from contin.normalforms.static import StateError, quadratic_error, state, static_matrix


@dataclass(frozen=True, eq=False)
class JordanChain:
    """A q0 = 0, A q1 = q0, A'p1 = 0, A'p0 = p1; |q0| = 1, q0.q1 = 0, p0.q0 = p1.q1 = 1, p0.q1 = p1.q0 = 0."""

    q0: Real
    q1: Real
    p0: Real
    p1: Real


def jordan_chain(matrix: Real, scale: Real | None = None) -> JordanChain:
    """The chain of a double zero eigenvalue; q0's component of largest modulus is positive.

    q1 and p0 come from systems bordered by the null vectors, which are regular although the matrix is singular.
    """
    right, left, _ = singular_vectors(matrix, 1, scale)
    q0, p1 = normalise(right[:, 0].real), normalise(left[:, 0].real)
    q1 = solve(matrix, q0, p1[:, None], q0[:, None])
    p1 = p1 / float(p1 @ q1)
    p0 = solve(matrix.T, p1, q0[:, None], q1[:, None])
    p0 = p0 / float(p0 @ q0)  # 1 up to rounding, since p0.q0 = p0.A q1 = p1.q1
    return JordanChain(q0, q1, p0, p1)


def bogdanov_takens(jet: Jet, *, state_error: StateError = None) -> NormalForm:
    """BT: a = <p1,B(q0,q0)>/2 and b = <p0,B(q0,q0)> + <p1,B(q0,q1)> of w0' = w1, w1' = a w0^2 + b w0 w1.

    Kuznetsov, Elements, 3rd ed., sec. 8.7 (the length of q0 fixes both). Where both vanish to their estimated errors,
    as a reflection w -> -w demands, `kind` is 'Z2-symmetric' and the cubic coefficients of w1' = a3 w0^3 + b3 w0^2 w1
    are added: a3 = <p1, C(q0,q0,q0) + 3 B(q0,h20)>/6,
    b3 = <p0, C(q0,q0,q0) + 3 B(q0,h20)>/2 + <p1, C(q0,q0,q1) + 2 B(q0,h11) + B(q1,h20)>/2 with A h20 = -B(q0,q0),
    A h11 = h20 - B(q0,q1).
    """
    chain = jordan_chain(static_matrix(jet), jet.scale)
    d0, d1 = state(jet, chain.q0), state(jet, chain.q1)
    B00, B01 = jet.form(d0, d0), jet.form(d0, d1)
    if jet.kind == "map":
        raise NotThisTypeError("a double multiplier 1 of a map is a 1:1 resonance (R1), not BT")
    a, b = 0.5 * float(chain.p1 @ B00), float(chain.p0 @ B00 + chain.p1 @ B01)
    error_a = 0.5 * quadratic_error(jet, chain.p1, chain.q0, chain.q0, state_error)
    error_b = quadratic_error(jet, chain.p0, chain.q0, chain.q0, state_error)
    error_b += quadratic_error(jet, chain.p1, chain.q0, chain.q1, state_error)
    coefficients: dict[str, object] = {"a": a, "b": b}
    zero_a, zero_b = abs(a) <= error_a, abs(b) <= error_b
    if zero_a and zero_b:
        coefficients |= {"kind": "Z2-symmetric", **_symmetric(jet, chain)}
        words = "Bogdanov-Takens point with a reflection symmetry"
    elif zero_a or zero_b:
        coefficients["kind"] = "degenerate"
        words = f"degenerate Bogdanov-Takens point: {'a' if zero_a else 'b'} is zero to its estimated error"
    else:
        side = "subcritical (unstable cycles)" if a * b > 0 else "supercritical (stable cycles)"
        coefficients["s"] = 1 if a * b > 0 else -1
        words = f"Bogdanov-Takens point, Hopf curve {side} on the centre manifold"
    vectors = {"q0": chain.q0, "q1": chain.q1, "p0": chain.p0, "p1": chain.p1}
    return NormalForm("BT", coefficients, words, vectors, {"a": error_a, "b": error_b})


def _symmetric(jet: Jet, chain: JordanChain) -> dict[str, float]:
    matrix, (q0, q1, p0, p1) = jet.A, (chain.q0, chain.q1, chain.p0, chain.p1)

    def inverse(rhs: Real) -> Real:
        return np.asarray(solve(matrix, rhs, p1[:, None], p0[:, None]))

    d0, d1 = state(jet, q0), state(jet, q1)
    h20 = inverse(-jet.form(d0, d0))
    h11 = inverse(h20 - jet.form(d0, d1))
    cubic = jet.form(d0, d0, d0) + 3.0 * jet.form(d0, state(jet, h20))
    mixed = jet.form(d0, d0, d1) + 2.0 * jet.form(d0, state(jet, h11)) + jet.form(d1, state(jet, h20))
    return {"a3": float(p1 @ cubic) / 6.0, "b3": 0.5 * float(p0 @ cubic + p1 @ mixed)}
