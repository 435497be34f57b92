"""Bifurcations of orbits of large systems: what a change means, and location to full precision along the family."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.outcome import Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.machine import elementary
from contin.problems.large_orbits.multipliers import critical_index, stay_outside
from contin.problems.large_orbits.normal_form import with_normal_form
from contin.problems.sparse.zero_on_curve import At, Zero, point_at, zero_on_curve
from contin.problems.tolerances import RESIDUAL_LIMIT_OF_LARGE

if TYPE_CHECKING:
    from contin.abi import Array
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations

SAFETY: Final = 2.0  # of a change from one mesh to the next: the finer one has an error of its own
WORDS: Final = {"PD": "a multiplier -1", "NS": "a pair of multipliers of modulus 1"}


def explain(a: Sample, b: Sample) -> tuple[str, ...] | None:
    """Types that account for the changes between two orbits; None: more than one."""
    fold, _, pairs, turned, one = (bool(x) for x in opposite(a.tests, b.tests))
    moved = abs(b.unstable - a.unstable)
    seen = fold + pairs + turned
    if moved == 0 and not seen and not one:
        return ()
    if moved == 0 and pairs and seen == 1 and not one and stay_outside(a.eigenvalues, b.eigenvalues):
        return ()  # two real multipliers have met there, or parted
    if fold and moved <= 1 and seen == 1:
        return ("LPC",)
    if turned and moved == 1 and seen == 1 and not one:
        return ("PD",)
    if pairs and moved == 2 and seen == 1 and not one:
        return ("NS",)
    return ("BPC",) if moved == 1 and not seen else None


def verify(problem: LargeOrbitEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The orbit of this type near a sample, by the secant method along the family."""
    found = zero_on_curve(problem, near, frame, lambda at: _measured(problem, at, type_))
    if found is None:
        return unverified(type_, f"no orbit with {WORDS.get(type_, 'a turning parameter')} nearby")
    at, left = found.at, found.left
    residual = max(at.residual, abs(left))
    moved, fine = on_finer_mesh(problem, type_, found, frame)
    error = found.error + moved
    if not (residual < RESIDUAL_LIMIT_OF_LARGE and np.isfinite(found.error)):
        return unverified(type_, f"its defining system has no solution nearby (residual {residual:.1e})")
    values, vectors = problem.multipliers(at.z, exactly=True)
    critical = critical_index(values, type_)
    if critical is None:
        return Rejected(f"{type_} not verified: the multiplier that crosses is lost")
    chosen = [critical]
    if type_ == "NS":
        chosen.append(int(np.argmin(np.abs(values - values[critical].conj()))))
    others = np.delete(values, chosen)
    form = {"theta": float(abs(elementary.angle(values[critical])))} if type_ == "NS" else {}
    unstable = int(np.sum(np.abs(others) > 1.0))
    point = Verified(
        type_, at.z, residual, float(error), np.append(1.0 + 0.0j, values), unstable, form,
        {"q": vectors[:, critical]},
    )  # fmt: skip
    return with_normal_form(point, (problem, at.z), fine)


def _measured(problem: LargeOrbitEquations, at: At, type_: str) -> float:
    """What vanishes at an orbit of this type."""
    return float(at.tangent[-1]) if type_ == "LPC" else excess(problem, at, type_)


def on_finer_mesh(
    problem: LargeOrbitEquations, type_: str, found: Zero, frame: Frame
) -> tuple[float, tuple[LargeOrbitEquations, Array] | None]:
    """How far the parameter of a special orbit is from that of the flow, by a mesh of half the lengths, and the orbit
    of this type there.

    One orbit is solved for, on the plane normal to the family; on both meshes the measure has about one slope. Infinite
    where that orbit is not found, or has no such multiplier.
    """
    fine = problem.on_half_lengths(found.at.z, found.at.tangent, frame.scale)
    if fine is None or found.slope == 0.0:
        return float("inf"), None
    finer, there, scale = fine
    measured = _measured(finer, there, type_)
    ahead = -measured / found.slope
    moved = (there.z[-1] - found.at.z[-1]) / frame.scale[-1] + ahead * there.tangent[-1]
    if type_ == "LPC":
        moved += 0.5 * found.slope * elementary.square(ahead)
    error = SAFETY * abs(float(moved)) * float(frame.scale[-1])
    if not np.isfinite(error):
        return error, None
    z = _there(finer, type_, there, measured, ahead, scale)  # a step more: slopes differ beside a branch point
    return max(error, SAFETY * abs(float(z[-1] - found.at.z[-1]))), (finer, z)


def _there(finer: LargeOrbitEquations, type_: str, near: At, measured: float, ahead: float, scale: Array) -> Array:
    """The special orbit on a finer mesh from one near it: a secant step with the slope of that mesh."""
    base = Sample(near.z, near.tangent, np.zeros(0), 0, np.zeros(0, complex))
    at = point_at(finer, base, ahead, near.z + ahead * near.tangent * scale, Frame(scale)) if ahead != 0.0 else None
    if at is None:
        return near.z + ahead * near.tangent * scale
    left = _measured(finer, at, type_)
    further = left * ahead / (measured - left) if abs(left) < abs(measured) else 0.0
    return at.z + further * at.tangent * scale


def excess(problem: LargeOrbitEquations, at: At, type_: str) -> float:
    """How far the critical multiplier is outside the unit circle."""
    values, _ = problem.multipliers(at.z, exactly=True)
    k = critical_index(values, type_)
    return float("nan") if k is None else float(abs(values[k])) - 1.0
