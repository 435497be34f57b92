"""A seed of a family of orbits on the mesh that the settings ask for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile, Transfer, make_scale, node_times, sizes_of


def on_mesh(seed: Seed, settings: Settings) -> Seed:
    """The seed on the mesh that the settings ask for: number of Gauss points, fixed number of intervals."""
    problem: OrbitProblem = seed.problem  # type: ignore[assignment]
    if problem.points == settings.points and settings.intervals is None:
        return seed
    profile = problem.profile(seed.z)
    h = profile.h
    if settings.intervals is not None and settings.intervals != len(h):
        h = np.diff(np.interp(np.linspace(0, 1, settings.intervals + 1), np.linspace(0, 1, len(h) + 1), profile.mesh))
    changed = replace(problem, points=settings.points, intervals=settings.intervals)

    transfer = Transfer.to_times(profile.m, profile.h, node_times(h, settings.points))

    def moved(z: Array) -> Array:
        old = problem.profile(z)
        return Profile(settings.points, transfer(old.u), old.period, h, old.parameter).vector()

    if seed.direction is None:
        return replace(seed, problem=changed, z=moved(seed.z))
    assert seed.scale is not None
    sizes = sizes_of(seed.scale, profile.h, profile.n, profile.m)
    scale = make_scale(h, settings.points, sizes, float(seed.scale[profile.u.size]), float(seed.scale[-1]))

    def direction(d: Array | None) -> Array | None:
        if d is None:
            return None
        raw = d * seed.scale  # type: ignore[operator]
        raw[profile.u.size + 1 : -1] = profile.h
        out = moved(raw)
        out[-1 - len(h) : -1] = 0.0
        return np.asarray(out / scale)

    d, k = direction(seed.direction), direction(seed.curvature)
    assert d is not None
    norm = float(np.linalg.norm(d))
    k = None if k is None else k / elementary.square(norm)
    return replace(seed, problem=changed, z=moved(seed.z), direction=d / norm, curvature=k, scale=scale)
