"""Codimension-two points on curves of folds, Hopf points and branch points: what a change means, and its verification.

A point is verified by Newton on its own defining system: the equations of the curve and one more, a smooth function
that vanishes at points of the type (`codim2.functions`). Then eigenvalues, their number on the unstable side without
the critical ones, and the normal form are computed from exact derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import ERROR_OF
from contin.continuation.outcome import NOTHING, Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Chunk, Frame, Sample, Stop, opposite
from contin.continuation.turning_off import CROSSED
from contin.loci.codim2 import degenerate, zero_hopf_crossing
from contin.loci.codim2.double_zero import on_branch_points
from contin.loci.codim2.fold_ends import at_fold
from contin.loci.codim2.forms import described
from contin.loci.codim2.functions import critical_indices, function_of, rounding_of
from contin.loci.codim2.matrices import eigenvalues, null_pair, scaled_matrix
from contin.loci.codim2.solving import DIFFERENCE, RESIDUAL_LIMIT, Solution, solve
from contin.loci.codim2.triple_zero import triple_zero
from contin.loci.tolerances import ILL_CONDITIONED
from contin.records import Fields
from contin.special.table import signs_of_points, tests_of_points

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints

UNLABELLED: Final[Mapping[str, Mapping[str, int]]] = {  # events that are no special points, by their tests
    "LP": {"double zero": 3, "neutral": 4}, "HB": {"neutral": 4}, "BP": {"neutral": 4}, "PD": {"neutral": 4},
    "NS": {"neutral": 7},
}  # fmt: skip
NEAR_BT = 1e-3  # kappa (scaled) to which the positive side of a BT is searched for a zero of l1
ACCURATE = 1e-11  # an estimated error above this is more than that of a regular defining system
WITH_POLES = ("GH", "CH", "GPD")  # coefficients, which have poles where a further eigenvalue is critical
CROSSINGS = (("ZH", "HB"), ("LPPD", "PD"), ("LPNS", "NS"))  # where curves of one type cross, if nothing unfolds them
AT_POLE: Final[Mapping[str, str]] = {"GH": "ZH", "GPD": "LPPD", "CH": "LPNS"}  # there, by the coefficient with a pole
JUMP = 0.2  # relative change of a test's modulus from which it may have passed through zero
JUMPING = 1e-6  # scaled distance of two points between which a test jumps, or passes through zero more steeply than any
JORDAN = 1e-3  # |<psi, v>| of unit null vectors at such points, below which they are nearly orthogonal
DOUBLE = 1e-6  # w . v of unit null vectors below this: a Jordan block
DEGENERACY = 2  # the test of DP, which needs a Lyapunov-Schmidt reduction and is computed after the march


def test_of(locus: str, type_: str) -> int | None:
    """Place of the test function whose zero is a point of this type, or another event, on a curve of type `locus`.

    None for points at which a curve ends, which are found as another type (DP and TZ on curves of folds).
    """
    return tests_of_points(locus).get(type_, UNLABELLED.get(locus, {}).get(type_))


def explain(
    locus: str, a: Sample, b: Sample, is_map: bool = False, apart: Callable[[], bool] = lambda: False
) -> tuple[str, ...] | None:
    """The event that explains what changed between two points of a curve; None where one event does not.

    apart : whether the points are so far from each other that tests may pass through zero where they seem to jump.
    """
    events = signs_of_points(locus, is_map)
    crossed = [i for i in events if opposite(a.tests[i], b.tests[i])]
    moved = abs(b.unstable - a.unstable)
    if locus == "LP" and crossed == [2, 3] and moved == 1 and _orientation_jumps(a, b):
        return None if apart() else ("double zero",)
    if not crossed:
        touching = any(a.tests[i] == 0.0 or b.tests[i] == 0.0 for i in events)
        return () if moved == 0 or touching else None
    if len(crossed) > 1:
        return _crossing_of(locus, {events[i][0] for i in crossed}, moved)
    type_, expected = events[crossed[0]]
    if type_ == "BT" and locus == "HB" and max(a.tests[2], b.tests[2]) > NEAR_BT:
        return None  # l1 has no sign beyond BT: look at the rest of the way to it
    if expected == 2 and moved == 0:
        return ("neutral",)
    return (type_,) if moved == expected else None


def _crossing_of(locus: str, types: set[str], moved: int) -> tuple[str, ...] | None:
    """A point where curves cross, to be looked for first: there a coefficient that has no pole changes its test's sign.

    Where it has one, the two tests change at two points: the second is in the rest of the step.
    """
    crossing = next((type_ for type_, on in CROSSINGS if on == locus and type_ in types), None)
    alone = crossing is not None and moved == 1 and len(types) == 2 and bool(types & set(WITH_POLES))
    return (crossing,) if crossing is not None and alone else None


def _orientation_jumps(a: Sample, b: Sample) -> bool:
    """True where a second eigenvalue vanishes beside that of the fold, with an eigenvector of its own.

    (The fold of symmetric states passes a pitchfork that breaks the symmetry.) The null vectors are oriented by the
    adjugate of f_u, which is zero there: both tests that they enter change sign without passing through zero.
    """
    first, second = a.tests[2:4], b.tests[2:4]
    if min(abs(first[1]), abs(second[1])) < JORDAN:  # a Bogdanov-Takens point, with a cusp as near on its other side
        return False
    return bool(np.all(np.abs(first + second) <= JUMP * np.maximum(np.abs(first), np.abs(second))))


def verify(problem: CurveOfPoints, type_: str, near: Sample, frame: Frame) -> Outcome:
    """Solve the defining system of a type from a nearby point of the curve."""
    if type_ == "neutral":
        return NOTHING
    if type_ == "double zero":  # the curve passes through; worth a label only where a third eigenvalue vanishes too
        return triple_zero(problem, near, frame) or NOTHING
    verified = _verified(problem, type_, near, frame)
    if isinstance(verified, Verified) and type_ not in ("BT", "ZH"):
        return verified
    return triple_zero(problem, near, frame) or verified


def _verified(problem: CurveOfPoints, type_: str, near: Sample, frame: Frame) -> Outcome:
    function = function_of(problem, type_, near)
    if isinstance(function, Rejected):
        return unverified(type_, function.reason)
    if (type_, problem.locus) in CROSSINGS and zero_hopf_crossing.is_forced(problem, near.z, frame.scale):
        met = zero_hopf_crossing.solve(problem, function, near, frame)
        if met is not None and met.residual <= RESIDUAL_LIMIT and met.error <= ILL_CONDITIONED:
            point = _point(problem, type_, Solution(met.y, met.residual, met.error, met.errors), frame)
            if isinstance(point, Verified):
                point = replace(point, vectors={**point.vectors, "crossed": True})
            return point
    solved = _solved(problem, type_, function, near, frame)
    if type_ == "CP":
        exact = solved is not None and solved.error <= ACCURATE and solved.residual <= RESIDUAL_LIMIT
        z = near.z if solved is None or not exact else solved.y * frame.scale
        touching = at_fold(problem, z, exact, frame)
        if touching is not None:
            return touching
    crossing = _on_branch_points(problem, type_, solved, near, frame)
    if crossing is not None:
        return crossing
    if solved is None:
        touched = _touched(problem, type_, near, frame)
        return touched or unverified(type_, "Newton on its defining system did not converge")
    if not solved.residual <= RESIDUAL_LIMIT:
        return unverified(type_, f"its defining system has no solution nearby (residual {solved.residual:.1e})")
    if not solved.error <= ILL_CONDITIONED:
        return Rejected(
            f"{type_} not labelled: its defining system is singular there, a point more degenerate than its type"
        )
    if type_ == "BT" and not solved.alone:  # rounding of its function makes changes of sign between two of them
        return Rejected(f"{type_} not labelled: others lie closer than {DIFFERENCE:g} to it (scaled)")
    return _point(problem, type_, solved, frame)


def _on_branch_points(
    problem: CurveOfPoints, type_: str, solved: Solution | None, near: Sample, frame: Frame
) -> Verified | None:
    """The double zero at which a curve of pairs meets one of branch points: what makes its own system singular."""
    if (type_, problem.locus) not in (("BT", "HB"), ("R1", "NS")):
        return None
    if solved is not None and solved.error <= ACCURATE and solved.residual <= RESIDUAL_LIMIT:
        return None
    z = near.z if solved is None else solved.y * frame.scale
    if not zero_hopf_crossing.is_forced(problem, z, frame.scale):
        return None
    return on_branch_points(problem, type_, z[: problem.n], z)


def _touched(problem: CurveOfPoints, type_: str, near: Sample, frame: Frame) -> Verified | None:
    """The crossing on an invariant plane that a curve touches, for a zero of a coefficient that has a pole there.

    Where the quadratic coefficient of the branches that leave the plane vanishes too, the further eigenvalue is that of
    a pitchfork: it comes to the stability boundary and goes back, and its test does not change its sign.
    """
    if type_ not in AT_POLE or not zero_hopf_crossing.is_forced(problem, near.z, frame.scale):
        return None
    found = _verified(problem, AT_POLE[type_], near, frame)
    return found if isinstance(found, Verified) else None


def _solved(
    problem: CurveOfPoints, type_: str, function: Callable[[Array], float], near: Sample, frame: Frame
) -> Solution | None:
    """Newton on the curve's equations and the function; of BT on curves of Hopf points, with a v that is regular."""
    if type_ != "BT" or problem.locus != "HB":
        return solve(
            problem, function, near, frame.scale, with_poles=type_ in WITH_POLES,
            rounding=lambda z: rounding_of(problem, type_, z),
        )  # fmt: skip
    curve, z = problem.curve.turned(near.z)
    solved = solve(replace(problem, curve=curve), function, replace(near, z=z), frame.scale)
    if solved is None:
        return None
    found = curve.turned_back(solved.y * frame.scale, near.z)
    if curve.has_scalar:
        found[-3] = 0.0  # kappa, the function itself: neither a Hopf point nor a neutral saddle
    return replace(solved, y=found / frame.scale)


