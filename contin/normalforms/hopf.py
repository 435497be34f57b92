"""Hopf points (HB) and generalised Hopf points (GH) of equilibria, and the cycles that start there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.machine import elementary
from contin.normalforms.homological import CentreManifold
from contin.normalforms.jet import Complex, Jet, Real, mass_of
from contin.normalforms.linear import EigenPair, eigen_pair, eigenvalues, null_pair
from contin.normalforms.result import DEGENERATE, NO_ERRORS, TRUST, Errors, NormalForm, NotThisTypeError, parts, sense


@dataclass(frozen=True, eq=False)
class CyclePredictor:
    """Small cycles near a Hopf point: w = rho e^{i phi} on the centre manifold, up to O(rho^3).

    u = u0 + 2 Re(q w + h20 w^2) + rho^2 (h11 + sum_i p2_i hp_i), p = p0 + p2 rho^2, phi' = omega + omega2 rho^2.
    """

    omega: float
    q: Complex
    h20: Complex
    h11: Real
    hp: Real  # (parameters, n): response of the equilibrium to each parameter
    p2: Real  # (parameters,)
    omega2: float

    def orbit(self, rho: float, phases: Real) -> Real:
        """u - u0 at the phases, (len(phases), n)."""
        return self.at(rho, elementary.exp(1j * np.asarray(phases, dtype=float)))

    def at(self, rho: float, turns: Complex) -> Real:
        """The same, given e^{i phi}."""
        w = rho * turns
        wave = 2.0 * (np.outer(w, self.q) + np.outer(w * w, self.h20)).real
        cycle: Real = wave + rho * rho * (self.h11 + self.p2 @ self.hp)
        return cycle

    def parameter_shift(self, rho: float) -> Real:
        return rho * rho * self.p2

    def period(self, rho: float) -> float:
        return float(2.0 * np.pi / (self.omega + rho * rho * self.omega2))


def critical_pair(
    A: Real, omega: float | None = None, scale: Real | None = None, mass: Real | None = None
) -> EigenPair:
    """Eigenvectors to i omega; without omega, to the complex pair whose angle to the imaginary axis is smallest."""
    if omega is None:
        upper = [value for value in eigenvalues(A, mass) if value.imag > 0.0]
        if not upper:
            raise NotThisTypeError("no complex eigenvalues: this is not a Hopf point (a neutral saddle has none)")
        nearest = min(upper, key=lambda value: abs(value.real) / abs(value))
        omega = eigen_pair(A, nearest, mass=mass).value.imag
    return null_pair(A - 1j * omega * (np.eye(len(A)) if mass is None else mass), 1j * omega, scale, mass)


def conjugate(pair: EigenPair) -> EigenPair:
    return EigenPair(np.conj(pair.value), pair.right.conj(), pair.left.conj(), pair.singular, pair.gap)


def hopf_manifold(jet: Jet, omega: float | None = None, drift: Real | None = None) -> CentreManifold:
    """The centre manifold of w' = i omega w + ..., coordinates (w, conj w, parameters)."""
    pair = critical_pair(jet.A, omega, jet.scale, mass_of(jet))
    return CentreManifold(jet, [pair, conjugate(pair)], drift)


def hopf(
    jet: Jet, omega: float | None = None, *, drift: Real | None = None, further: Errors = NO_ERRORS
) -> NormalForm:  # fmt: skip
    """HB: w' = i omega w + c1 w |w|^2, c1 = G21/2, l1 = Re c1/omega.

    G21 = <p, C(q,q,q*) + B(q*,h20) + 2 B(q,h11)>, h20 = (2 i omega - A)^-1 B(q,q), h11 = -A^-1 B(q,q*).
    Supercritical (l1 < 0): the cycles surround the equilibrium where it has the extra pair of unstable eigenvalues, and
    take over its stability. `degenerate` where l1 is zero to its estimated error, which counts errors `drift` of the
    states and active parameters where h20 or h11 lies beside a pole (a further eigenvalue near 2 i omega or 0), and
    what else it is off by, `further`.
    Kuznetsov, Elements, 3rd ed., sec. 5.4.1.
    """
    manifold = hopf_manifold(jet, omega, drift)
    omega = float(manifold.values[0].imag)
    c1 = manifold.g((2, 1), 0)
    error = TRUST * manifold.magnitude((2, 1), 0) / omega + further.get("l1", 0.0)
    l1 = c1.real / omega
    criticality = sense(l1, error)
    coefficients = {"omega": omega, "c1": parts(c1), "l1": l1, "criticality": criticality}
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("HB", coefficients, f"{criticality} Hopf point", vectors, {"l1": error})


