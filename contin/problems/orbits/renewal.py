"""After every chunk of a family of orbits: does it end here, and do metric and mesh still fit?"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Frame, Renewal, Sample
from contin.continuation.settings import Settings
from contin.problems.orbits.layout import Profile, make_scale
from contin.problems.orbits.mesh import choose_mesh, estimate

NEARLY = 0.7  # part of the tolerance at which the mesh is renewed
WORTHWHILE = 0.6  # part of the error that a new mesh of as many intervals leaves at most
TOO_FINE = 0.55  # ... and part of the present number of intervals below which it is made coarser


def renew(
    problem: Any, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
) -> Renewal:
    """Metric and mesh for the next chunk, or the end of the branch."""
    from contin.problems.orbits.ends import ending

    found = ending(problem, origin, before, frame)
    if found is not None:
        return Renewal(frame.scale, origin, before, loop, found.end, found.last, found.point)
    profile = problem.profile(origin.z)
    m = problem.points
    sizes = problem.sizes(origin.z, frame.scale)
    grown = np.maximum(sizes, _state_growth(problem, profile, sizes))
    position = profile.u.size
    period = float(frame.scale[position])
    if profile.period > period:
        period = 2.0 * profile.period
    h = profile.h
    error, _ = estimate(profile, grown)
    chosen = choose_mesh(profile, grown, problem.tolerance, problem.intervals)
    unfit = error > NEARLY * problem.tolerance or len(chosen.h) < TOO_FINE * len(h)
    if unfit and (chosen.error < WORTHWHILE * error or len(chosen.h) != len(h)):
        h = chosen.h
    if h is profile.h and np.array_equal(grown, sizes) and period == frame.scale[position]:
        return Renewal(frame.scale, origin, before, loop)
    scale = make_scale(h, m, grown, period, float(frame.scale[-1]))
    moved = _moved(problem, origin, frame.scale, scale, h)
    corrected = problem.corrected(moved, Frame(scale), settings.newton_tolerance)
    if corrected is not None and float(np.linalg.norm((corrected - moved.z) / scale)) < 0.05:
        moved = replace(moved, z=corrected)
    return Renewal(
        scale,
        moved,
        None if before is None else _moved(problem, before, frame.scale, scale, h),
        None if loop is None else _moved(problem, loop, _metric_of(problem, loop, frame.scale), scale, h),
    )


def _state_growth(problem: Any, profile: Profile, sizes: Array) -> Array:
    largest = np.abs(profile.u).max(axis=0)
    periods = problem.system.model.periods(problem.constants())
    return np.where((periods == 0.0) & (largest > 1.5 * sizes), largest, sizes)


def _metric_of(problem: Any, sample: Sample, scale: Array) -> Array:
    """The present metric on a sample's own mesh."""
    if sample.z.size == scale.size:
        return scale
    profile = problem.profile(sample.z)
    return make_scale(profile.h, problem.points, np.ones(problem.n), 1.0, 1.0)


def _moved(problem: Any, sample: Sample, old_scale: Array, scale: Array, h: Array) -> Sample:
    """A sample on another mesh and in another metric."""
    profile = problem.profile(sample.z)
    raw = sample.tangent * old_scale
    raw[profile.u.size + 1 : -1] = profile.h
    direction = problem.profile(raw).on_mesh(h).vector()
    direction[-1 - len(h) : -1] = 0.0
    t = direction / scale
    return replace(sample, z=profile.on_mesh(h).vector(), tangent=t / np.linalg.norm(t))
