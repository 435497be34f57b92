"""The orbit on a curve at which a scalar of its multipliers or its tangent vanishes.

A return map that is only piecewise smooth has no second derivatives, so no defining system is solved by Newton in all
unknowns: the orbit is kept on the curve (Newton with the null space left out, which also works at a branch point), and
a scalar of one variable, the arclength, is brought to zero:

    LPC   the parameter's component of the unit tangent
    BPC   the product of all (multiplier - 1)      PD   the product of all (multiplier + 1)
    NS    the product of the critical pair, minus 1

Products of all are smooth where two multipliers meet; a single one is not. One that symmetries repeat counts once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Rejected
from contin.problems.orbits.linearised.multipliers import nontrivial
from contin.problems.shooting.layout import moving
from contin.problems.shooting.linear import embedded, null_space
from contin.problems.tolerances import SETTLED
from contin.systems.accuracy import accuracy_of_equations

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

FIRST = 1e-5  # arclength of the first secant step
FAR = 0.05  # arclength beyond which the point is another one
BUDGET = 14
NOISE = 4.0  # times the trajectories' accuracy: rounding of the scalar
ALIKE = 1e-6  # multipliers this near are one that symmetries repeat
KERNEL = 1e-4  # singular values below this (relative) belong to the null space
REGULAR = 1e-9  # ... where another branch passes; else they are those of orbits beside which trajectories part


@dataclass(frozen=True, eq=False)
class Located:
    """A point on the curve where the scalar vanishes."""

    z: Array
    residual: float
    error: float = 0.0  # (arclength), estimated


def scalar(type_: str, values: NDArray[np.complex128], tangent: Array) -> float:
    """What vanishes at a special orbit of this type, from the nontrivial multipliers and the tangent."""
    if type_ == "LPC":
        return float(tangent[-1])
    if type_ == "NS":
        products = [
            (values[i] * values[j]).real - 1.0
            for i in range(len(values)) for j in range(i + 1, len(values))
            if abs((values[i] * values[j]).imag) < 1e-9
        ]  # fmt: skip
        return float(min(products, key=abs)) if products else np.nan
    target = -1.0 if type_ == "PD" else 1.0
    together = repeated(values, target)
    return float(np.prod(values[~together] - target).real * (np.mean(values[together]).real - target))


def repeated(values: NDArray[np.complex128], target: complex) -> NDArray[np.bool_]:
    """Which multipliers are the one nearest to the target, perhaps several times, as symmetries make them."""
    nearest = values[np.argmin(np.abs(values - target))]
    return np.asarray(np.abs(values - nearest) <= ALIKE)


def locate(problem: ShotEquations, type_: str, z: Array, tangent: Array, scale: Array) -> Located | Rejected:
    """Secant iteration in arclength on the curve, from z along `tangent` (scaled)."""
    base = z.copy()

    def at(s: float) -> tuple[Array, float, float] | None:
        return on_curve(problem, type_, base + s * scale_of(tangent, scale), tangent, scale)

    here = at(0.0)
    if here is None:
        return Rejected("the orbit is lost")
    noise = NOISE * max(problem.accuracy, accuracy_of_equations(problem.system))
    best, (s0, g0), error = here, (0.0, here[1]), 0.0
    if g0 != 0.0:
        s1 = FIRST
        for _ in range(BUDGET):
            there = at(s1)
            if there is None or not np.isfinite(there[1]):
                return Rejected("the orbit is lost")
            if abs(there[1]) <= abs(best[1]):
                best = there
            g1 = there[1]
            if g1 == g0 or g1 == 0.0:
                break
            slope = (g1 - g0) / (s1 - s0)
            step, error = -g1 / slope, noise / abs(slope)
            if abs(s1 + step) > FAR:
                return Rejected("the test function has no zero nearby")
            s0, g0, s1 = s1, g1, s1 + step
            if abs(step) < SETTLED:
                break
    return Located(best[0], best[2], error)




def scale_of(tangent: Array, scale: Array) -> Array:
    """A scaled direction in the model's units; what does not move stays."""
    return np.where(tangent == 0.0, 0.0, tangent * scale)


def on_curve(
    problem: ShotEquations, type_: str, z: Array, guide: Array, scale: Array
) -> tuple[Array, float, float] | None:
    """The nearest orbit (shortest correction, null space left out), the scalar there, and the residual."""
    positions = moving(len(z), problem.n)
    residual, least = np.inf, KERNEL
    for _ in range(10):
        found = null_space(problem, z, scale)
        if found is None:
            return None
        segments, values, vectors = found
        equations, jacobian = segments.scaled(scale)
        before, residual = residual, float(np.linalg.norm(equations))
        if residual > 0.5 * before:
            more = type_ != "BPC" and np.any((values <= least * values[0]) & (values > REGULAR * values[0]))
            least = REGULAR if more else least
        if residual < 1e-15 or (residual > 0.5 * before and not more):
            break
        kept = values > least * values[0]
        left = jacobian @ vectors[: len(values)].T / np.maximum(values, 1e-300)
        step = -(vectors[: len(values)][kept].T @ (left[:, kept].T @ equations / values[kept]))
        z = z + scale_of(embedded(step, positions, len(z)), scale)
    multipliers = problem.multipliers(z)
    null = embedded(vectors[-1], positions, len(z))
    null = null * np.sign(float(null @ guide) or 1.0)
    return z, scalar(type_, nontrivial(problem, multipliers), null), residual
