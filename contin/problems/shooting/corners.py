"""Corners of a family: orbits that just touch a switching surface, where the sequence of crossings changes.

On both sides the return map is smooth, with derivatives that differ; so the family has two tangents there, and may turn
(a nonsmooth fold, as where the amplitude of a metronome passes the end of its escapement's reach).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Jump, Outcome, Verified
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.shooting.grazing import grazing
from contin.problems.shooting.layout import moving
from contin.problems.shooting.linear import embedded, null_space
from contin.problems.shooting.phase import room
from contin.problems.shooting.signature import signature
from contin.problems.tolerances import STAYS_ONE

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

AHEAD = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3)  # (arclength) how far ahead another sequence of crossings is looked for
BEHIND = (1e-5, 1e-4, 1e-3)  # ... and how far behind the corner the family is taken up again
BESIDE = (1e-8, 1e-6, 1e-4)  # ... or behind, for a test that fails to be blamed on the corner
AT_BASE = 1e-2  # of half the longest stretch between crossings: the first node is at one
BACK = 1e-3  # (arclength) how far before it the search for a corner begins
STANDS = 1e-9  # part of the tangent in the parameter's direction that is rounding
JUMPS = "the number of unstable multipliers jumps where the orbit touches a switching surface; the family goes on"


def at_base(problem: ShotEquations, z: Array) -> bool:
    """True where it is the first node that has come to a surface: the family has no corner, the phase is moved."""
    return problem.autonomous and room(problem, z) < AT_BASE


def verify_corner(problem: ShotEquations, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
    """A fold at a corner between a and b, which are very close; None where they cross the same surfaces."""
    if not problem.system.n_switches:
        return None
    before, after = signature(problem, a.z), signature(problem, b.z)
    if before is None or after is None or before == after:
        return None
    if (_beyond_one(a) + _beyond_one(b)) % 2 and not (_in_continuum(a) or _in_continuum(b)):
        near, arm, other = (a, before, after) if len(before) < len(after) else (b, after, before)
        corner, width = grazing(problem, near, arm, other, frame) or _locate(problem, a, before, frame, b)
        return _fold(problem, corner, a, min(a.unstable, b.unstable), width, frame)
    return Jump(JUMPS) if a.unstable != b.unstable else NOTHING


def at_corner(problem: ShotEquations, z: Array, tangent: Array, scale: Array) -> bool:
    """True where the sequence of crossings changes just ahead or behind: multipliers measured here mean nothing."""
    here = signature(problem, z)
    raw = np.where(tangent == 0.0, 0.0, tangent * scale)
    return any(signature(problem, z + side * s * raw) != here for s in BESIDE for side in (1.0, -1.0))


def _in_continuum(sample: Sample) -> bool:
    """True where orbits beside this one exist at the same parameter: rounding has the sign of the parameter's share.

    So do the cycles of a centre, where equations are linear on a side of a surface.
    """
    near = np.sort(np.abs(sample.eigenvalues - 1.0))
    return len(near) > 1 and bool(near[1] < STAYS_ONE) and abs(float(sample.tangent[-1])) < STANDS


def _beyond_one(sample: Sample) -> int:
    """Real multipliers above 1. The family turns at a corner where the numbers on both sides have an odd sum.

    Feigin's condition: the sign of det(M - I) changes, so that the parameter's share of the tangent does (di Bernardo,
    Budd, Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, sec. 3.1.2).
    """
    values = sample.eigenvalues[1:] if abs(sample.eigenvalues[0] - 1.0) < 1e-6 else sample.eigenvalues
    return int(np.count_nonzero((np.abs(values.imag) <= 1e-9 * np.abs(values)) & (values.real > 1.0)))


def cross_corner(
    problem: ShotEquations, last: Sample, frame: Frame, settings: Settings
) -> tuple[Sample, Verified | None] | None:
    """Past a corner at which the family turns so sharply that no step along its tangent meets it again.

    The sequence of crossings changes along the tangent; the linearisation on the far side gives the other tangent, its
    sense such that the sequence stays changed.
    """
    if not problem.system.n_switches or at_base(problem, last.z):
        return None
    scale = frame.scale
    raw = np.where(last.tangent == 0.0, 0.0, last.tangent * scale)
    here = signature(problem, last.z)
    reach = next((s for s in AHEAD if signature(problem, last.z + s * raw) not in (here, None)), None)
    if here is None or reach is None:
        return None
    beyond_corner = last.z + 2.0 * reach * raw
    corner, width = _locate(problem, last, here, frame, None)
    found = null_space(problem, beyond_corner, scale)
    if found is None:
        return None
    tangent = embedded(found[2][-1], moving(len(last.z), problem.n), len(last.z))
    for length in BEHIND:
        for t in (tangent, -tangent):
            ahead = np.where(t == 0.0, 0.0, t * scale)
            base = Sample(corner, t, np.full(4, np.nan), 0, last.eigenvalues)
            beyond = problem.probe(base, length, corner + length * ahead, frame, settings)
            if beyond is None or signature(problem, beyond.z) == here:
                continue
            if np.linalg.norm((beyond.z - corner) / scale) > 10.0 * length:
                continue
            sense = np.sign(float(beyond.tangent @ t)) or 1.0
            beyond = Sample(beyond.z, sense * beyond.tangent, beyond.tests * [sense, sense, 1.0, 1.0], beyond.unstable,
                            beyond.eigenvalues)  # fmt: skip
            if beyond.tangent[-1] * last.tangent[-1] > 0.0 or _in_continuum(last) or _in_continuum(beyond):
                return beyond, None
            stable = min(last.unstable, beyond.unstable)
            there = signature(problem, beyond.z)
            if there is not None and len(there) < len(here):  # known more closely from the arm that does not cross
                corner, width = grazing(problem, beyond, there, here, frame) or (corner, width)
            return beyond, _fold(problem, corner, last, stable, width, frame)
    return None


def _locate(
    problem: ShotEquations, side: Sample, here: tuple[int, ...], frame: Frame, other: Sample | None
) -> tuple[Array, float]:
    """The last orbit with the crossings `here`, and how closely it is known (arclength).

    Bisection on the curve, from an orbit a little before `side`: at the corner itself Newton has no one Jacobian.
    """
    scale, settings = frame.scale, Settings()
    back = np.where(side.tangent == 0.0, 0.0, side.tangent * scale)
    base = problem.probe(side, -BACK, side.z - BACK * back, frame, settings)
    if base is None or signature(problem, base.z) != here:
        base = side
    t = base.tangent * (np.sign(float(base.tangent @ side.tangent)) or 1.0)
    base = Sample(base.z, t, base.tests, base.unstable, base.eigenvalues)
    low, high = 0.0, 2.0 * BACK
    if other is not None:
        high = max(high, 2.0 * float(np.linalg.norm((other.z - base.z) / scale)))
    at = base.z
    for _ in range(50):
        middle = 0.5 * (low + high)
        guess = at + np.where(t == 0.0, 0.0, t * scale) * (middle - low)
        found = problem.probe(base, middle, guess, frame, settings)
        if found is not None and signature(problem, found.z) == here:
            low, at = middle, found.z
        else:
            high = middle
        if high - low < 1e-12:
            break
    return at, high - low


def _fold(problem: ShotEquations, z: Array, side: Sample, unstable: int, width: float, frame: Frame) -> Verified:
    segments = problem.segments(z)
    # where solutions slide beyond the surface the orbit is extrapolated, and its trajectory may not come to its end
    residual = width if segments is None else float(np.linalg.norm(segments.scaled(frame.scale)[0]))
    error = (width + residual) * float(frame.scale[-1])
    return Verified("LPC", z, residual, error, side.eigenvalues, unstable, {"kind": "nonsmooth"})
