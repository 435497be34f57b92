"""Codimension-two points of fixed points of maps: GPD, CH and the strong resonances R1 to R4.

Kuznetsov and Meijer, SIAM J. Sci. Comput. 26 (2005) 1932; Kuznetsov, Elements, 3rd ed., ch. 9. At a strong resonance
the map (or its second to fourth iterate) is the unit-time flow of a vector field up to the order of the form; the
coefficients of that field decide.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contin.machine import elementary
from contin.normalforms.bogdanov_takens import jordan_chain
from contin.normalforms.jet import Jet, Real, uncertain
from contin.normalforms.linear import solve
from contin.normalforms.maps import circle_manifold, flip_manifold
from contin.normalforms.result import DEGENERATE, TRUST, NormalForm, parts, sense, side
from contin.normalforms.static import quadratic_error, state


def generalised_flip(jet: Jet) -> NormalForm:
    """GPD: e of w -> -w + e w^5, where the cubic coefficient c is zero.

    A curve of folds of doubled orbits starts there; e > 0: the outer doubled orbit is the stable one.
    """
    manifold = flip_manifold(jet)
    e = manifold.g((5,), 0).real
    error = TRUST * manifold.magnitude((5,), 0)
    coefficients: dict[str, object] = {"e": e, "c": manifold.g((3,), 0).real}
    words = "generalised period doubling"
    if abs(e) <= error:
        coefficients["case"] = DEGENERATE
        words += ", e zero to its estimated error"
    return NormalForm(
        "GPD", coefficients, words, {"q": manifold.right[0].real, "p": manifold.left[0].real}, {"e": error}
    )


def chenciner(jet: Jet, theta: float | None = None) -> NormalForm:
    """CH: l2 = Re d2 + (Im d)^2/2 of w -> e^{i theta} w (1 + d |w|^2 + d2 |w|^4), where Re d = 0.

    |w| -> |w| + l2 |w|^5: l2 < 0: the outer of the two invariant circles is the stable one.
    """
    manifold = circle_manifold(jet, theta)
    value = manifold.values[0]
    d, d2 = manifold.g((2, 1), 0) / value, manifold.g((3, 2), 0) / value
    l2 = d2.real + 0.5 * elementary.square(d.imag)
    error = TRUST * (manifold.magnitude((3, 2), 0) + elementary.square(d.imag))
    outer = {"supercritical": ", outer circle stable", "subcritical": ", outer circle unstable"}
    words = "Chenciner point" + outer.get(sense(l2, error), ", l2 zero to its estimated error")
    theta = float(elementary.angle(value))
    coefficients: dict[str, object] = {"l2": l2, "theta": theta, "d": parts(d), "d2": parts(d2)}
    if abs(l2) <= error:
        coefficients["case"] = DEGENERATE
    return NormalForm("CH", coefficients, words, {"q": manifold.right[0], "p": manifold.left[0]}, {"l2": error})


def resonance_1_1(jet: Jet) -> NormalForm:
    """R1: a, b of w0 -> w0 + w1, w1 -> w1 + a w0^2 + b w0 w1; normalisation of BT with A - 1 for A.

    The map is the unit-time flow of a BT field with coefficients a and b - 2 a; s = sign(a (b - 2 a)): s < 0 means that
    the invariant circle of the Neimark-Sacker curve is stable on the centre manifold.
    """
    chain = jordan_chain(jet.A - np.eye(jet.n), jet.scale)
    d0, d1 = state(jet, chain.q0), state(jet, chain.q1)
    B00, B01 = jet.form(d0, d0), jet.form(d0, d1)
    a, b = 0.5 * float(chain.p1 @ B00), float(chain.p0 @ B00 + chain.p1 @ B01)
    error_b = quadratic_error(jet, chain.p0, chain.q0, chain.q0) + quadratic_error(jet, chain.p1, chain.q0, chain.q1)
    errors = {"a": 0.5 * quadratic_error(jet, chain.p1, chain.q0, chain.q0), "b": error_b}
    slope = b - 2.0 * a
    zero = abs(a) <= errors["a"] or abs(slope) <= errors["b"] + 2.0 * errors["a"]
    s = 0 if zero else int(np.sign(a * slope))
    coefficients: dict[str, object] = {"a": a, "b": b, "s": s}
    if zero:
        coefficients["case"] = DEGENERATE
    vectors = {"q0": chain.q0, "q1": chain.q1, "p0": chain.p0, "p1": chain.p1}
    words = "1:1 resonance, " + ("degenerate: s is zero to its estimated error" if zero else f"s = {s}")
    return NormalForm("R1", coefficients, words, vectors, errors)


def _error(left: Real, off: Real, *terms: Real) -> float:
    """Estimated error of <left, sum of the terms>, of which differences leave `off`."""
    return float(np.abs(left) @ (off + TRUST * sum(np.abs(term) for term in terms)))


def resonance_1_2(jet: Jet) -> NormalForm:
    """R2: C, D of w0 -> -w0 + w1, w1 -> -w1 + C w0^3 + D w0^2 w1 (normalisation of BT with A + 1 for A).

    The second iterate is the unit-time flow of y1' = y2, y2' = C1 y1^3 + D1 y1^2 y2 with C1 = 4 C, D1 = -2 D - 6 C.
    """
    eye = np.eye(jet.n)
    chain = jordan_chain(jet.A + eye, jet.scale)
    d0, d1 = state(jet, chain.q0), state(jet, chain.q1)
    h20 = solve(eye - jet.A, jet.form(d0, d0))
    h11 = solve(eye - jet.A, jet.form(d0, d1) + h20)
    cubic = jet.form(d0, d0, d0), 3.0 * jet.form(d0, state(jet, h20))
    mixed = jet.form(d0, d0, d1), 2.0 * jet.form(d0, state(jet, h11)), jet.form(d1, state(jet, h20))
    C = float(chain.p1 @ sum(cubic)) / 6.0
    D = 0.5 * float(chain.p0 @ sum(cubic) + chain.p1 @ sum(mixed))
    C1, D1 = 4.0 * C, -2.0 * D - 6.0 * C
    off_cubic = uncertain(jet, d0, d0, d0) + 3.0 * uncertain(jet, d0, state(jet, h20))
    off_mixed = uncertain(jet, d0, d0, d1) + 2.0 * uncertain(jet, d0, state(jet, h11))
    off_mixed += uncertain(jet, d1, state(jet, h20))
    error_C = _error(chain.p1, off_cubic, *cubic) / 6.0
    error_D = 0.5 * (_error(chain.p0, off_cubic, *cubic) + _error(chain.p1, off_mixed, *mixed))
    errors = {"C": error_C, "D": error_D}
    errors |= {"C1": 4.0 * errors["C"], "D1": 2.0 * errors["D"] + 6.0 * errors["C"]}
    vectors = {"q0": chain.q0, "q1": chain.q1, "p0": chain.p0, "p1": chain.p1}
    signs = {"C1": side(C1, errors["C1"]), "D1": side(D1, errors["D1"])}
    case = _case(signs)
    coefficients = {"C": C, "D": D, "C1": C1, "D1": D1, "case": case}
    return NormalForm("R2", coefficients, f"1:2 resonance, {case}", vectors, errors)


def _case(signs: Mapping[str, str | None]) -> str:
    """`C1 > 0, D1 < 0`, or which of them are zero to their errors, and the signs of the others."""
    zero = [name for name, sign in signs.items() if sign is None]
    known = [f"{name} {sign}" for name, sign in signs.items() if sign is not None]
    if not zero:
        return ", ".join(known)
    text = f"{DEGENERATE}: {' and '.join(zero)} zero to {'its error' if len(zero) == 1 else 'their errors'}"
    return ", ".join([text, *known])


def resonance_1_3(jet: Jet) -> NormalForm:
    """R3: B, C of w -> e^{2 pi i/3} w + B conj(w)^2 + C w |w|^2, and a = Re C1/|B1|^2.

    The third iterate is the unit-time flow of z' = B1 conj(z)^2 + C1 z |z|^2 with B1 = 3 e^{-2 pi i/3} B,
    C1 = 3 e^{-2 pi i/3} C - 3 |B|^2. a < 0: the invariant circle is stable on the centre manifold.
    """
    manifold = circle_manifold(jet, 2.0 * np.pi / 3.0)
    back = np.conj(manifold.values[0])
    B, C = manifold.g((0, 2), 0), manifold.g((2, 1), 0)
    B1, C1 = 3.0 * back * B, 3.0 * back * C - 3.0 * elementary.square(abs(B))
    coefficients: dict[str, object] = {"B": parts(B), "C": parts(C), "B1": parts(B1), "C1": parts(C1)}
    errors = {"B": TRUST * manifold.magnitude((0, 2), 0), "C": TRUST * manifold.magnitude((2, 1), 0)}
    error_of_square = 2.0 * abs(B) * errors["B"] + TRUST * elementary.square(abs(B))
    errors |= {"B1": 3.0 * errors["B"], "C1": 3.0 * (errors["C"] + error_of_square)}
    if abs(B) > errors["B"]:
        a = float(C1.real / elementary.square(abs(B1)))
        errors["a"] = float((errors["C1"] + 2.0 * abs(C1) * errors["B"] / abs(B)) / elementary.square(abs(B1)))
        stable = side(a, errors["a"], "invariant circle unstable", "invariant circle stable")
        coefficients |= {"a": a, "case": stable or f"{DEGENERATE}: a is zero to its estimated error"}
    else:
        coefficients["case"] = f"{DEGENERATE}: B is zero to its estimated error"
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("R3", coefficients, f"1:3 resonance, {coefficients['case']}", vectors, errors)


def resonance_1_4(jet: Jet) -> NormalForm:
    """R4: C, D of w -> i w + C w |w|^2 + D conj(w)^3, and A0 = C1/|D1|.

    The fourth iterate is the unit-time flow of z' = C1 z |z|^2 + D1 conj(z)^3 with C1 = -4 i C, D1 = -4 i D. |A0| < 1:
    four further fixed points of the fourth iterate surround the point for all parameters near it; > 1: none or eight.
    """
    manifold = circle_manifold(jet, 0.5 * np.pi)
    C, D = manifold.g((2, 1), 0), manifold.g((0, 3), 0)
    C1, D1 = -4.0j * C, -4.0j * D
    coefficients: dict[str, object] = {"C": parts(C), "D": parts(D), "C1": parts(C1), "D1": parts(D1)}
    errors = {"C": TRUST * manifold.magnitude((2, 1), 0), "D": TRUST * manifold.magnitude((0, 3), 0)}
    errors |= {"C1": 4.0 * errors["C"], "D1": 4.0 * errors["D"]}
    if abs(D) > errors["D"]:
        A0 = C1 / abs(D1)
        errors["A0"] = (errors["C1"] + abs(A0) * errors["D1"]) / abs(D1)
        beside = side(abs(A0) - 1.0, errors["A0"], "|A0| > 1", "|A0| < 1") or f"{DEGENERATE}: |A0| is 1 to its error"
        circle = side(A0.real, errors["A0"], "Re A0 > 0", "Re A0 < 0")
        case = beside if circle else f"{beside}, {DEGENERATE}: Re A0 zero to its error"
        coefficients |= {"A0": parts(A0), "case": case}
    else:
        coefficients["case"] = f"{DEGENERATE}: D is zero to its estimated error"
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("R4", coefficients, f"1:4 resonance, {coefficients['case']}", vectors, errors)