def _point(problem: CurveOfPoints, type_: str, solved: Solution, frame: Frame) -> Outcome:
    """The point with its eigenvalues and normal form; NOTHING for a neutral saddle."""
    z = solved.y * frame.scale
    if is_neutral(problem, type_, z) or (type_ == "DP" and _is_double_zero(problem, z)):
        return NOTHING
    values = eigenvalues(problem, z)
    critical = critical_indices(problem, type_, z, values)
    if critical is None:
        return unverified(type_, "the critical eigenvalues are real")
    others = np.delete(values, critical)
    unstable = int(np.sum(np.abs(others) > 1.0 if problem.system.kind == "map" else others.real > 0.0))
    error = solved.error * float(frame.scale[-1]) + 0.5 * np.finfo(float).eps * abs(float(z[-1]))
    point = Verified(type_, z, solved.residual, error, values, unstable)
    on_locus = type_ in ("ZH", "LPPD", "LPNS") and problem.locus != "LP"
    plane = on_locus and zero_hopf_crossing.is_forced(problem, z, frame.scale, zero_hopf_crossing.EXACT)
    drift = None if solved.drift is None else solved.drift * frame.scale
    described_point = described(problem, point, values[critical], frame.scale, plane, drift)
    known: Fields = {}
    if np.isfinite(solved.second):
        rounded = 0.5 * np.finfo(float).eps * abs(float(z[-2]))
        known["second"] = solved.second * float(frame.scale[-2]) + rounded
    if solved.drift is not None:
        known["reach"] = float(np.linalg.norm(solved.drift[problem.identifying]))
    if solved.each is not None:
        rounding = solved.each * frame.scale + 0.5 * np.finfo(float).eps * np.abs(z)
        names = (f"{ERROR_OF}{name}" for name in problem.system.state_names)
        known |= dict(zip(names, rounding.tolist(), strict=False))
    if solved.crossed and not described_point.remark:
        described_point = replace(described_point, remark=CROSSED)
    return replace(described_point, vectors={**described_point.vectors, **known})


