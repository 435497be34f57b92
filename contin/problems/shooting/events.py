"""Special orbits found by shooting: located on the curve with trajectories of the highest accuracy.

A return map that is only piecewise smooth has no second derivatives, so no defining system is solved by Newton in all
unknowns: the orbit is kept on the curve (Newton with the null space left out, which also works at a branch point), and
a scalar of one variable, the arclength, is brought to zero:

    LPC   the parameter's component of the unit tangent
    BPC   the product of all (multiplier - 1)      PD   the product of all (multiplier + 1)
    NS    the product of the critical pair, minus 1

Products of all are smooth where two multipliers meet; a single one is not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
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
APART = (1e-2, 2.5e-3, 6e-4, 1.5e-4)  # arclengths between the orbits that a branch point is interpolated from
AGREED = 1e-8  # (arclength) places interpolated from two of them that agree so well are final
CONVERGED = 1e-6  # (arclength) Newton steps below this, ...
PATIENCE = 3  # ... of which so many in succession improved nothing, are rounding
NEWTON = 30
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
    error: float = 0.0  # (arclength) of the interpolation, estimated


def verify(problem: Any, type_: str, near: Sample, frame: Frame) -> Verified | str:
    """The special orbit next to a sample; a string says why there is none, '' that there is nothing to report."""
    if type_ == "neutral":
        pair = _critical_pair(nontrivial(problem, near.eigenvalues), True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return ""
        return "a pair of multipliers touches the unit circle without a change of the unstable count"
    from contin.problems.shooting.renewal import is_tangent

    find = locate_branch_point if type_ == "BPC" else locate
    found = find(problem.precise(FINE), type_, near.z, near.tangent, frame.scale)
    if isinstance(found, str):
        return f"{type_} not verified: {found}"
    if type_ == "LPC" and is_tangent(problem, found.z, frame.scale):
        return ""
    if not found.residual <= RESIDUAL_LIMIT:
        return f"{type_} not verified: no orbit there (residual {found.residual:.1e})"
    rough = find(problem.precise(COARSE), type_, found.z, near.tangent, frame.scale)
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
    error += found.error * width
    return Verified(
        type_, found.z, found.residual, error, values, sum(abs(v) > 1.0 for v in rest),
        normal_form=_normal_form(problem, type_, found.z, frame.scale, theta), vectors={"theta": theta},
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


def _normal_form(problem: Any, type_: str, z: Array, scale: Array, theta: float) -> Mapping[str, Any]:
    """Of a PD and NS the criticality; of a branch point: does the flow have corners on the orbit, and on which side do
    the new orbits lie?"""
    if type_ in ("PD", "NS"):
        from contin.problems.shooting.normal_form import criticality

        return criticality(problem, type_, z, problem.sizes(z, scale), theta)
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
    return float(np.prod(values - target).real)


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


def locate_branch_point(problem: Any, type_: str, z: Array, tangent: Array, scale: Array) -> Located | str:
    """As `_interpolated`, from orbits as far away as they exist, then nearer ones until the place stays the same.

    The further away, the less rounding matters; but another branch point may lie between.
    """
    found: Located | str = "an orbit beside it is lost"
    best: Located | None = None
    for apart in APART:
        found = _interpolated(problem, type_, z if best is None else best.z, tangent, scale, apart)
        if isinstance(found, str):
            if best is not None:
                break
            continue
        if best is None:
            best = replace(found, error=apart)
            continue
        moved = float(np.linalg.norm(np.where(scale > 0.0, (found.z - best.z) / scale, 0.0)))
        if moved < AGREED:
            return replace(best, error=moved)
        if moved >= best.error:
            break  # rounding
        best = replace(found, error=moved)
    return found if best is None else best


def _interpolated(
    problem: Any, type_: str, z: Array, tangent: Array, scale: Array, apart: float
) -> Located | str:
    """The branch point on the family through z, by interpolation between orbits at a distance from it.

    Next to the point itself Newton's method leaves the direction of the crossing family undetermined, so that nothing
    measured there is accurate. The orbits at +-d and +-2 d along the family are; polynomials through them give the
    arclength at which the multiplier is 1, and the orbit there, with an error of the fourth order in d.
    """
    t = _direction(problem, z, tangent, scale, apart)
    if t is None:
        return "the family cannot be followed through it"
    base, slope, step = z, np.nan, 0.0
    for distance in (apart, apart):
        lengths, orbits, values = [], [], []
        for s in distance * np.array([-2.0, -1.0, 1.0, 2.0]):
            orbit = _beside(problem, base, t, s, scale)
            if isinstance(orbit, str):
                return f"an orbit beside it is lost ({orbit})"
            lengths.append(s)
            orbits.append(orbit)
            values.append(scalar(type_, nontrivial(problem, problem.multipliers(orbit)), t))
        coefficients = np.polyfit(lengths, values, 3)
        roots = np.roots(coefficients)
        real = roots.real[np.abs(roots.imag) < 1e-9 * distance]
        if not real.size or float(np.abs(real).min()) > 3.0 * distance:
            return "the multiplier does not pass 1 nearby"
        step = float(real[np.argmin(np.abs(real))])
        slope = float(np.polyval(np.polyder(coefficients), step))
        weights = [
            np.prod([(step - b) / (a - b) for b in lengths if b != a]) for a in lengths
        ]  # fmt: skip
        base = np.array(weights) @ np.array(orbits)
    refined = _on_curve(problem, type_, base, t, scale)
    return "the orbit is lost" if refined is None else Located(refined[0], refined[1], refined[2], slope, step)


def _beside(problem: Any, base: Array, t: Array, s: float, scale: Array) -> Array | str:
    """The orbit at arclength s from base along t, by Newton until rounding: near the point that is not very small.

    On a piecewise linear map (two oscillators that cross a surface together, in either order) Newton's steps may shrink
    slowly at first, so the best of the iterates is taken once none was better for some time.
    """
    y, size, best, least, since = s * t, np.inf, None, np.inf, 0
    for _ in range(NEWTON):
        z = base + scale_of(y, scale)
        here = problem.linearisation(z, t, scale)
        if here is None:
            return "not finite"
        if here.sign == 0.0:
            return "singular"
        miss = float(np.linalg.norm(np.append(here.residual, s - float(t @ y))))
        since = 0 if miss < 0.5 * least else since + 1
        if miss < least:
            best, least = z, miss
        if size < SETTLED or (size < CONVERGED and since >= PATIENCE):
            return best if best is not None else "not finite"
        step = here.solve(np.append(-here.residual, s - float(t @ y)))
        size = float(np.linalg.norm(step))
        if not size < 0.1:
            return "diverged"
        y = y + step
    return "no convergence"


def _direction(problem: Any, z: Array, tangent: Array, scale: Array, apart: float) -> Array | None:
    """A tangent of a family through the branch point near z: `tangent`, or the direction that changes p the most."""
    plane = null_space(problem, z, scale)
    if plane is None:
        return None
    rates = plane[2][-2:, -1]
    steepest = embedded(rates @ plane[2][-2:], moving(len(z), problem.n), len(z))
    for guess in (tangent, steepest):
        size = float(np.linalg.norm(guess))
        if size == 0.0:
            continue
        t = guess / size
        sides = [_beside(problem, z, t, s, scale) for s in (apart, -apart)]
        if any(isinstance(side, str) for side in sides):
            continue
        ahead, behind = (np.where(t == 0.0, 0.0, (side - z) / scale) for side in sides)  # type: ignore[operator]
        chord = ahead - behind
        length = float(np.linalg.norm(chord))
        if length > 1.9 * float(np.linalg.norm(ahead)) and length > 1.9 * float(np.linalg.norm(behind)):
            return np.asarray(chord / length)
    return None


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
