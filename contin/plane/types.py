"""What the flow around an equilibrium of the plane is, decided against the errors of what decides it.

Trace, determinant and discriminant of the Jacobian are compared with their own errors: the rounding of its entries, and
what the equilibrium's place, known as well as it is, moves them. Where they vanish the next terms decide.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.lowering.system import CompiledSystem
from contin.model.model import Model
from contin.normalforms.fold import fold
from contin.normalforms.hopf import hopf
from contin.normalforms.jet import DerivativeJet
from contin.plane.rounding import plane_system
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.normal_forms import jet_at

if TYPE_CHECKING:
    from contin.search.equilibrium_from_guess import Equilibrium

ROUNDING: Final = 1e-13  # relative, of an entry of the Jacobian
LOCATED: Final = 1e-12  # widths of the window, to which an equilibrium is known, where it is isolated
TERMS: Final = 4.0 * float(np.finfo(float).eps)  # of an equation's terms, which is left of them where they cancel


@dataclass(frozen=True)
class PlaneType:
    """`words`; `stability`: stable, unstable, saddle or neutral; `note`: what decided it, or what is left open."""

    words: str
    stability: str
    note: str = ""


def flow_type(one: Equilibrium, model: Model, window: Array) -> PlaneType:
    """Of an equilibrium of a flow of formulas. window : (2, 2)."""
    system = plane_system(model)
    matrix = np.asarray(system.jacobian(one.u, one.p)[1])[:, :2]
    (a, b), (c, d) = matrix
    error = _error(system, one.u, matrix, window[:, 1] - window[:, 0], one.p)
    off = error[0, 1] * abs(c) + abs(b) * error[1, 0]
    trace, unsure = a + d, error[0, 0] + error[1, 1]
    determinant = a * d - b * c
    if abs(determinant) <= error[0, 0] * abs(d) + abs(a) * error[1, 1] + off:
        return _singular(one, abs(trace) <= unsure)
    if determinant < 0.0:
        return PlaneType("saddle", "saddle")
    if abs(trace) <= unsure:
        return _centre(one)
    half = 0.5 * (a - d)
    discriminant, doubt = half * half + b * c, abs(half) * unsure + off
    kind = "focus" if discriminant < -doubt else "node" if discriminant > doubt else "degenerate node"
    stability = "stable" if trace < 0.0 else "unstable"
    return PlaneType(f"{stability} {kind}", stability)


def _error(system: CompiledSystem, u: Array, matrix: Array, widths: Array, p: Array) -> Array:
    """Of each entry of the Jacobian, (2, 2).

    The place is known as well as Newton's step for what rounding leaves of the equations' terms is long: at a double
    root, where they vanish like a square, to half the digits only.
    """
    left = TERMS * np.asarray(system.observables(u, p))
    place = np.maximum(LOCATED * widths, np.abs(np.linalg.pinv(matrix)) @ left)
    error = ROUNDING * np.abs(matrix)
    for direction in np.eye(2):
        wide = np.append(direction, np.zeros(len(p)))
        error = error + np.abs(system.gradient(u, p, wide)[:, :2]) * float(place @ direction)
    return np.asarray(error)


def _jet(one: Equilibrium) -> DerivativeJet:
    return jet_at(EquilibriumProblem(one.system, np.array(one.p), 0, one.angle_periods), np.append(one.u, one.p[0]))


def _centre(one: Equilibrium) -> PlaneType:
    """Eigenvalues +-i omega: the first Lyapunov coefficient tells a weak focus from what may be a centre."""
    form = hopf(_jet(one)).coefficients
    sense, words = str(form["criticality"]), f"its eigenvalues are +-i omega; l1 = {float(np.real(form['l1'])):.6g}"
    if sense == "degenerate":
        undecided = "l1 = 0 to rounding: terms up to the third do not tell it from a focus"
        return PlaneType("centre of the linearisation", "neutral", undecided)
    stability = "stable" if sense == "supercritical" else "unstable"
    return PlaneType(f"weak {stability} focus", stability, words)


def _singular(one: Equilibrium, both: bool) -> PlaneType:
    if both:
        return PlaneType("degenerate equilibrium", "neutral", "both eigenvalues are zero to rounding")
    form = fold(_jet(one))
    a = float(np.real(form.coefficients["a"]))
    if abs(a) > form.errors["a"]:
        return PlaneType("saddle-node", "neutral", f"one eigenvalue is zero; on its centre manifold w' = {a:.6g} w^2")
    return PlaneType(
        "degenerate equilibrium", "neutral",
        "one eigenvalue is zero, and so is the quadratic term: perhaps one of a line of equilibria",
    )  # fmt: skip
