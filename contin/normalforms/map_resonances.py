"""Codimension-two points of fixed points of maps: GPD, CH and the strong resonances R1 to R4.

Kuznetsov and Meijer, SIAM J. Sci. Comput. 26 (2005) 1932; Kuznetsov, Elements, 3rd ed., ch. 9. At a strong resonance
the map (or its second to fourth iterate) is the unit-time flow of a vector field up to the order of the form; the
coefficients of that field decide.
"""

from __future__ import annotations

import numpy as np

from contin.machine import elementary
from contin.normalforms.bogdanov_takens import jordan_chain
from contin.normalforms.jet import Jet
from contin.normalforms.linear import solve
from contin.normalforms.maps import circle_manifold, flip_manifold
from contin.normalforms.result import TRUST, NormalForm, parts, sense
from contin.normalforms.static import state


def generalised_flip(jet: Jet) -> NormalForm:
    """GPD: e of w -> -w + e w^5, where the cubic coefficient c is zero.

    A curve of folds of doubled orbits starts there; e > 0: the outer doubled orbit is the stable one.
    """
    manifold = flip_manifold(jet)
    e = manifold.g((5,), 0).real
    error = TRUST * manifold.magnitude((5,), 0)
    coefficients = {"e": e, "c": manifold.g((3,), 0).real}
    words = "generalised period doubling" + (", e zero to its estimated error" if abs(e) <= error else "")
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
    coefficients = {"l2": l2, "theta": float(elementary.angle(value)), "d": parts(d), "d2": parts(d2)}
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
    s = int(np.sign(a * (b - 2.0 * a)))
    vectors = {"q0": chain.q0, "q1": chain.q1, "p0": chain.p0, "p1": chain.p1}
    return NormalForm("R1", {"a": a, "b": b, "s": s}, f"1:1 resonance, s = {s}", vectors)


def resonance_1_2(jet: Jet) -> NormalForm:
    """R2: C, D of w0 -> -w0 + w1, w1 -> -w1 + C w0^3 + D w0^2 w1 (normalisation of BT with A + 1 for A).

    The second iterate is the unit-time flow of y1' = y2, y2' = C1 y1^3 + D1 y1^2 y2 with C1 = 4 C, D1 = -2 D - 6 C.
    """
    eye = np.eye(jet.n)
    chain = jordan_chain(jet.A + eye, jet.scale)
    d0, d1 = state(jet, chain.q0), state(jet, chain.q1)
    h20 = solve(eye - jet.A, jet.form(d0, d0))
    h11 = solve(eye - jet.A, jet.form(d0, d1) + h20)
    cubic = jet.form(d0, d0, d0) + 3.0 * jet.form(d0, state(jet, h20))
    mixed = jet.form(d0, d0, d1) + 2.0 * jet.form(d0, state(jet, h11)) + jet.form(d1, state(jet, h20))
    C = float(chain.p1 @ cubic) / 6.0
    D = 0.5 * float(chain.p0 @ cubic + chain.p1 @ mixed)
    C1, D1 = 4.0 * C, -2.0 * D - 6.0 * C
    vectors = {"q0": chain.q0, "q1": chain.q1, "p0": chain.p0, "p1": chain.p1}
    case = f"C1 {'>' if C1 > 0 else '<'} 0, D1 {'>' if D1 > 0 else '<'} 0"
    return NormalForm("R2", {"C": C, "D": D, "C1": C1, "D1": D1, "case": case}, f"1:2 resonance, {case}", vectors)


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
    if abs(B) > TRUST * manifold.magnitude((0, 2), 0):
        a = C1.real / elementary.square(abs(B1))
        coefficients |= {"a": a, "case": f"invariant circle {'stable' if a < 0 else 'unstable'}"}
    else:
        coefficients["case"] = "degenerate: B is zero to its estimated error"
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("R3", coefficients, f"1:3 resonance, {coefficients['case']}", vectors)


def resonance_1_4(jet: Jet) -> NormalForm:
    """R4: C, D of w -> i w + C w |w|^2 + D conj(w)^3, and A0 = C1/|D1|.

    The fourth iterate is the unit-time flow of z' = C1 z |z|^2 + D1 conj(z)^3 with C1 = -4 i C, D1 = -4 i D. |A0| < 1:
    four further fixed points of the fourth iterate surround the point for all parameters near it; > 1: none or eight.
    """
    manifold = circle_manifold(jet, 0.5 * np.pi)
    C, D = manifold.g((2, 1), 0), manifold.g((0, 3), 0)
    C1, D1 = -4.0j * C, -4.0j * D
    coefficients: dict[str, object] = {"C": parts(C), "D": parts(D), "C1": parts(C1), "D1": parts(D1)}
    if abs(D) > TRUST * manifold.magnitude((0, 3), 0):
        A0 = C1 / abs(D1)
        coefficients |= {"A0": parts(A0), "case": f"|A0| {'>' if abs(A0) > 1 else '<'} 1"}
    else:
        coefficients["case"] = "degenerate: D is zero to its estimated error"
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("R4", coefficients, f"1:4 resonance, {coefficients['case']}", vectors)