def first_lyapunov(jet: Jet, omega: float | None = None) -> float:
    """l1 as `hopf` has it, without its error, which takes three quarters of the evaluations of a Python function."""
    manifold = hopf_manifold(jet, omega)
    return manifold.g((2, 1), 0).real / float(manifold.values[0].imag)


def hopf_predictor(
    jet: Jet, omega: float | None = None, vectors: tuple[Complex, Complex] | None = None
) -> CyclePredictor:
    """The cycles born at a Hopf point, for a jet with one active parameter.

    vectors : (q, p) with <p, M q> = 1 where i omega is multiple: which cycles are meant.

    With lambda'(p) = gamma: p2 = -Re c1/Re gamma, omega2 = Im c1 + p2 Im gamma. Where the pair does not cross with
    speed (Re gamma zero to its estimated error), p2 = 0.
    """
    if vectors is None or omega is None:
        manifold = hopf_manifold(jet, omega)
    else:
        pair = EigenPair(1j * omega, *vectors, 0.0, np.inf)
        manifold = CentreManifold(jet, [pair, conjugate(pair)])
    c1, gamma = manifold.g((2, 1), 0), manifold.g((1, 0, 1), 0)
    crosses = abs(gamma.real) > TRUST * manifold.magnitude((1, 0, 1), 0)
    p2 = np.array([-c1.real / gamma.real if crosses else 0.0])
    return cycle_predictor(manifold, p2, c1.imag + float(p2[0]) * gamma.imag)


def cycle_predictor(manifold: CentreManifold, p2: Real, omega2: float) -> CyclePredictor:
    """The second-order cycle on the manifold of one pair for a given direction of the parameters."""
    k = manifold.jet.parameters
    hp = np.array([manifold.h(0, 0, *(int(i == j) for j in range(k))).real for i in range(k)])
    return CyclePredictor(
        float(manifold.values[0].imag),
        manifold.right[0],
        manifold.h(2, 0),
        manifold.h(1, 1).real,
        hp.reshape(k, manifold.jet.n),
        p2,
        omega2,
    )


def generalised_hopf(jet: Jet, omega: float | None = None) -> NormalForm:
    """GH: l2 = Re c2 = Re G32/12 of w' = i omega w + c1 w |w|^2 + c2 w |w|^4 with Re c1 = 0 (not divided by omega).

    Kuznetsov (1999), sec. 3.3; needs forms up to order 5. l2 < 0: the outer of the two cycles is the stable one.
    """
    manifold = hopf_manifold(jet, omega)
    return generalised_hopf_on(manifold, TRUST * manifold.magnitude((3, 2), 0))


def generalised_hopf_on(manifold: CentreManifold, error: float) -> NormalForm:
    """The same of a manifold in (w, conj w), l2 with this error."""
    c1, c2 = manifold.g((2, 1), 0), manifold.g((3, 2), 0)
    l2 = c2.real
    outer = {"supercritical": "stable", "subcritical": "unstable"}.get(sense(l2, error))
    words = "generalised Hopf point (Bautin)" + (
        f", outer cycle {outer} on the centre manifold" if outer else ", l2 zero to its estimated error"
    )
    coefficients = {"l2": l2, "omega": float(manifold.values[0].imag), "c1": parts(c1), "c2": parts(c2)}
    if not outer:
        coefficients["case"] = DEGENERATE
    return NormalForm("GH", coefficients, words, {"q": manifold.right[0], "p": manifold.left[0]}, {"l2": error})


def lpc_predictor(jet: Jet, omega: float | None = None) -> CyclePredictor:
    """Cycles on the curve of folds (LPC) that starts at a GH point; the jet has two active parameters.

    Re(lambda) = gamma . dp and Re(c1) = delta . dp; a double root of gamma.dp + delta.dp rho^2 + l2 rho^4 has
    delta.dp = -2 l2 rho^2 and gamma.dp = l2 rho^4, so dp = rho^2 p2 + O(rho^4) with gamma.p2 = 0, delta.p2 = -2 l2.
    Kuznetsov, Meijer, Govaerts and Sautois, Physica D 237 (2008) 3061. Needs forms up to order 5.
    """
    if jet.parameters != 2:
        raise ValueError(f"a curve of folds needs a jet with two active parameters; this one has {jet.parameters}")
    manifold = hopf_manifold(jet, omega)
    gamma = np.array([manifold.g((1, 0, 1, 0), 0), manifold.g((1, 0, 0, 1), 0)])
    delta = np.array([manifold.g((2, 1, 1, 0), 0), manifold.g((2, 1, 0, 1), 0)])
    l2 = manifold.g((3, 2), 0).real
    p2 = np.linalg.solve(np.array([gamma.real, delta.real]), np.array([0.0, -2.0 * l2]))
    return cycle_predictor(manifold, p2, manifold.g((2, 1), 0).imag + float(gamma.imag @ p2))
