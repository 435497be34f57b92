"""After every chunk of a family of orbits: does it end here, and do metric and mesh still fit?"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.problems.orbits.ends.ends import ending
from contin.problems.orbits.mesh.adaption import WORTHWHILE, choose_mesh, estimate
from contin.problems.orbits.mesh.layout import Profile, make_scale
from contin.problems.orbits.mesh.move import Move

if TYPE_CHECKING:
    from contin.problems.orbits.mesh.adaptive_problem import Meshed
    from contin.problems.orbits.orbit_equations import OrbitEquations

NEARLY = 0.7  # part of the tolerance at which the mesh is renewed
TOO_FINE = 0.55  # part of the present number of intervals below which the mesh is made coarser


def renew(problem: OrbitEquations, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame) -> Renewal:
    """Metric and mesh for the next chunk, or the end of the branch."""
    found = ending(problem, origin, before, frame)
    if found is not None:
        return Renewal(frame.scale, origin, before, loop, found.end, found.last, found.point)
    profile = problem.profile(origin.z)
    fit = refitted(problem, profile, problem.sizes(origin.z, frame.scale), float(frame.scale[profile.u.size]))
    if fit is None:
        return Renewal(frame.scale, origin, before, loop)
    scale = make_scale(fit.h, profile.m, fit.sizes, fit.period, float(frame.scale[-1]))
    move = Move(problem, frame.scale, scale, fit.h)
    first, earlier, start = move.each(origin, before, loop)
    assert first is not None
    return Renewal(scale, first, earlier, start)


@dataclass(frozen=True, eq=False)
class Fit:
    """A mesh, and the scales of states and period."""

    h: Array
    sizes: Array
    period: float


def refitted(problem: Meshed, profile: Profile, sizes: Array, period: float, beside: Array | None = None) -> Fit | None:
    """What fits an orbit better than its mesh, these sizes and this scale of the period; None where they still do.

    beside (nodes, k) : functions that are to be as accurate, such as null vectors; of each its largest value is 1.
    """
    grown = np.maximum(sizes, state_growth(problem, profile, sizes))
    longer = 2.0 * profile.period if profile.period > period else period
    h = profile.h
    whole, accurate = profile, grown
    if beside is not None:
        whole = replace(profile, u=np.hstack([profile.u, beside]))
        accurate = np.append(grown, np.ones(beside.shape[1]))
    estimated = estimate(whole, accurate, problem.closed, profile.n)
    error, fixed = estimated[0], problem.intervals
    if error > NEARLY * problem.tolerance or fixed != len(h):
        chosen = choose_mesh(whole, accurate, problem.tolerance, fixed, estimated, problem.closed)
        unfit = error > NEARLY * problem.tolerance or len(chosen.h) < TOO_FINE * len(h)
        if unfit and (chosen.error < WORTHWHILE * error or len(chosen.h) != len(h)):
            h = chosen.h
    h = problem.laid(h, profile)
    same = h is profile.h and np.array_equal(grown, sizes) and longer == period
    return None if same else Fit(h, grown, longer)


def state_growth(problem: Meshed, profile: Profile, sizes: Array) -> Array:
    """The states' sizes, where an orbit has outgrown them its own; an angle's does not change."""
    largest = np.abs(profile.u).max(axis=0)
    return np.where((problem.state_periods == 0.0) & (largest > 1.5 * sizes), largest, sizes)
