"""Corners: points where a piecewise equation changes formula and the branch turns or changes stability."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Jump, Outcome, Verified
from contin.continuation.sample import Chunk, Frame, Sample, Stop, opposite
from contin.continuation.settings import Settings
from contin.problems.equilibria.on_surface import STEP, OnSurface, behind_by_height, far, on_surface

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

AHEAD = 1e-2  # how far ahead of the last point (arclength) a surface is looked for
PASSED = -1e-4  # ... and how far behind it: Newton's last step may have crossed it unseen
BESIDE = 1e-8  # a corner this close to two samples lies between them: Newton moves them that far
BEHIND = 1e-5  # how far behind it the branch is taken up again
APART = 1e-6  # two surfaces crossed in one step are told apart where they are this far (arclength) from each other
NEAREST = 1e-4  # steps that end past a surface by rounding are repeated with shorter ones down to this length
ON_ITS_ARM = 1e-7  # (scaled) distance of a row from the curve of its own side
JUMPS = "the number of unstable eigenvalues jumps at a corner of the equations; the branch goes on"
VERTICAL = 1e-12  # a smaller part of the parameter in a (scaled) tangent is rounding, and so is its sign


def verify_corner(problem: AlgebraicEquations, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
    """A fold at a corner between a and b: f = 0 on the switching surface, with the parameter turning there.

    a and b are so close that only a switching function can separate them. None where no switching function changes sign
    (the point is smooth); a jump where the stability changes without the parameter turning.
    """
    system = problem.system
    if not system.n_switches:
        return None
    n = problem.n
    h_a = system.switches(a.z[:n], problem.full_parameters(a.z))
    h_b = system.switches(b.z[:n], problem.full_parameters(b.z))
    gap = 4.0 * float(np.linalg.norm((b.z - a.z) / frame.scale)) + BESIDE
    crossed = (h_a * h_b <= 0.0) & (h_a != h_b)
    for k in np.argsort(~crossed, kind="stable"):  # those that change sign first
        solved = on_surface(problem, int(k), 0.5 * (a.z + b.z), a, frame)
        if solved is None:
            continue
        z = solved.z
        if not crossed[k] and np.linalg.norm((z - a.z) / frame.scale) > gap:
            continue
        if opposite(a.tests[0], b.tests[0]) or _turns_at(problem, z, a, b, frame.scale):
            stable = min(a.unstable, b.unstable)
            return _fold(solved, a, stable, int(k))
        if a.unstable != b.unstable:
            return Jump(JUMPS, z)
        return NOTHING
    return None


def _fold(solved: OnSurface, beside: Sample, stable: int, k: int) -> Verified:
    """The fold at a corner on surface k."""
    return Verified(
        "LP", solved.z, solved.residual, solved.error, beside.eigenvalues, stable, {"kind": "nonsmooth"}, {"switch": k},
        remark=solved.remark,
    )  # fmt: skip


def _turns_at(problem: AlgebraicEquations, z: Array, a: Sample, b: Sample, scale: Array) -> bool:
    """True where the parameter turns at a corner z that a or b is itself, as a start may be.

    The arms' own tangents are those of the formulas on both sides of it, oriented from a to b.
    """
    chord = (b.z - a.z) / scale
    length = float(np.linalg.norm(chord))
    if a.tests[0] * b.tests[0] != 0.0 or not length > 0.0:
        return False
    slopes = []
    for sense in (-1.0, 1.0):
        _, matrix = problem.linearise(z + sense * STEP * scale * chord / length)
        tangent = np.linalg.svd(matrix * scale / scale[:-1, None])[2][-1]
        slopes.append(float(tangent[-1] * np.sign(tangent @ chord)))
    return slopes[0] * slopes[1] < 0.0 and min(abs(slope) for slope in slopes) > VERTICAL


def one_corner_a_step(problem: AlgebraicEquations, chunk: Chunk, scale: Array) -> Chunk:
    """The chunk up to the first step that crosses two switching surfaces, with a shorter step to go on with.

    Also before a row that is past a surface by rounding alone.

    Two folds at corners undo each other: neither the direction nor the stability shows them at the ends of such a step.
    """
    system = problem.system
    if not system.n_switches or len(chunk) < 2:
        return chunk
    values = np.array([system.switches(z[: problem.n], problem.full_parameters(z)) for z in chunk.z])
    before, after = values[:-1], values[1:]
    crossed = before * after < 0.0
    for k in np.flatnonzero(np.any(crossed, axis=1)):
        length = float(chunk.lengths[k + 1])
        ahead, behind = before[k][crossed[k]], after[k][crossed[k]]
        places = length * ahead / (ahead - behind)
        if np.ptp(places) > APART:
            return chunk.cut(int(k) + 1, Stop.LIMIT, length / 4.0)
        if _off_its_arm(problem, chunk.z[k + 1], scale):
            if length > NEAREST:
                return chunk.cut(int(k) + 1, Stop.LIMIT, max(length / 4.0, 0.5 * NEAREST))
            return chunk.cut(int(k) + 1, Stop.CORRECTOR, length)
    return chunk


def _off_its_arm(problem: AlgebraicEquations, z: Array, scale: Array) -> bool:
    """True for a row that solves the equations of the other side of a surface, which it has passed by rounding.

    Where those leave the surface like a root, their slope is so large that such a row is on the curve to its tolerance.
    """
    f, matrix = problem.linearise(z)
    distance = np.linalg.lstsq(matrix * scale / scale[:-1, None], f / scale[:-1])[0]
    return not float(np.linalg.norm(distance)) < ON_ITS_ARM


def cross_corner(
    problem: AlgebraicEquations, last: Sample, frame: Frame, settings: Settings
) -> tuple[Sample, Verified | Jump | None] | None:
    """Past a corner that turns the branch so sharply that no step along its tangent meets it again.

    The nearest switching surface ahead of `last` is solved for together with F = 0; behind it the Jacobian of the other
    formula gives the new tangent, oriented so that the surface is crossed and not touched. Returns a point just beyond
    with the nonsmooth fold, if the parameter turns, or the jump of the number of unstable eigenvalues; None where no
    surface is close ahead.
    """
    system = problem.system
    if not system.n_switches:
        return None
    n, scale = problem.n, frame.scale

    def surfaces(z: Array) -> Array:
        return np.asarray(system.switches(z[:n], problem.full_parameters(z)))

    here = surfaces(last.z)
    slope = (surfaces(last.z + STEP * scale * last.tangent) - here) / STEP
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(slope != 0.0, -here / slope, np.inf)
    for k in np.argsort(np.abs(distance)):
        if not PASSED < distance[k] < AHEAD:
            continue
        solved = on_surface(problem, int(k), last.z, last, frame)
        if solved is None:
            continue
        z = solved.z
        across = _room(surfaces, z, last.tangent * scale, int(k))
        _, matrix = problem.linearise(z + across * scale * last.tangent)
        tangent = np.linalg.svd(matrix * scale / scale[:-1, None])[2][-1]
        rate = (surfaces(z + STEP * scale * tangent)[k] - surfaces(z - STEP * scale * tangent)[k]) / (2.0 * STEP)
        if abs(rate) < 1e-6 * abs(slope[k]):
            continue
        if rate * slope[k] < 0.0:
            tangent = -tangent
        behind = _room(surfaces, z, tangent * scale, int(k))
        base = Sample(z, tangent, np.full(4, np.nan), 0, last.eigenvalues)
        beyond = problem.probe(base, behind, z + behind * scale * tangent, frame, settings)
        if beyond is None or surfaces(beyond.z)[k] * slope[k] <= 0.0 or far(beyond.z, z, scale, behind):
            beyond = behind_by_height(problem, int(k), z, float(slope[k]), behind, frame, settings)
        if beyond is None:
            continue
        turns = beyond.tangent[-1] * last.tangent[-1] < 0.0 and abs(float(last.tangent[-1])) > VERTICAL
        stable = min(last.unstable, beyond.unstable)
        if turns:
            return beyond, _fold(solved, last, stable, int(k))
        return beyond, None if last.unstable == beyond.unstable else Jump(JUMPS, z)
    return None


def _room(surfaces: Callable[[Array], Array], z: Array, direction: Array, k: int) -> float:
    """How far behind surface k to go along `direction`: not as far as the next surface."""
    here = surfaces(z)
    slope = (surfaces(z + STEP * direction) - here) / STEP
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = -here / slope
    others = np.arange(len(here)) != k
    ahead = distance[others & np.isfinite(distance) & (distance > APART)]
    return min(BEHIND, 0.5 * float(ahead.min(initial=np.inf)))
