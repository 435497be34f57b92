"""Fold-flip points (LPPD) of maps: simple multipliers 1 and -1.

Kuznetsov, Meijer and van Veen, Int. J. Bifurcation Chaos 14 (2004) 2253; Kuznetsov and Meijer, SIAM J. Sci. Comput. 26
(2005) 1932, whose [a/e, b e] are a and b here.
"""

from __future__ import annotations

from collections.abc import Mapping

from contin.normalforms.jet import Jet
from contin.normalforms.modes_of_maps import modes
from contin.normalforms.propagated import Numbers, propagated
from contin.normalforms.result import DEGENERATE, TRUST, NormalForm, side
from contin.normalforms.static import StateError, quadratic_error

CUBIC = {"f30": ((3, 0), 0), "f12": ((1, 2), 0), "g21": ((2, 1), 1), "g03": ((0, 3), 1)}


def fold_flip(jet: Jet, *, state_error: StateError = None) -> NormalForm:
    """LPPD: the coefficients of

        w0 -> w0 + a w0^2 + b w1^2 + c w0^3 + d w0 w1^2,   w1 -> -w1 + w0 w1

    where w0 has the unit 1/e, e = <p1, B(q0, q1)>, and w1 is measured in q1: a and c depend on no eigenvector's length,
    b and d are as its square. The terms w0^2 w1 and w1^3 are removed by changes of coordinates of second order.

    The doubled orbits that start at the curve of flips undergo a Neimark-Sacker bifurcation near the point where b > 0;
    L_NS = 3 b c - a (2 a b + 3 b + d) < 0: their invariant curves are stable on the centre manifold. `case` has the
    signs of a and b (four unfoldings), and where b > 0 that of L_NS. Where a and b vanish to their estimated errors (a
    reflection w0 -> -w0), or e, it says so, and what is divided by e is left out.
    """
    manifold = modes(jet, (1.0, -1.0), 0).manifold
    (q0, q1), (p0, p1) = manifold.right, manifold.left
    values: dict[str, complex] = {name: manifold.g(v, j).real for name, (v, j) in CUBIC.items()}
    values |= {"f20": manifold.g((2, 0), 0).real, "f02": manifold.g((0, 2), 0).real, "e": manifold.g((1, 1), 1).real}
    errors = {name: TRUST * manifold.magnitude(v, j) for name, (v, j) in CUBIC.items()}
    errors |= {
        "f20": 0.5 * quadratic_error(jet, p0, q0, q0, state_error),
        "f02": 0.5 * quadratic_error(jet, p0, q1, q1, state_error),
        "e": quadratic_error(jet, p1, q0, q1, state_error),
    }
    vectors = {"q0": q0, "p0": p0, "q1": q1, "p1": p1}
    coefficients: dict[str, object] = {"e": values["e"]}
    known = {"e": errors["e"]}
    if abs(values["f20"]) <= errors["f20"] and abs(values["f02"]) <= errors["f02"]:
        case = f"{DEGENERATE}: a and b zero to their errors (a reflection symmetry: pitchfork-flip)"
    elif abs(values["e"]) <= errors["e"]:
        case = f"{DEGENERATE}: e is zero to its estimated error"
    else:
        found = _scaled(values)
        known |= propagated(_scaled, values, errors)
        coefficients |= found
        case = _case(found, known)
    coefficients["case"] = case
    return NormalForm("LPPD", coefficients, f"fold-flip point, {case}", vectors, known)


def _scaled(values: Numbers) -> dict[str, float]:
    f20, f02, e = values["f20"].real, values["f02"].real, values["e"].real
    f30, f12, g21, g03 = (values[name].real for name in CUBIC)
    a, b, c = f20 / e, f02 * e, f30 / (e * e)
    d = f12 + 2.0 * (f02 * g21 - g03 * (f20 + e)) / e
    return {"a": a, "b": b, "c": c, "d": d, "L_NS": 3.0 * b * c - a * (2.0 * a * b + 3.0 * b + d)}


def _case(found: Mapping[str, float], errors: Mapping[str, float]) -> str:
    signs = {name: side(found[name], errors[name]) for name in ("a", "b")}
    zero = [name for name, sign in signs.items() if sign is None]
    parts = [f"{name} {sign}" for name, sign in signs.items() if sign is not None]
    if zero:
        return ", ".join([f"{DEGENERATE}: {zero[0]} is zero to its estimated error", *parts])
    if found["b"] > 0.0:
        curve = "invariant curve of the doubled orbit"
        stable = side(found["L_NS"], errors["L_NS"], f"{curve} unstable", f"{curve} stable")
        parts.append(stable or f"{DEGENERATE}: L_NS is zero to its estimated error")
    return ", ".join(parts)
