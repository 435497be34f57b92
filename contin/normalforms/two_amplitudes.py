"""Flip-Neimark-Sacker (PDNS) and double Neimark-Sacker (NSNS) points of maps: two amplitudes that interact.

But for the turns the map is the unit-time flow of a field whose amplitudes are those of a Hopf-Hopf point,

    r1' = r1 (p11 r1^2 + p12 r2^2),   r2' = r2 (p21 r1^2 + p22 r2^2)

with theta = p12/p22, delta = p21/p11 and its cases. Kuznetsov and Meijer, J. Difference Equ. Appl. 12 (2006) 1009;
De Witte, Della Rossa, Govaerts and Kuznetsov, SIAM J. Appl. Dyn. Syst. 12 (2013) 722.
"""

from __future__ import annotations

from collections.abc import Mapping

from contin.abi import Vector
from contin.machine import elementary
from contin.normalforms.homological import Index
from contin.normalforms.hopf_hopf import subtype
from contin.normalforms.jet import Jet
from contin.normalforms.modes_of_maps import Modes, modes
from contin.normalforms.propagated import Numbers, propagated
from contin.normalforms.result import DEGENERATE, TRUST, NormalForm

NAMES = ("p11", "p12", "p21", "p22")


def flip_neimark_sacker(jet: Jet) -> NormalForm:
    """PDNS: w0 -> -w0 - p11 w0^3 - p12 w0 |w1|^2,  w1 -> e^{i angle} w1 (1 + P21 w0^2 + P22 |w1|^2), p2j = Re P2j.

    `case`: simple (p11 p22 > 0) or difficult, with its subtype as of `hopf_hopf`. Near a resonance of third order
    `resonance` names it and `case` says no more.
    """
    found = modes(jet, (-1.0,), 1)
    terms = (((3, 0, 0), 0), ((1, 1, 1), 0), ((2, 1, 0), 1), ((0, 2, 1), 1))
    back = complex(elementary.exp(-1j * found.angles[0]))
    manifold = found.manifold
    vectors = {"q0": manifold.right[0].real, "p0": manifold.left[0].real, "q": manifold.right[1], "p": manifold.left[1]}
    coefficients = {"angle": found.angles[0]}
    return _form("PDNS", "flip-Neimark-Sacker point", found, terms, (-1.0, -1.0, back, back), coefficients, vectors)


def double_neimark_sacker(jet: Jet) -> NormalForm:
    """NSNS: wj -> e^{i anglej} wj (1 + Pj1 |w1|^2 + Pj2 |w2|^2), pjk = Re Pjk, angle1 > angle2.

    `case` and `resonance` as of `flip_neimark_sacker`.
    """
    found = modes(jet, (), 2)
    terms = (((2, 1, 0, 0), 0), ((1, 0, 1, 1), 0), ((1, 1, 1, 0), 2), ((0, 0, 2, 1), 2))
    first, second = (complex(elementary.exp(-1j * angle)) for angle in found.angles)
    manifold = found.manifold
    vectors = {
        "q1": manifold.right[0], "p1": manifold.left[0], "q2": manifold.right[2], "p2": manifold.left[2],
    }  # fmt: skip
    coefficients = {"angle1": found.angles[0], "angle2": found.angles[1]}
    return _form(
        "NSNS", "double Neimark-Sacker point", found, terms, (first, first, second, second), coefficients, vectors
    )


def _form(
    type_: str, words: str, found: Modes, terms: tuple[tuple[Index, int], ...], back: tuple[complex, ...],
    angles: Mapping[str, float], vectors: Mapping[str, Vector],
) -> NormalForm:  # fmt: skip
    manifold = found.manifold
    values = {
        name: float((turn * manifold.g(v, j)).real) for name, turn, (v, j) in zip(NAMES, back, terms, strict=True)
    }
    errors = {name: TRUST * manifold.magnitude(v, j) for name, (v, j) in zip(NAMES, terms, strict=True)}
    coefficients: dict[str, object] = {**angles, **values}
    zero = [name for name in ("p11", "p22") if abs(values[name]) <= errors[name]]
    if zero:
        case = f"{DEGENERATE}: {' and '.join(zero)} zero to {'its error' if len(zero) == 1 else 'their errors'}"
    else:
        ratios = _ratios(values)
        coefficients |= ratios
        errors |= propagated(_ratios, values, dict(errors))
        case = subtype_within(ratios, errors, values["p11"] * values["p22"] > 0.0)
    if found.resonance:
        coefficients["resonance"] = found.resonance
        case = f"near-resonant: {found.resonance}"
    coefficients["case"] = case
    return NormalForm(type_, coefficients, f"{words}, {case}", vectors, errors)


def _ratios(values: Numbers) -> dict[str, float]:
    p11, p12, p21, p22 = (values[name].real for name in NAMES)
    return {"theta": p12 / p22, "delta": p21 / p11}


def subtype_within(ratios: Mapping[str, float], errors: Mapping[str, float], simple: bool) -> str:
    """The subtype of all (theta, delta) within the errors, where that is one."""
    (theta, off), (delta, away) = ((ratios[name], errors[name]) for name in ("theta", "delta"))
    names = {subtype(theta + i * off, delta + j * away, simple) for i in (-1, 1) for j in (-1, 1)}
    if len(names) == 1:
        return names.pop()
    kind = "simple" if simple else "difficult"
    return f"{kind} case, {DEGENERATE}: theta and delta are between subtypes to their errors"
