"""Period doubling (PD) and Neimark-Sacker (NS) points of fixed points of maps, and what is born there.

Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., secs. 5.4.2 and 5.4.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.machine import elementary
from contin.normalforms.cubic_of_maps import on_circle
from contin.normalforms.homological import CentreManifold
from contin.normalforms.hopf import conjugate
from contin.normalforms.jet import Jet, Real
from contin.normalforms.linear import eigen_pair, eigenvalues, null_pair
from contin.normalforms.result import NO_ERRORS, TRUST, Errors, NormalForm, NotThisTypeError, parts, sense


@dataclass(frozen=True, eq=False)
class DoubledPredictor:
    """Period-two points u0 + s q + s^2 (h2 + p2 hp) for both signs of s, at p0 + p2 s^2, up to O(s^3)."""

    q: Real
    h2: Real
    hp: Real
    p2: float

    def points(self, s: float) -> tuple[Real, Real]:
        """(u1 - u0, u2 - u0): each is the image of the other."""
        even = s * s * (self.h2 + self.p2 * self.hp)
        return s * self.q + even, -s * self.q + even

    def parameter_shift(self, s: float) -> float:
        return s * s * self.p2


def flip_manifold(jet: Jet, drift: Real | None = None) -> CentreManifold:
    """The centre manifold of w -> -w + ..."""
    return CentreManifold(jet, [null_pair(jet.A + np.eye(jet.n), -1.0, jet.scale)], drift)


def period_doubling(jet: Jet, *, drift: Real | None = None, further: Errors = NO_ERRORS) -> NormalForm:
    """PD: c = <p, C(q,q,q) + 3 B(q, (1 - A)^-1 B(q,q))>/6 of w -> -w + c w^3.

    Supercritical (c > 0): the doubled orbit lies where the fixed point has the extra unstable multiplier and takes over
    its stability. The error of c counts errors `drift` of the states and active parameters beside its pole (a further
    multiplier near 1), and what else it is off by, `further`.
    """
    manifold = flip_manifold(jet, drift)
    c = manifold.g((3,), 0).real
    error = TRUST * manifold.magnitude((3,), 0) + further.get("c", 0.0)
    criticality = sense(-c, error)
    vectors = {"q": manifold.right[0].real, "p": manifold.left[0].real}
    coefficients = {"c": c, "criticality": criticality}
    return NormalForm("PD", coefficients, f"{criticality} period doubling", vectors, {"c": error})


def flip_predictor(jet: Jet) -> DoubledPredictor:
    """The doubled orbit for a jet with one active parameter; with multiplier -1 + gamma dp, p2 = -c/gamma.

    Where the multiplier does not cross with speed (gamma zero to its estimated error), p2 = 0.
    """
    manifold = flip_manifold(jet)
    gamma = manifold.g((1, 1), 0).real
    crosses = abs(gamma) > TRUST * manifold.magnitude((1, 1), 0)
    p2 = -manifold.g((3,), 0).real / gamma if crosses else 0.0
    return DoubledPredictor(manifold.right[0].real, manifold.h(2).real, manifold.h(0, 1).real, p2)


def circle_manifold(jet: Jet, theta: float | None = None, drift: Real | None = None) -> CentreManifold:
    """The centre manifold of w -> e^{i theta} w; without theta, of the complex pair nearest to the unit circle."""
    if theta is None:
        upper = [value for value in eigenvalues(jet.A) if value.imag > 0.0]
        if not upper:
            raise NotThisTypeError("no complex multipliers: not a Neimark-Sacker point (a neutral saddle has none)")
        theta = float(elementary.angle(eigen_pair(jet.A, min(upper, key=lambda value: abs(abs(value) - 1.0))).value))
    value = elementary.exp(1j * theta)
    pair = null_pair(jet.A - value * np.eye(jet.n), complex(value), jet.scale)
    return CentreManifold(jet, [pair, conjugate(pair)], drift)


def cubic_on_circle(jet: Jet, theta: float) -> complex:
    """d as `neimark_sacker` has it, without its error."""
    found = on_circle(jet, theta)
    if found is not None:
        return found.value
    manifold = circle_manifold(jet, theta)
    return manifold.g((2, 1), 0) / complex(manifold.values[0])


def cubic_beyond_error(jet: Jet, theta: float) -> float:
    """Re d as `neimark_sacker` has it; 0 where it is no more than its error."""
    found = on_circle(jet, theta, with_error=True)
    if found is not None and found.error is not None:
        value, error = found.value.real, found.error
    else:
        form = neimark_sacker(jet, theta)
        value, error = float(form.coefficients["d"][0]), float(form.errors["d"])
    return value if abs(value) > error else 0.0


def neimark_sacker(
    jet: Jet, theta: float | None = None, *, drift: Real | None = None, further: Errors = NO_ERRORS
) -> NormalForm:  # fmt: skip
    """NS: d of w -> e^{i theta} w (1 + d |w|^2); Re d decides.

    d = e^{-i theta} <p, C(q,q,q*) + 2 B(q, (1 - A)^-1 B(q,q*)) + B(q*, (e^{2 i theta} - A)^-1 B(q,q))>/2. Supercritical
    (Re d < 0): the invariant circle lies where the fixed point has the extra pair of unstable multipliers, and takes
    over its stability. `resonance` names a strong resonance (3 or 4) where theta is one; d then decides nothing.
    The error of d counts errors `drift` of the states and active parameters beside a pole, and what else it is off by,
    `further`.
    """
    manifold = circle_manifold(jet, theta, drift)
    value = manifold.values[0]
    d = manifold.g((2, 1), 0) / value
    error = TRUST * manifold.magnitude((2, 1), 0) + further.get("d", 0.0)
    criticality = sense(d.real, error)
    coefficients = {"theta": float(elementary.angle(value)), "d": parts(d), "criticality": criticality}
    for order in (3, 4):
        if abs(value**order - 1.0) < 1e-6:
            coefficients["resonance"] = order
    vectors = {"q": manifold.right[0], "p": manifold.left[0]}
    return NormalForm("NS", coefficients, f"{criticality} Neimark-Sacker point", vectors, {"d": error})
