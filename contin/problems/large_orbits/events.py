"""Bifurcations of orbits of large systems: what a change means, and location to full precision along the family."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.continuation.problem import Frame, Outcome, Rejected, Sample, Verified, unverified
from contin.machine import elementary
from contin.problems.large_orbits.multipliers import REAL
from contin.problems.sparse.special_points import At, Zero, secant

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations

RESIDUAL_LIMIT: Final = 1e-7
SAFETY: Final = 2.0  # of a change from one mesh to the next: the finer one has an error of its own
WORDS: Final = {"PD": "a multiplier -1", "NS": "a pair of multipliers of modulus 1"}


def explain(a: Sample, b: Sample) -> tuple[str, ...] | None:
    """Types that account for the changes between two orbits; None: more than one."""
    fold, _, pairs, turned, one = (bool(x) for x in a.tests * b.tests < 0.0)
    moved = abs(b.unstable - a.unstable)
    seen = fold + pairs + turned
    if moved == 0 and not seen and not one:
        return ()
    if fold and moved <= 1 and seen == 1:
        return ("LPC",)
    if turned and moved == 1 and seen == 1 and not one:
        return ("PD",)
    if pairs and moved == 2 and seen == 1 and not one:
        return ("NS",)
    return ("BPC",) if moved == 1 and not seen else None


def verify(problem: LargeOrbitEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The orbit of this type near a sample, by the secant method along the family."""
    found = secant(problem, near, frame, lambda at: _measured(problem, at, type_))
    if found is None:
        return unverified(type_, f"no orbit with {WORDS.get(type_, 'a turning parameter')} nearby")
    at, left = found.at, found.left
    residual = max(at.residual, abs(left))
    error = found.error + moved_by_mesh(problem, type_, found, frame)
    if not (residual < RESIDUAL_LIMIT and np.isfinite(found.error)):
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
    return Verified(
        type_, at.z, residual, float(error), np.append(1.0 + 0.0j, values), unstable, form,
        {"q": vectors[:, critical]},
    )  # fmt: skip


def _measured(problem: LargeOrbitEquations, at: At, type_: str) -> float:
    """What vanishes at an orbit of this type."""
    return float(at.tangent[-1]) if type_ == "LPC" else excess(problem, at, type_)


def moved_by_mesh(problem: LargeOrbitEquations, type_: str, found: Zero, frame: Frame) -> float:
    """How far the parameter of a special orbit is from that of the flow, by a mesh of half the lengths.

    One orbit is solved for there, on the plane normal to the family; on both meshes the measure has one slope. Infinite
    where that orbit is not found, or has no such multiplier.
    """
    fine = problem.on_half_lengths(found.at.z, found.at.tangent, frame.scale)
    if fine is None or found.slope == 0.0:
        return float("inf")
    finer, there, _ = fine
    ahead = -_measured(finer, there, type_) / found.slope
    moved = (there.z[-1] - found.at.z[-1]) / frame.scale[-1] + ahead * there.tangent[-1]
    if type_ == "LPC":
        moved += 0.5 * found.slope * elementary.square(ahead)
    return SAFETY * abs(float(moved)) * float(frame.scale[-1])


def critical_index(values: NDArray[np.complex128], type_: str) -> int | None:
    """Index of the multiplier of a type."""
    real = np.abs(values.imag) <= REAL * np.abs(values)
    kind = values.imag > REAL * np.abs(values) if type_ == "NS" else real
    if type_ == "PD":
        kind = kind & (values.real < 0.0)
    elif type_ != "NS":
        kind = kind & (values.real > 0.0)
    found = np.flatnonzero(kind)
    return int(found[int(np.argmin(np.abs(np.abs(values[found]) - 1.0)))]) if found.size else None


def excess(problem: LargeOrbitEquations, at: At, type_: str) -> float:
    """How far the critical multiplier is outside the unit circle."""
    values, _ = problem.multipliers(at.z, exactly=True)
    k = critical_index(values, type_)
    return float("nan") if k is None else float(abs(values[k])) - 1.0