def _is_double_zero(problem: CurveOfPoints, z: Array) -> bool:
    """True where the coefficient of a DP vanishes with w . v: at a Bogdanov-Takens point, which has its own test."""
    shift = np.eye(problem.n) if problem.system.kind == "map" else 0.0
    v, w = null_pair(scaled_matrix(problem, z) - shift, np.zeros(problem.n))
    return problem.n > 1 and abs(float(w @ v)) < DOUBLE


def with_degeneracy(problem: CurveOfPoints, chunk: Chunk) -> Chunk:
    """A chunk along a curve of branch points with the test of DP filled in, cut after its first sign change."""
    previous = 0.0
    for row in range(len(chunk)):
        value = degenerate.test(problem, chunk.z[row])
        chunk.tests[row, DEGENERACY] = value
        if value * previous < 0.0:
            return chunk.cut(row + 1, Stop.EVENT, float(chunk.lengths[row]))
        previous = value
    return chunk


def is_neutral(problem: CurveOfPoints, type_: str, z: Array) -> bool:
    """True where the curve's own critical eigenvalues are real, so that there is no Hopf (Neimark-Sacker) point."""
    if type_ in ("BT", "R1", "R2") or problem.locus not in ("HB", "NS"):
        return False
    scalar = problem.curve.scalar(z)
    return bool(scalar <= 0.0 if problem.locus == "HB" else abs(scalar) >= 1.0)


def verify_compound(problem: CurveOfPoints, a: Sample, b: Sample, frame: Frame) -> list[Outcome]:
    """Events that coincide on the curve: each of the types whose test changes sign, verified from between.

    Also those whose test is exactly zero at one end, where only they explain that the unstable count changes.
    """
    is_map = problem.system.kind == "map"
    events = signs_of_points(problem.locus, is_map)
    changing = [i for i in events if opposite(a.tests[i], b.tests[i])]
    if sum(events[i][1] for i in changing) != abs(b.unstable - a.unstable):
        at_end = [i for i in events if events[i][1] and (a.tests[i] == 0.0) != (b.tests[i] == 0.0)]
        changing = [i for i in events if i in changing or i in at_end]
    found: list[Outcome] = []
    for type_ in (events[i][0] for i in changing):
        if type_ in ("GH", "GPD") and any(_is_crossing(item) for item in found):
            continue  # l1 (c) has no pole there, and did not change its sign: the test counts with one
        found.append(verify(problem, type_, a, frame))
    if problem.locus == "LP" and any(_is_crossing(item) for item in found):
        return [item for item in found if _is_crossing(item)]  # it is what both tests vanish at
    return found


def _is_crossing(item: Outcome) -> bool:
    return isinstance(item, Verified) and bool(item.vectors.get("plane") or item.vectors.get("crossed"))
