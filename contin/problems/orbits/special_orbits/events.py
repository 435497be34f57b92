"""Special orbits: what a change between two samples means, and its verification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Outcome, Rejected, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.machine import elementary
from contin.problems.equal_multipliers import is_repeated
from contin.problems.equilibria import special_points
from contin.problems.orbits.ends.vertical import (
    NOISE,
    UNRESOLVED,
    distance_from_one,
    is_at_birth,
    is_reciprocal,
    stays_critical,
)
from contin.problems.orbits.linearised.bordered import Bordered
from contin.problems.orbits.linearised.linear import SINGULAR, OrbitLinear
from contin.problems.orbits.linearised.multipliers import critical, distance, nontrivial
from contin.problems.orbits.linearised.resolved_multipliers import is_planar
from contin.problems.orbits.special_orbits.defining import flat_fold, is_told_by_equations, solve_special
from contin.problems.orbits.special_orbits.label import UNCLEAR, label
from contin.problems.orbits.symmetric.symmetry import symmetry_of
from contin.problems.tolerances import RESIDUAL_LIMIT_OF_LARGE
from contin.special.table import of_cycle

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations

NO_ORBIT = 1e-3  # an orbit with less amplitude than this (relative) is its Hopf point
CRITICAL = 1e-4  # a multiplier this close to the unit circle takes part in a compound event
FLAT = 1e-5  # |dp/ds| below which its sign may be due to the discretisation
VERTICAL = 1e-7  # ... and below which it may vanish all along the family
RESOLVED = 1e-3  # ... and the multiplier is told from 1
BLURRED = 1e-10  # error of a fold (relative to the range) from which it may be a pitchfork passed on its side branch
LEVEL = 0.02  # cosine of the left null vector and F_p below which a fold may be an imperfect pitchfork of the mesh
ADJACENT = 1e-2  # ... and how far away (scaled) the two may be found


def explain(a: Sample, b: Sample, standing: bool = False, by_count: bool = True) -> tuple[str, ...] | None:
    """Types that account for every sign change and for the change of the unstable count.

    standing : both orbits exist at the parameter of the family's birth, so that dp/ds may be no more than rounding.
    by_count : a fold may be told by the count of multipliers alone ("flat").

    A fold of the discretised equations and a multiplier 1 of the discretised flow differ by the discretisation
    error, so the count may lag behind the test by that much.
    """
    slope = max(abs(a.tests[0]), abs(b.tests[0]))
    if slope < (NOISE if standing else VERTICAL) and stays_critical(a.eigenvalues) and stays_critical(b.eigenvalues):
        return _explain_vertical(a, b)
    if slope < FLAT and np.all(a.tests[1:] * b.tests[1:] > 0.0):
        counted = _explain_flat(a, b)
        if counted is not None and (by_count or counted == ()):
            return counted
    if opposite(a.tests[0], b.tests[0]) and opposite(a.tests[1], b.tests[1]):
        return None  # a fold and a branch point, or a pitchfork passed along its side branch: only up close one knows
    found = special_points.explain(True, a, b)
    if found is not None:
        return tuple(of_cycle(t) for t in found)
    folds, branches, pairs, flips = (bool(x) for x in opposite(a.tests, b.tests))
    moved = abs(a.unstable - b.unstable)
    lagging = min(distance_from_one(a.eigenvalues), distance_from_one(b.eigenvalues)) < UNRESOLVED
    if not (pairs or flips) and moved <= 2 and lagging:
        if branches:
            return ("BPC",)
        return ("LPC",) if folds else ()
    return None


def _explain_flat(a: Sample, b: Sample) -> tuple[str, ...] | None:
    """Where the parameter hardly changes (a canard), the sign of dp/ds is rounding: the multipliers decide."""
    away = min(distance_from_one(a.eigenvalues), distance_from_one(b.eigenvalues))
    trivial = max(abs(a.eigenvalues[0] - 1.0), abs(b.eigenvalues[0] - 1.0))
    if a.unstable == b.unstable and away > max(RESOLVED, 10.0 * trivial):
        return ()
    return ("flat",) if abs(a.unstable - b.unstable) == 1 else None


def _explain_vertical(a: Sample, b: Sample) -> tuple[str, ...] | None:
    """Where all orbits exist at one parameter (a centre) both dp/ds and the distance of a multiplier from 1 are zero up
    to rounding."""
    branches, pairs, flips = (bool(x) for x in opposite(a.tests[1:], b.tests[1:]))
    if len(a.eigenvalues) > 2 and is_reciprocal(a.eigenvalues) and is_reciprocal(b.eigenvalues):
        return ("BPC",) * branches + ("PD",) * flips
    if pairs or flips or abs(a.unstable - b.unstable) > 1:
        return None
    return ("BPC",) if branches else ()


def verify(problem: OrbitEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """Solve the defining system of a simple event; a string says why it is none, '' that there is nothing to report."""
    theta, width = 0.0, float(frame.scale[-1])
    flat = type_ == "flat"
    if flat:
        type_ = "LPC"
    if type_ in ("NS", "neutral"):
        pair = special_points.nearest_pair(nontrivial(problem, near.eigenvalues), True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return NOTHING if type_ == "neutral" else Rejected("NS: the two multipliers that cross are real")
        if type_ == "neutral":
            return Rejected("a pair of multipliers touches the unit circle without a change of the unstable count")
        theta = float(elementary.angle(pair))
        if is_repeated(nontrivial(problem, near.eigenvalues), pair):  # its equations are singular there
            return Rejected("NS: several pairs of multipliers are equal there, and none is told from the others")
    if type_ in ("LPC", "BPC") and _at_rest(problem, near.z, frame):
        return NOTHING
    if type_ == "PD" and _orientable(problem, near.z):
        return NOTHING
    solved = by_equations = solve_special(problem, type_, near.z, frame.scale, theta)
    flat = flat and not (solved is not None and is_told_by_equations(problem, solved, near.z))
    if flat:
        solved = flat_fold(problem, near.z, frame.scale)
    blurred = solved is None or not solved.confirmed or solved.error > BLURRED * width
    if type_ == "LPC" and not flat and (blurred or not _turns(problem, solved, frame)):
        pitchfork = solve_special(problem, z=near.z, scale=frame.scale, type_="BPC")
        if pitchfork is not None and (solved is None or _one(solved, pitchfork, frame)):
            solved, type_ = pitchfork, "BPC"
    if solved is None and flat:
        return Rejected(
            "no folds are labelled where the parameter is constant to rounding and multipliers are not resolved"
        )
    if solved is None:
        return unverified(type_, "Newton on its defining system did not converge")
    if not solved.residual <= RESIDUAL_LIMIT_OF_LARGE:
        return unverified(type_, f"its defining system has no solution nearby (residual {solved.residual:.1e})")
    if type_ == "NS" and abs(solved.theta - theta) > 0.3:
        return unverified("NS", f"the angle moved from {theta:.3g} to {solved.theta:.3g}")
    if type_ in ("LPC", "BPC") and _at_rest(problem, solved.z, frame):
        return NOTHING  # the family passes through a Hopf point and comes back
    if type_ == "LPC" and is_at_birth(problem, solved.z, solved.error, frame):
        return NOTHING
    if type_ == "LPC" and not solved.confirmed:
        return Rejected(
            f"{type_} not confirmed: it is not there on a mesh of half the lengths, so the parameter is constant to "
            "its error"
        )
    return label(problem, type_, solved, width, by_equations)


def _orientable(problem: OrbitEquations, z: Array) -> bool:
    """True for orbits without a simple negative multiplier: a sign that changes is rounding.

    In the plane the multiplier is exp(integral of the divergence). Those of an orbit that a symmetry shifts by
    half a period are the squares of those of half the orbit (Swift and Wiesenfeld, Phys. Rev. Lett. 52 (1984) 705).
    """
    if is_planar(problem):
        return True
    kept = symmetry_of(problem, z)
    return kept is not None and kept[1] == 0.5


def _turns(problem: OrbitEquations, fold: Any, frame: Frame) -> bool:
    """True where w . F_p is far from zero, which it is at branch points (on a mesh that is not symmetric: nearly).

    w, the left null vector, is told by [F_u F_T F_p; right null vector], singular where w . F_p = 0. F_p itself
    is zero there if the parameter multiplies what one of the branches has none of.
    """
    linear = OrbitLinear(problem, fold.z, frame.scale, fold.z)
    try:
        regular = Bordered.with_borders(
            linear.jacobian, np.empty((linear.nu + 1, 0)), np.pad(fold.right, ((0, 1), (0, 0)))
        )
    except np.linalg.LinAlgError:  # singular at branch points, which is what is asked
        return False
    column = linear.jacobian[:, [-1]].toarray()[:, 0]
    left = regular.factors.solve(np.append(np.zeros(linear.nu + 1), 1.0), "T")[:-1]
    size = float(np.linalg.norm(left))
    if size * float(abs(linear.jacobian).max()) * SINGULAR > 1.0:
        return False
    return bool(abs(float(left @ column)) > LEVEL * size * float(np.linalg.norm(column)))


def _one(fold: Any, branch_point: Any, frame: Frame) -> bool:
    """True where a fold cannot be told from a branch point: the parameter turns on a pitchfork's side branch too."""
    gap = (fold.z - branch_point.z) / frame.scale
    errors = (fold.error + branch_point.error) / float(frame.scale[-1])
    return abs(float(gap[-1])) <= 2.0 * errors and float(np.linalg.norm(gap)) < ADJACENT


def _at_rest(problem: OrbitEquations, z: Array, frame: Frame) -> bool:
    """True where a family is at its Hopf point; a forced system may rest as well as move."""
    extent = float(np.max(np.ptp(problem.profile(z).u, axis=0) / problem.sizes(z, frame.scale)))
    return problem.autonomous and extent < NO_ORBIT


def verify_compound(problem: OrbitEquations, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
    """Everything that happens at one place: each kind of change is tried by itself."""
    found: list[Outcome] = []
    folds, branches, _, flips = (bool(x) for x in opposite(a.tests, b.tests))
    if branches:
        found.append(verify(problem, "BPC", a, frame))
    elif folds:
        found.append(verify(problem, "LPC", a, frame))
    if flips:
        found.append(verify(problem, "PD", a, frame))
    values = nontrivial(problem, a.eigenvalues)
    if any(v.imag > 1e-6 and abs(abs(v) - 1.0) < CRITICAL for v in values):
        found.append(verify(problem, "NS", a, frame))
    near_one = distance(values, critical("BPC", 0.0)) < UNCLEAR
    if not found and a.unstable != b.unstable and branches == folds and near_one:
        found.append(verify(problem, "BPC", a, frame))
    return found
