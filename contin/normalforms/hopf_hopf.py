"""Hopf-Hopf points (HH): two pairs +-i omega1, +-i omega2 of imaginary eigenvalues."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contin.normalforms.homological import CentreManifold
from contin.normalforms.hopf import CyclePredictor, conjugate, critical_pair
from contin.normalforms.jet import Jet, mass_of
from contin.normalforms.linear import eigen_pair, eigenvalues
from contin.normalforms.result import TRUST, NormalForm, NotThisTypeError, parts

RESONANT = 1e-4  # relative distance at which omega1 : omega2 counts as a ratio of small integers


def hopf_hopf_manifold(jet: Jet, omegas: tuple[float, float] | None = None) -> CentreManifold:
    """Coordinates (w1, conj w1, w2, conj w2, parameters), omega1 > omega2."""
    if omegas is None:
        every = eigenvalues(jet.A, mass_of(jet))
        upper = sorted((v for v in every if v.imag > 0.0), key=lambda v: abs(v.real) / abs(v))
        if len(upper) < 2:
            raise NotThisTypeError("fewer than two pairs of complex eigenvalues: this is not a Hopf-Hopf point")
        first, second = (eigen_pair(jet.A, value, mass=mass_of(jet)).value.imag for value in upper[:2])
        omegas = first, second
    pairs = []
    for omega in sorted(omegas, reverse=True):
        pair = critical_pair(jet.A, omega, jet.scale, mass_of(jet))
        pairs += [pair, conjugate(pair)]
    return CentreManifold(jet, pairs)


def hopf_hopf(jet: Jet, omegas: tuple[float, float] | None = None) -> NormalForm:
    """HH: the cubic coefficients of Kuznetsov, Elements, 3rd ed., secs. 8.6 and 8.7.5,

        w1' = i omega1 w1 + G2100 w1 |w1|^2/2 + G1011 w1 |w2|^2
        w2' = i omega2 w2 + G1110 w2 |w1|^2 + G0021 w2 |w2|^2/2

    p11 = Re G2100/2, p12 = Re G1011, p21 = Re G1110, p22 = Re G0021/2, theta = p12/p22, delta = p21/p11; `case` simple
    (p11 p22 > 0) or difficult, with its subtype (for theta >= delta, else with w1 and w2 exchanged).
    `resonance` names k : l where k omega2 = l omega1 with k + l <= 4: further terms then belong in the
    form, and `case` says no more.
    """
    manifold = hopf_hopf_manifold(jet, omegas)
    size = manifold.magnitude
    return hopf_hopf_on(manifold, {"p11": TRUST * size((2, 1, 0, 0), 0), "p22": TRUST * size((0, 0, 2, 1), 2)})


def hopf_hopf_on(manifold: CentreManifold, errors: Mapping[str, float]) -> NormalForm:
    """`hopf_hopf` of a manifold in (w1, conj w1, w2, conj w2), whose p11 and p22 have these errors."""
    g = manifold.g
    G2100, G1011 = 2.0 * g((2, 1, 0, 0), 0), g((1, 0, 1, 1), 0)
    G1110, G0021 = g((1, 1, 1, 0), 2), 2.0 * g((0, 0, 2, 1), 2)
    p11, p12, p21, p22 = 0.5 * G2100.real, G1011.real, G1110.real, 0.5 * G0021.real
    omega1, omega2 = float(manifold.values[0].imag), float(manifold.values[2].imag)
    coefficients: dict[str, object] = {
        "omega1": omega1,
        "omega2": omega2,
        "G2100": parts(G2100),
        "G1011": parts(G1011),
        "G1110": parts(G1110),
        "G0021": parts(G0021),
        "p11": p11,
        "p12": p12,
        "p21": p21,
        "p22": p22,
    }
    if abs(p11) <= errors["p11"] or abs(p22) <= errors["p22"]:
        case = "degenerate: p11 or p22 is zero to its estimated error"
    else:
        theta, delta = p12 / p22, p21 / p11
        coefficients |= {"theta": theta, "delta": delta}
        case = subtype(theta, delta, p11 * p22 > 0.0)
    for k, m in ((1, 1), (2, 1), (3, 1)):
        if abs(k * omega2 - m * omega1) <= RESONANT * omega1:
            coefficients["resonance"] = f"{m}:{k}"
            case = f"near-resonant: {m}:{k}"
    coefficients["case"] = case
    vectors = {
        "q1": manifold.right[0],
        "p1": manifold.left[0],
        "q2": manifold.right[2],
        "p2": manifold.left[2],
    }
    return NormalForm("HH", coefficients, f"Hopf-Hopf point, {case}", vectors, errors)


def subtype(theta: float, delta: float, simple: bool) -> str:
    """The subtype in the (theta, delta) plane, which is symmetric under exchange of the two oscillations."""
    theta, delta = max(theta, delta), min(theta, delta)
    product = theta * delta
    if simple:
        if delta > 0:
            name = "I" if product > 1 else "II"
        elif theta > 0:
            name = "III"
        else:
            name = "IV" if product < 1 else "V"
        return f"simple case {name}"
    if product > 1:
        name = "VI" if theta < 0 else "I" if delta > 1 else "II"
    elif delta > 0:
        name = "III"
    else:
        name = "IV" if theta > 0 else "V"
    return f"difficult case {name}"


def torus_predictors(jet: Jet, omegas: tuple[float, float] | None = None) -> list[tuple[CyclePredictor, float]]:
    """Cycles on the two Neimark-Sacker curves that start at a HH point, with the angle of their critical multipliers.

    The cycle |w1| = rho exists at mu1 = -p11 rho^2 and its multiplier of w2 leaves the unit circle at mu2 = -p21 rho^2
    (mu_j = Re gamma_j . dp); likewise for |w2| = rho. The jet has two active parameters.
    """
    if jet.parameters != 2:
        raise ValueError(f"Neimark-Sacker curves need a jet with two active parameters; this one has {jet.parameters}")
    manifold = hopf_hopf_manifold(jet, omegas)
    g, units = manifold.g, ((1, 0), (0, 1))
    gamma = np.array([[g((1, 0, 0, 0, *e), 0) for e in units], [g((0, 0, 1, 0, *e), 2) for e in units]])
    hp = np.array([manifold.h(0, 0, 0, 0, *e).real for e in units])
    own = (
        ((2, 1, 0, 0), (1, 1, 1, 0), (2, 0, 0, 0), (1, 1, 0, 0)),
        ((0, 0, 2, 1), (1, 0, 1, 1), (0, 0, 2, 0), (0, 0, 1, 1)),
    )
    found = []
    for i, (cubic, cross, second, mean) in enumerate(own):
        c, x = g(cubic, 2 * i), g(cross, 2 - 2 * i)
        target = np.empty(2)
        target[i], target[1 - i] = -c.real, -x.real
        p2 = np.linalg.solve(gamma.real, target)
        frequency, other = (float(manifold.values[2 * j].imag) for j in (i, 1 - i))
        omega2 = float(c.imag + gamma[i].imag @ p2)
        cycle = CyclePredictor(
            frequency, manifold.right[2 * i], manifold.h(*second), manifold.h(*mean).real, hp, p2, omega2
        )
        found.append((cycle, 2.0 * np.pi * other / frequency))
    return found
