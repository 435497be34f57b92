"""Special orbits found by shooting: located on the curve, twice, and classified by their multipliers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.equilibria.special_points import nearest_pair
from contin.problems.orbits.linearised.multipliers import critical, distance, nontrivial, without
from contin.problems.shooting.branch_point import locate_branch_point
from contin.problems.shooting.crossing import begins, crossing, side_of_branch
from contin.problems.shooting.halving import halving
from contin.problems.shooting.linear import family_tangents
from contin.problems.shooting.locate import Located, locate, repeated
from contin.problems.shooting.normal_form import with_normal_form
from contin.problems.shooting.renewal import is_tangent
from contin.problems.tolerances import RESIDUAL_LIMIT, STAYS_ONE
from contin.systems.accuracy import accuracy_of_equations

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

FINE, COARSE = 1e-13, 1e-12  # accuracies of the trajectories: the result and, by the difference, its error
SAFETY = 2.0  # of errors that are differences of two approximations
REAL = 1e-4  # imaginary part of multipliers that are real and equal but for rounding
BESIDE = 1e-2  # arclength (scaled) to orbits that are looked at beside a fold
STANDING = 1e-10  # of the range: a parameter that changes less between them stands; that of a fold changes as 1e-4
UNCLEAR = 1e-3  # distance of the critical multiplier from its value at which nothing is labelled


def verify(problem: ShotEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The special orbit next to a sample; a string says why there is none, '' that there is nothing to report."""
    if type_ == "neutral":
        pair = nearest_pair(nontrivial(problem, near.eigenvalues), True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return NOTHING
        return Rejected("a pair of multipliers touches the unit circle without a change of the unstable count")

    if type_ == "NS" and _repeats(problem, near):
        type_ = "BPC"
    if type_ in ("BPC", "LPC"):
        halved = halving(problem, near, frame, verify)
        if halved is not None:
            return halved
    find = locate_branch_point if type_ == "BPC" else locate
    found = find(problem.precise(FINE), type_, near.z, near.tangent, frame.scale)
    if isinstance(found, Rejected):
        return unverified(type_, found.reason)
    if type_ == "LPC" and is_tangent(problem, found.z, frame.scale):
        return NOTHING
    if not found.residual <= RESIDUAL_LIMIT:
        return unverified(type_, f"no orbit there (residual {found.residual:.1e})")
    coarse = problem.precise(max(COARSE, accuracy_of_equations(problem.system)))
    rough = find(coarse, type_, found.z, near.tangent, frame.scale)
    if type_ == "LPC" and _crossed(problem.precise(FINE), found, near, frame):
        type_ = "BPC"
    values = problem.precise(FINE).multipliers(found.z)
    others = nontrivial(problem, values)
    theta = 0.0
    if type_ == "NS":
        pair = nearest_pair(others, True)
        if pair is None or abs(pair.imag) <= 1e-9 * abs(pair):
            return Rejected("NS: the two multipliers that cross are real")
        theta = float(elementary.angle(pair))
    targets = critical(type_, theta)
    kernel = int(np.count_nonzero(repeated(others, targets[0]))) if len(targets) == 1 else 1
    gap = distance(others, targets)
    if not gap < UNCLEAR:
        return Rejected(f"{type_} not labelled: the critical multiplier is off by {gap:.1e}")
    if type_ == "LPC" and problem.system.n_switches and _in_continuum(problem, replace(near, z=found.z), frame):
        return Rejected("no folds are labelled where orbits form a continuum at one value of the parameter")
    width = float(frame.scale[-1])
    error = 1e-12 * width if isinstance(rough, Rejected) else abs(float(rough.z[-1] - found.z[-1])) + 1e-14 * width
    error = SAFETY * (error + found.error * width)
    point = Verified(
        type_, found.z, found.residual, error, values, int(np.sum(np.abs(without(others, targets * kernel)) > 1.0)),
        vectors={"theta": theta, "kernel": kernel},
    )  # fmt: skip
    return _with_normal_form(problem, point, frame.scale)


def _crossed(problem: ShotEquations, fold: Located, near: Sample, frame: Frame) -> bool:
    """True where another family passes: the parameter turns on a pitchfork's side branch, too."""
    own = family_tangents(problem, fold.z, frame.scale)
    if len(own) < 2:
        return False
    return any(crossing(problem, fold.z, near.tangent, frame.scale, sense) is not None for sense in (1, -1))


def _in_continuum(problem: ShotEquations, here: Sample, frame: Frame) -> bool:
    """True where orbits on a side of this one have its parameter and the multiplier 1 as well.

    As the cycles of a centre do, where equations are linear on a side of their surfaces.
    """
    width = float(frame.scale[-1])
    for length in (-BESIDE, BESIDE):
        beside = problem.probe(here, length, here.z + length * frame.scale * here.tangent, frame, Settings())
        if beside is None or abs(float(beside.z[-1] - here.z[-1])) > STANDING * width:
            continue
        if distance(nontrivial(problem, beside.eigenvalues), (1.0,)) < STAYS_ONE:
            return True
    return False


def _repeats(problem: ShotEquations, sample: Sample) -> bool:
    """True where the pair nearest to the unit circle is one real multiplier near 1 that symmetries repeat."""
    pair = nearest_pair(nontrivial(problem, sample.eigenvalues), True)
    return problem.fixed is not None and pair is not None and abs(pair - 1.0) < UNCLEAR and abs(pair.imag) < REAL


def verify_compound(problem: ShotEquations, a: Sample, b: Sample, frame: Frame) -> list[Outcome]:
    """Everything that happens at one place: each kind of change is tried by itself."""
    found: list[Outcome] = []
    folds, branches, pairs, flips = (bool(x) for x in opposite(a.tests, b.tests))
    together = pairs and _repeats(problem, a)
    if branches or (a.unstable != b.unstable and not (folds or flips) and (together or not pairs)):
        found.append(verify(problem, "BPC", a, frame))
    elif folds:
        found.append(verify(problem, "LPC", a, frame))
    if flips:
        found.append(verify(problem, "PD", a, frame))
    if pairs and not (branches or folds or flips or together):
        found.append(verify(problem, "NS", a, frame))
    return found


def _with_normal_form(problem: ShotEquations, point: Verified, scale: Array) -> Verified:
    """The coefficient; of a branch point: does the flow have corners on the orbit, and on which side do
    the new orbits lie?"""
    if point.type != "BPC":
        return with_normal_form(problem, point, scale)
    form = side_of_branch(problem, point.z, scale)
    if not form:
        return replace(point, remark="BPC: its kind is not known: no crossing family was found beside it")
    halves = begins(problem, point.z, scale) if form.get("kind") == "nonsmooth" and point.vectors["kernel"] > 1 else ()
    if not halves:
        return replace(point, normal_form=form)
    name, places = problem.parameters[0], " and ".join(f"{value:.10g}" for value in halves)
    why = "BPC is a mean: the multipliers depend on the order in which a surface is crossed"
    return replace(point, normal_form=form, remark=f"{why}; families begin at {name} = {places}")
