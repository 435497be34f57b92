"""When are two branches the same? Up to declared symmetries and angle periods, never by name or parameter value."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem
from contin.problems.symmetry import apply_symmetry, every_symmetry

SAME = 1e-6  # scaled distance of a point from a curve
INSIDE = 1e-4  # scaled distance
OUTSIDE = 0.2  # of a step: how far beyond its end a point is looked for
PARALLEL = 0.9999  # cosine of two tangents, which are exact at labelled points


def wrapped(difference: Array, periods: Array) -> Array:
    """A difference of unknowns (last axis: states, parameter) with angles brought to the nearest period."""
    result = np.array(difference, dtype=float)
    for k in np.flatnonzero(periods):
        result[..., k] -= periods[k] * np.round(result[..., k] / periods[k])
    return result


def copies(problem: Any, z: Array, tangent: Array | None = None) -> Iterable[tuple[Array, Array | None]]:
    """(z, tangent) and its images under the declared symmetries; cycles of maps from each of their points."""
    if isinstance(problem, CycleProblem):
        for shifted in range(1, problem.period):
            yield problem.shifted(z, shifted), None if tangent is None else problem.shifted(tangent, shifted)
    yield z, tangent
    for symmetry in every_symmetry(problem):
        mapped = apply_symmetry(problem, symmetry, z)[0]
        image = None
        if tangent is not None:
            size = 1e-6 * (float(np.abs(z).max()) or 1.0) / max(float(np.abs(tangent).max()), 1e-300)
            ahead = apply_symmetry(problem, symmetry, z + size * tangent)[0]
            behind = apply_symmetry(problem, symmetry, z - size * tangent)[0]
            image = (ahead - behind) / (2.0 * size)
        yield mapped, image


def lies_on(branch: Branch, z: Array, tangent: Array | None, scale: Array) -> bool:
    """True where the point z (with this raw tangent, if given) is on the branch.

    The nearest rows are looked up first; then the curve is solved for beside z, so that the answer does not depend
    on how densely the branch was sampled.
    """
    problem = branch.problem
    offsets = wrapped(branch.z - z, problem.angle_periods) / scale
    distances = np.linalg.norm(offsets, axis=1)
    gaps = np.linalg.norm(np.diff(branch.z, axis=0) / scale, axis=1) if len(branch) > 1 else np.zeros(1)
    reach = 2.0 * float(gaps.max(initial=0.0)) + 1e-9
    inside = z  # a little way into the branch: it may begin on a surface of discontinuity
    if tangent is not None:
        inside = z + INSIDE * tangent / max(float(np.linalg.norm(tangent / scale)), 1e-300)
    for row in np.argsort(distances)[:4]:
        if distances[row] > reach:
            return False
        beside = branch.z[min(max(row, 1), max(len(branch) - 2, 0))]  # an end may lie on such a surface
        if isinstance(problem, EquilibriumProblem) and problem.separated(beside, inside):
            continue
        along = branch.tangents[row] / scale
        norm = float(np.linalg.norm(along))
        if norm == 0.0:
            continue
        along = along / norm
        base = Sample(branch.z[row], along, np.full(4, np.nan), 0, np.empty(0, complex))
        length = float(-offsets[row] @ along)
        if distances[row] < SAME:  # on the row itself, which may be a branch point, where Newton does not work
            if tangent is None or abs(float(along @ (tangent / scale))) > PARALLEL * np.linalg.norm(tangent / scale):
                return True
            aside = _stepped(problem, z, tangent / scale, 0.1 * float(gaps.max(initial=0.0)), scale)
            return aside is not None and lies_on(branch, aside, None, scale)
        target = branch.z[row] - offsets[row] * scale  # z, in the angles' sheet of the row
        guess = _guess(branch, int(row), length, along, scale)
        if guess is None:
            continue
        found = problem.probe(base, length, guess, Frame(scale), Settings())
        if found is None or float(np.linalg.norm((found.z - target) / scale)) > SAME:
            continue
        if tangent is None:
            return True
        t = tangent / scale
        if abs(float(found.tangent @ t)) > PARALLEL * float(np.linalg.norm(t)):
            return True
    return False


def _guess(branch: Branch, row: int, length: float, along: Array, scale: Array) -> Array | None:
    """A point of the branch at this length along the tangent of a row; None where another row is the one to begin at.

    A tangent's is not good enough to tell branches apart that touch, so the cubic through the next row is taken that
    has the tangents of both.
    """
    z, near = branch.z, branch.z[row]
    other = row + (1 if length * float(along @ (branch.tangents[row] / scale)) > 0.0 else -1)
    straight = np.asarray(near + length * scale * along)
    if not 0 <= other < len(z):
        return straight
    chord = wrapped(z[other] - near, branch.problem.angle_periods)
    whole = float(chord / scale @ along)
    slope = branch.tangents[other] / scale
    rate = float(slope @ along)
    if abs(rate) < 0.5 * float(np.linalg.norm(slope)) or abs(whole) < 0.5 * float(np.linalg.norm(chord / scale)):
        return straight  # a sharp turn
    x = length / whole
    if x > 1.0 + OUTSIDE:
        return None
    a, b = whole * scale * along, whole * branch.tangents[other] / rate
    return np.asarray(near + x * chord + x * (1 - x) * ((1 - x) * (a - chord) - x * (b - chord)))


def _stepped(problem: Any, z: Array, along: Array, length: float, scale: Array) -> Array | None:
    """A point of the curve through the branch point z in the direction `along`; None where Newton finds none.

    A branch that crosses itself passes a branch point twice but has one row there, with one of the two tangents. The
    other passage is recognised beside the point, where the curve is regular again.
    """
    norm = float(np.linalg.norm(along))
    if norm == 0.0 or length == 0.0:
        return None
    base = Sample(z, along / norm, np.full(4, np.nan), 0, np.empty(0, complex))
    found = problem.probe(base, length, z + length * scale * base.tangent, Frame(scale), Settings())
    return None if found is None else np.asarray(found.z)


def is_known(branches: Iterable[Branch], problem: Any, z: Array, tangent: Array | None, scale: Array) -> Branch | None:
    """The branch that already contains z with this tangent, or the image of it; None where it is new."""
    variants = list(copies(problem, z, tangent))
    for branch in branches:
        if branch.image_of is not None or branch.kind != problem.kind or branch.parameters != tuple(problem.parameters):
            continue
        if branch.z.shape[1] != z.size:  # cycles of another period
            continue
        if getattr(branch.problem, "motion", None) != getattr(problem, "motion", None):
            continue
        for point, direction in variants:
            if lies_on(branch, point, direction, scale):
                return branch
    return None
