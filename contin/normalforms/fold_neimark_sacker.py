"""Fold-Neimark-Sacker points (LPNS) of maps: simple multipliers 1 and exp(+-i theta).

Kuznetsov and Meijer, J. Difference Equ. Appl. 12 (2006) 1009, for s, a, b and c (those of MatContM); De Witte, Della
Rossa, Govaerts and Kuznetsov, SIAM J. Appl. Dyn. Syst. 12 (2013) 722, for s, theta and E.
"""

from __future__ import annotations

from collections.abc import Mapping

from contin.machine import elementary
from contin.normalforms.jet import Jet
from contin.normalforms.modes_of_maps import modes
from contin.normalforms.propagated import Numbers, propagated
from contin.normalforms.result import DEGENERATE, TRUST, NormalForm, parts, side
from contin.normalforms.static import StateError, quadratic_error

CUBIC = {"f300": ((3, 0, 0), 0), "f111": ((1, 1, 1), 0), "g210": ((2, 1, 0), 1), "g021": ((0, 2, 1), 1)}


def fold_neimark_sacker(jet: Jet, *, state_error: StateError = None) -> NormalForm:
    """LPNS: the coefficients of

        w0 -> w0 + f200 w0^2 + f011 |w1|^2 + ...,   w1 -> e^{i angle} w1 + g110 w0 w1 + ...

    and those of the form without w0 |w1|^2 and w1 |w1|^2, in units of w0 and |w1| in which f200 is 1 and f011 is s:

        w0 -> w0 + w0^2 + s |w1|^2 + c w0^3,   w1 -> e^{i angle} w1 + a w0 w1 + b w0^2 w1

    But for the turn it is the unit-time flow of a field whose amplitudes are those of a zero-Hopf point, xi' = xi^2 + s
    |zeta|^2, zeta' = (theta + E xi) xi zeta in real parts: theta = Re(e^{-i angle} a), and E decides with theta
    whether the torus that starts on the invariant circles' Neimark-Sacker curve (s theta < 0) is stable on the centre
    manifold: E theta > 0. Near a resonance of third order `resonance` names it and `case` says no more.
    """
    found = modes(jet, (1.0,), 1)
    manifold = found.manifold
    (q0, q1), (p0, p1) = manifold.right[:2], manifold.left[:2]
    back = complex(elementary.exp(-1j * found.angles[0]))
    values: dict[str, complex] = {name: _value(manifold.g(v, j), back, j) for name, (v, j) in CUBIC.items()}
    quadratic = {"f200": ((2, 0, 0), 0), "f011": ((0, 1, 1), 0), "g110": ((1, 1, 0), 1)}
    values |= {name: _value(manifold.g(v, j), back, j) for name, (v, j) in quadratic.items()}
    errors = {name: TRUST * manifold.magnitude(v, j) for name, (v, j) in CUBIC.items()} | {
        "f200": 0.5 * quadratic_error(jet, p0, q0, q0, state_error),
        "f011": quadratic_error(jet, p0, q1, q1.conj(), state_error),
        "g110": quadratic_error(jet, p1, q0, q1, state_error),
    }
    coefficients: dict[str, object] = {
        "angle": found.angles[0], "f200": values["f200"].real, "f011": values["f011"].real,
        "g110": parts(values["g110"] / back),
    }  # fmt: skip
    known = {name: errors[name] for name in quadratic}
    zero = [name for name in ("f200", "f011") if abs(values[name]) <= errors[name]]
    if len(zero) == 2:
        case = f"{DEGENERATE}: f200 and f011 zero to their errors (a reflection: pitchfork-Neimark-Sacker)"
    elif zero:
        case = f"{DEGENERATE}: {zero[0]} is zero to its estimated error"
    else:
        scaled = _scaled(values)
        known |= propagated(_scaled, values, errors)
        s = 1 if values["f200"].real * values["f011"].real > 0.0 else -1
        turned = {name: parts(scaled[name] / back) for name in ("a", "b")}
        coefficients |= {"s": s, **turned} | {name: scaled[name].real for name in ("c", "theta", "E")}
        case = _case(s, scaled, known)
    if found.resonance:
        coefficients["resonance"] = found.resonance
        case = f"near-resonant: {found.resonance}"
    coefficients["case"] = case
    vectors = {"q0": q0.real, "p0": p0.real, "q": q1, "p": p1}
    return NormalForm("LPNS", coefficients, f"fold-Neimark-Sacker point, {case}", vectors, known)


def _value(g: complex, back: complex, j: int) -> complex:
    """Real of w0; of w1 without the turn."""
    return g * back if j else g.real


def _scaled(values: Numbers) -> dict[str, complex]:
    """a and b without the turn."""
    f200, f011, f300, f111 = (values[name].real for name in ("f200", "f011", "f300", "f111"))
    g110, g210, g021 = (values[name] for name in ("g110", "g210", "g021"))
    a, c = g110 / f200, f300 / (f200 * f200)
    b = (g210 + (g110 * (0.5 * f111 + g021.real) - f200 * g021) / f011) / (f200 * f200)
    theta = a.real
    E = b.real - 0.5 * (a * a).real - theta * theta + theta * (1.0 - 1.5 * c)
    return {"a": a, "b": b, "c": c, "theta": theta, "E": E}


def _case(s: int, found: Mapping[str, complex], errors: Mapping[str, float]) -> str:
    theta, E = found["theta"].real, found["E"].real
    sign = side(theta, errors["theta"])
    if sign is None:
        return f"s = {s}, {DEGENERATE}: theta is zero to its estimated error"
    if s * theta > 0.0:
        return f"s = {s}, theta {sign}, no torus"
    stable = side(E * theta, errors["E"] * abs(theta), "torus stable", "torus unstable")
    return f"s = {s}, theta {sign}, {stable or f'{DEGENERATE}: E is zero to its estimated error'}"
