"""Special orbits found by shooting: located on the curve with trajectories of the highest accuracy.

A return map that is only piecewise smooth has no second derivatives, so no defining system is solved by Newton in all
unknowns: the orbit is kept on the curve (Newton with the null space left out, which also works at a branch point), and a
scalar of one variable, the arclength, is brought to zero:

    LPC   the parameter's component of the unit tangent
    BPC   the multiplier next to 1, minus 1        PD   the multiplier next to -1, plus 1
    NS    the product of the critical pair, minus 1
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Frame, Sample, Verified
from contin.problems.shooting.layout import moving
from contin.problems.shooting.linear import embedded, null_space
from contin.problems.special import _critical_pair

FINE, COARSE = 1e-13, 1e-12  # accuracies of the trajectories: the result and, by the difference, its error
FIRST = 1e-5  # arclength of the first secant step
FAR = 0.05  # arclength beyond which the point is another one
BUDGET = 14
SETTLED = 1e-13
KERNEL = 1e-4  # singular values below this (relative) belong to the null space
RESIDUAL_LIMIT = 1e-8
UNCLEAR = 1e-3  # distance of the critical multiplier from its value at which nothing is labelled


@dataclass(frozen=True, eq=False)
class Located:
    """A point on the curve where the scalar vanishes."""

    z: Array
    value: float  # of the scalar there
    residual: float
    slope: float  # of the scalar by arclength
    step: float  # last change of arclength


def verify(problem: Any, type_: str, near: Sample, frame: Frame) -> Verified | str:
    """The special orbit next to a sample; a string says why there is none, '' that there is nothing to report."""
    if type_ == "neutral":
        pair = _critical_pair(nontrivial(problem, near.eigenvalues), True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return ""
        return "a pair of multipliers touches the unit circle without a change of the unstable count"
    found = locate(problem.precise(FINE), type_, near.z, near.tangent, frame.scale)
    if isinstance(found, str):
        return f"{type_} not verified: {found}"
    if not found.residual <= RESIDUAL_LIMIT:
        return f"{type_} not verified: no orbit there (residual {found.residual:.1e})"
    rough = locate(problem.precise(COARSE), type_, found.z, near.tangent, frame.scale)
    values = problem.precise(FINE).multipliers(found.z)
    others = nontrivial(problem, values)
    theta = 0.0
    if type_ == "NS":
        pair = _critical_pair(others, True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return "NS: the two multipliers that cross are real"
        theta = float(np.angle(pair))
    critical = _targets(type_, theta)
    gap = float(max(np.min(np.abs(others - target), initial=np.inf) for target in critical))
    if not gap < UNCLEAR:
        return f"{type_} not labelled: the critical multiplier is off by {gap:.1e}"
    rest = list(others)
    for target in critical:
        rest.pop(int(np.argmin([abs(v - target) for v in rest])))
    width = float(frame.scale[-1])
    error = 1e-12 * width if isinstance(rough, str) else abs(float(rough.z[-1] - found.z[-1])) + 1e-14 * width
    return Verified(
        type_, found.z, found.residual, error, values, sum(abs(v) > 1.0 for v in rest),
        normal_form=_normal_form(problem, type_, found.z, frame.scale), vectors={"theta": theta},
    )  # fmt: skip


def verify_compound(problem: Any, a: Sample, b: Sample, frame: Frame) -> list[Verified | str]:
    """Everything that happens at one place: each kind of change is tried by itself."""
    found: list[Verified | str] = []
    folds, branches, pairs, flips = (bool(x) for x in a.tests * b.tests < 0.0)
    if branches or (a.unstable != b.unstable and not (folds or pairs or flips)):
        found.append(verify(problem, "BPC", a, frame))
    elif folds:
        found.append(verify(problem, "LPC", a, frame))
    if flips:
        found.append(verify(problem, "PD", a, frame))
    if pairs and not (branches or folds or flips):
        found.append(verify(problem, "NS", a, frame))
    return found


def nontrivial(problem: Any, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Multipliers without the trivial one of an autonomous system."""
    return values[1:] if problem.autonomous else values


def _targets(type_: str, theta: float) -> tuple[complex, ...]:
    """The critical multipliers."""
    if type_ == "NS":
        return complex(np.exp(1j * theta)), complex(np.exp(-1j * theta))
    return (-1.0,) if type_ == "PD" else (1.0,)


def _normal_form(problem: Any, type_: str, z: Array, scale: Array) -> Mapping[str, Any]:
    """At a branch point: does the flow have corners on the orbit, and on which side do the new orbits lie?"""
    if type_ != "BPC":
        return {}
    from contin.problems.shooting.switch import side_of_branch

    return side_of_branch(problem, z, scale)


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
    real = values[np.abs(values.imag) < 1e-9 * np.maximum(np.abs(values), 1.0)].real
    return float(real[np.argmin(np.abs(real - target))] - target) if real.size else np.nan


def locate(problem: Any, type_: str, z: Array, tangent: Array, scale: Array) -> Located | str:
    """Secant iteration in arclength on the curve, from z along `tangent` (scaled)."""
    base = z.copy()

    def at(s: float) -> tuple[Array, float, float] | None:
        return _on_curve(problem, type_, base + s * scale_of(tangent, scale), tangent, scale)

    here = at(0.0)
    if here is None:
        return "the orbit is lost"
    best, (s0, g0), slope, step = here, (0.0, here[1]), np.nan, 0.0
    if g0 != 0.0:
        s1 = FIRST
        for _ in range(BUDGET):
            there = at(s1)
            if there is None or not np.isfinite(there[1]):
                return "the orbit is lost"
            if abs(there[1]) <= abs(best[1]):
                best = there
            g1 = there[1]
            if g1 == g0 or g1 == 0.0:
                break
            slope = (g1 - g0) / (s1 - s0)
            step = -g1 / slope
            if abs(s1 + step) > FAR:
                return "the test function has no zero nearby"
            s0, g0, s1 = s1, g1, s1 + step
            if abs(step) < SETTLED:
                break
    return Located(best[0], best[1], best[2], slope, step)


def scale_of(tangent: Array, scale: Array) -> Array:
    """A scaled direction in the model's units; what does not move stays."""
    return np.where(tangent == 0.0, 0.0, tangent * scale)


def _on_curve(
    problem: Any, type_: str, z: Array, guide: Array, scale: Array
) -> tuple[Array, float, float] | None:
    """The nearest orbit (shortest correction, null space left out), the scalar there, and the residual."""
    positions = moving(len(z), problem.n)
    residual = np.inf
    for _ in range(8):
        found = null_space(problem, z, scale)
        if found is None:
            return None
        segments, values, vectors = found
        equations, jacobian = segments.scaled(scale)
        before, residual = residual, float(np.linalg.norm(equations))
        if residual < 1e-15 or residual > 0.5 * before:
            break
        kept = values > KERNEL * values[0]
        left = jacobian @ vectors[: len(values)].T / np.maximum(values, 1e-300)
        step = -(vectors[: len(values)][kept].T @ (left[:, kept].T @ equations / values[kept]))
        z = z + scale_of(embedded(step, positions, len(z)), scale)
    multipliers = problem.multipliers(z)
    null = embedded(vectors[-1], positions, len(z))
    null = null * np.sign(float(null @ guide) or 1.0)
    return z, scalar(type_, nontrivial(problem, multipliers), null), residual
