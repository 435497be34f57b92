"""The march along a curve of special orbits: one kernel call a step, step control in Python."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.march import GROWTH
from contin.continuation.problem import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.continuation.vectors import norm
from contin.problems.orbits.loci.criticality import cut_at_change
from contin.problems.orbits.loci.curve import Corrected

WANTED = 2e-3  # first correction (scaled) that the step control aims at
CAUTION = 5.0  # how much worse Newton's convergence may be at the next points than at the last one
AGAIN = 8  # points for which it is believed
SMALL = 2e-3  # relative amplitude down to which orbits that shrink are followed


def march(
    problem: Any, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
    settings: Settings,
) -> Chunk:  # fmt: skip
    """As `contin.continuation.march.march`; the chunk ends with RESCALE where the orbits shrink to a point."""
    curve, scale = problem.curve, frame.scale
    cos_max, target_angle = np.cos(np.radians(settings.max_angle)), np.radians(settings.max_angle) / 2.5
    rows, lengths, evaluations = [problem.measured(origin, frame)], [0.0], 0
    old, h, h_previous = before, step, length if before is not None else 0.0
    walls, curvature, trusted = problem.walls, np.inf, 0

    def chunk(stop: Stop, next_step: float) -> Chunk:
        if cut_at_change(curve, rows, scale):
            del lengths[len(rows) :]
            stop, next_step = Stop.EVENT, lengths[-1]
        return Chunk(
            np.array([r.z for r in rows]), np.array([r.tangent for r in rows]), np.array([r.tests for r in rows]),
            np.array([r.unstable for r in rows]), np.array([r.eigenvalues for r in rows]), np.array(lengths), stop,
            next_step, 0.0, 0, evaluations,
        )  # fmt: skip

    while len(rows) <= limit:
        last = rows[-1]
        while True:
            guess = last.z + scale * _predicted(last, old, h, h_previous, scale)
            known = curvature if trusted < AGAIN else np.inf
            found = curve.correct(last.z, last.tangent, h, guess, scale, settings.newton_tolerance, False, known)
            evaluations += 1
            reason = found if isinstance(found, str) else _refused(problem, last, found, h, cos_max, scale, settings)
            if reason is None:
                break
            if h <= settings.min_step or (reason == "beyond a point" and h < SMALL):
                if reason == "beyond a point":
                    return chunk(Stop.RESCALE, h)
                return chunk(Stop.NOT_FINITE if reason == "not finite" else Stop.CORRECTOR, h)
            h = max(0.5 * h, settings.min_step)
        assert isinstance(found, Corrected)
        evaluations += found.iterations
        trusted = trusted + 1 if found.iterations == 1 else 0
        curvature = found.curvature if found.iterations == 1 else CAUTION * max(found.curvature, 1.0)
        sample = problem.sample(found)
        curve.follow(found, scale)
        rows.append(sample)
        lengths.append(h)
        angle = float(np.arccos(min(float(last.tangent @ sample.tangent), 1.0)))
        factor = min(GROWTH, target_angle / angle if angle > 0.0 else GROWTH)
        if found.first_correction > 0.0:
            factor = min(factor, float((WANTED / found.first_correction) ** (1 / 3)))
        h_used, h = h, min(max(h * max(factor, 0.3), settings.min_step), settings.max_step)
        if any(not lowest <= sample.z[index] <= highest for index, lowest, highest in walls):
            return chunk(Stop.BOUND, h)
        if sample.unstable != last.unstable or bool(np.any(sample.tests[2:] * last.tests[2:] < 0.0)):
            return chunk(Stop.EVENT, h)
        old, h_previous = last, h_used
    return chunk(Stop.LIMIT, h)


def _predicted(last: Sample, old: Sample | None, h: float, h_previous: float, scale: Array) -> Array:
    """Scaled step on the cubic through the last two points with their tangents, onto the plane at distance h."""
    ahead = h * last.tangent
    if old is None or h_previous == 0.0:
        return ahead
    chord = (last.z - old.z) / scale
    reach = norm(chord)
    t = h / reach
    bend = reach * (2.0 * last.tangent + old.tangent) - 3.0 * chord
    twist = reach * (last.tangent + old.tangent) - 2.0 * chord
    ahead = ahead + t * t * (bend + t * twist)
    return np.asarray(ahead + (h - float(ahead @ last.tangent)) * last.tangent)


def _refused(
    problem: Any, last: Sample, found: Corrected, h: float, cos_max: float, scale: Array, settings: Settings
) -> str | None:
    """Why a corrected point is not taken."""
    moved = norm((found.z - last.z) / scale)
    if moved > 2.0 * h + 10.0 * settings.newton_tolerance:
        return "not the curve that the step set out on"
    if problem.turned_over(last.z, found.z):
        return "beyond a point"
    if not float(last.tangent @ found.tangent) >= cos_max:
        return "too sharp a turn"
    return None
