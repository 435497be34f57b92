"""Zero-Hopf (fold-Hopf) points (ZH): a simple zero eigenvalue beside a pair +-i omega."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from contin.normalforms.homological import CentreManifold
from contin.normalforms.hopf import CyclePredictor, conjugate, critical_pair
from contin.normalforms.jet import Jet, mass_of
from contin.normalforms.linear import null_pair
from contin.normalforms.result import NormalForm, parts
from contin.normalforms.static import StateError, quadratic_error

REFLECTED: Final = "Hopf-pitchfork (reflection symmetry)"  # what is even in w0 in w0', and odd in w1', vanishes


def zero_hopf_manifold(jet: Jet, omega: float | None = None) -> CentreManifold:
    """Coordinates (w0 real, w1, conj w1, parameters)."""
    pair = critical_pair(jet.A, omega, jet.scale, mass_of(jet))
    return CentreManifold(jet, [null_pair(jet.A, 0.0, jet.scale, mass_of(jet)), pair, conjugate(pair)])


def zero_hopf(jet: Jet, omega: float | None = None, *, state_error: StateError = None) -> NormalForm:
    """ZH: the coefficients of Kuznetsov, Elements, 3rd ed., secs. 8.5 and 8.7.4,

        w0' = G200 w0^2/2 + G011 |w1|^2 + G300 w0^3/6 + G111 w0 |w1|^2
        w1' = i omega w1 + G110 w0 w1 + G210 w0^2 w1/2 + G021 w1 |w1|^2/2

    and of xi' = xi^2 + s |zeta|^2, zeta' = i omega zeta + (theta + i vartheta) xi zeta + sign(E) xi^2 zeta (after
    rescaling): s = sign(G200 G011), theta = 2 Re G110/G200,
    E = Re[G210 + G110 (Re G021/G011 - G300/G200 + G111/G011) - G021 G200/(2 G011)]/2.
    Cycles have a curve of Neimark-Sacker points where s theta < 0. Where G200, G011 and G110 vanish to their estimated
    errors (a reflection w0 -> -w0), `case` says Hopf-pitchfork and s, theta, E are left out.
    """
    manifold = zero_hopf_manifold(jet, omega)
    return zero_hopf_on(manifold, quadratic_errors(manifold, state_error))


def quadratic_errors(manifold: CentreManifold, state_error: StateError = None) -> dict[str, float]:
    """Estimated errors of G200, G011 and G110."""
    jet, q0, p0 = manifold.jet, manifold.right[0].real, manifold.left[0].real
    q1, p1 = manifold.right[1], manifold.left[1]
    return {
        "G200": quadratic_error(jet, p0, q0, q0, state_error),
        "G011": quadratic_error(jet, p0, q1, q1.conj(), state_error),
        "G110": quadratic_error(jet, p1, q0, q1, state_error),
    }


def zero_hopf_on(manifold: CentreManifold, errors: Mapping[str, float]) -> NormalForm:
    """`zero_hopf` of a manifold in (w0, w1, conj w1), whose G200, G011 and G110 have these errors."""
    g = manifold.g
    G200, G011 = 2.0 * g((2, 0, 0), 0).real, g((0, 1, 1), 0).real
    G300, G111 = 6.0 * g((3, 0, 0), 0).real, g((1, 1, 1), 0).real
    G110, G210, G021 = g((1, 1, 0), 1), 2.0 * g((2, 1, 0), 1), 2.0 * g((0, 2, 1), 1)
    coefficients: dict[str, object] = {
        "omega": float(manifold.values[1].imag),
        "G200": G200,
        "G011": G011,
        "G300": G300,
        "G111": G111,
        "G110": parts(G110),
        "G210": parts(G210),
        "G021": parts(G021),
    }
    zero_200, zero_011 = abs(G200) <= errors["G200"], abs(G011) <= errors["G011"]
    if zero_200 and zero_011 and abs(G110) <= errors["G110"]:
        case = REFLECTED
    elif zero_200 or zero_011 or abs(G110.real) <= errors["G110"]:
        case = "degenerate: a quadratic coefficient is zero to its estimated error"
    else:
        s, theta = int(np.sign(G200 * G011)), 2.0 * G110.real / G200
        bend = G110 * (G021.real / G011 - G300 / G200 + G111 / G011) - G021 * G200 / (2.0 * G011)
        coefficients |= {"s": s, "theta": theta, "E": 0.5 * (G210 + bend).real}
        torus = "a torus branches off the cycles" if s * theta < 0 else "no torus"
        case = f"s = {s}, theta {'>' if theta > 0 else '<'} 0: {torus}"
    coefficients["case"] = case
    right, left = manifold.right, manifold.left
    vectors = {"q0": right[0].real, "p0": left[0].real, "q": right[1], "p": left[1]}
    return NormalForm("ZH", coefficients, f"zero-Hopf point, {case}", vectors, errors)


def torus_predictor(jet: Jet, omega: float | None = None) -> tuple[CyclePredictor, float]:
    """Cycles on the Neimark-Sacker curve that starts at a ZH point; the jet has two active parameters.

    With dp = rho^2 p2 and w0 = rho^2 v on the cycle |w1| = rho, the leading orders of w0' = 0, |w1|' = 0 and of the
    zero trace are three linear equations for (p2, v). Returns the cycle and the rate r of its slow modulation, which
    has frequency r rho (real where s theta < 0; 0.0 elsewhere: the curve is one of neutral saddle cycles).
    Kuznetsov, Meijer, Govaerts and Sautois, Physica D 237 (2008) 3061.
    """
    if jet.parameters != 2:
        raise ValueError(
            f"a Neimark-Sacker curve needs a jet with two active parameters; this one has {jet.parameters}"
        )
    manifold = zero_hopf_manifold(jet, omega)
    g, units = manifold.g, ((1, 0), (0, 1))
    f200, f011, f111 = g((2, 0, 0), 0).real, g((0, 1, 1), 0).real, g((1, 1, 1), 0).real
    f110, f021 = g((1, 1, 0), 1), g((0, 2, 1), 1)
    drift = [g((0, 0, 0, *e), 0).real for e in units]
    slope = [g((1, 0, 0, *e), 0).real for e in units]
    rate = [g((0, 1, 0, *e), 1) for e in units]
    system = np.array([[*drift, 0.0], [*np.real(rate), f110.real], [*slope, 2.0 * f200]])
    solution = np.linalg.solve(system, [-f011, -f021.real, -f111 - 2.0 * f021.real])
    p2, v = solution[:2], float(solution[2])
    hp = np.array([manifold.h(0, 0, 0, *e).real for e in units])
    h11 = manifold.h(0, 1, 1).real + v * manifold.right[0].real
    omega2 = float(f021.imag + f110.imag * v + np.imag(rate) @ p2)
    frequency = float(manifold.values[1].imag)
    cycle = CyclePredictor(frequency, manifold.right[1], manifold.h(0, 2, 0), h11, hp, p2, omega2)
    return cycle, float(np.sqrt(max(-2.0 * f011 * f110.real, 0.0)))
