"""Where curves of connecting orbits start: at the end of a family whose period diverges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.loci.start import indices
from contin.problems.orbits.homoclinic.curve import ConnectionCurve
from contin.problems.orbits.homoclinic.interval import fits, fitted
from contin.problems.orbits.homoclinic.problem import ConnectionProblem
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.mesh import choose_mesh
from contin.problems.orbits.problem import OrbitProblem

CLOSE = 1e-5  # distance of the ends from the saddle, relative to the orbit's extent


def connections_of_family(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of homoclinic orbits (of every heteroclinic one) that a family of orbits ends at."""
    from contin.problems.orbits.ends import saddles_near

    first, second = indices(problem.system, parameters)
    names = problem.system.parameter_names
    profile = problem.profile(point.z)
    sizes = problem.state_sizes(profile)
    visited = saddles_near(problem, profile, sizes)
    if not visited:
        raise InputError(f"{point.branch}.{point.label}: the orbit does not come near a saddle")
    loops = _passages(profile, visited, sizes)
    orbits = problem if names[first] == problem.parameters[0] else problem.with_active(names[first], point.z)
    seeds = []
    for a, b, start, end in loops:
        piece = _piece(profile, start, end)
        value = float(orbits.base[first]) if orbits is not problem else profile.parameter
        ends = np.array([visited[a].u] if a == b else [visited[a].u, visited[b].u])
        stable = int(np.sum(visited[a].eigenvalues.real < 0.0))
        unstable = int(np.sum(visited[b].eigenvalues.real > 0.0))
        piece = replace(piece, parameter=value)
        parent = Parent(point.branch, point.label)
        q = float(orbits.base[second])
        seeds.append(solved_connection(orbits, second, piece, ends, stable, unstable, q, parent))
    if any(not np.allclose(seeds[0].z[-2:], s.z[-2:]) for s in seeds):
        return seeds
    return seeds if len(visited) > 1 else seeds[:1]  # loops of one saddle: images of each other, or one twice


def _passages(profile: Profile, visited: Sequence[Any], sizes: Array) -> list[tuple[int, int, float, float]]:
    """(saddle left, saddle reached, from, to) of the loops between visits, in scaled time (to may exceed 1)."""
    extent = float(np.max(np.ptp(profile.u, axis=0) / sizes))
    times = np.linspace(0.0, 1.0, 8 * len(profile.u) + 1)[:-1]
    times = np.unique(np.concatenate([profile.times[:-1], times]))
    u = profile.at(times)
    distances = np.array([np.max(np.abs(u - s.u) / sizes, axis=1) for s in visited]) / extent
    near, which = distances.min(axis=0), distances.argmin(axis=0)
    minima = [
        k for k in range(len(times))
        if near[k] <= near[k - 1] and near[k] < near[(k + 1) % len(times)] and near[k] < 0.1
    ]  # fmt: skip
    minima = _merged(minima, near)
    loops = []
    for k, begin in enumerate(minima):
        finish = minima[(k + 1) % len(minima)]
        span = np.arange(begin, finish if finish > begin else finish + len(times)) % len(times)
        a, b = int(which[begin]), int(which[finish])
        outside_a = np.flatnonzero(distances[a][span] > max(CLOSE, 2.0 * near[begin]))
        outside_b = np.flatnonzero(distances[b][span] > max(CLOSE, 2.0 * near[finish]))
        start, end = float(times[span[outside_a[0]]]), float(times[span[outside_b[-1]]])
        loops.append((a, b, start, end if end > start else end + 1.0))
    return loops


def _merged(minima: list[int], near: Array) -> list[int]:
    """One minimum for each visit: between two visits the orbit goes away."""
    kept: list[int] = []
    for k in minima:
        if kept and float(near[kept[-1] : k].max()) < 0.1:
            if near[k] < near[kept[-1]]:
                kept[-1] = k
        else:
            kept.append(k)
    if len(kept) > 1 and max(float(near[kept[-1] :].max()), float(near[: kept[0] + 1].max())) < 0.1:
        kept.pop(-1 if near[kept[0]] <= near[kept[-1]] else 0)
    return kept


def _piece(profile: Profile, start: float, end: float) -> Profile:
    """The stretch from `start` to `end` of a closed orbit on a mesh of its own."""
    mesh = np.concatenate([profile.mesh[:-1], 1.0 + profile.mesh])
    inside = mesh[(mesh > start + 1e-9) & (mesh < end - 1e-9)]
    ends = np.concatenate([[start], inside, [end]])
    h = np.diff(ends) / (end - start)
    empty = Profile(profile.m, np.empty((len(h) * profile.m + 1, profile.n)), 1.0, h, profile.parameter)
    times = start + (end - start) * empty.times
    turns = np.floor(np.minimum(times, 2.0 - 1e-15))
    winding = profile.u[-1] - profile.u[0]
    u = profile.at(times - turns) + turns[:, None] * winding
    return Profile(profile.m, u, (end - start) * profile.period, h, profile.parameter)


def solved_connection(
    orbits: OrbitProblem, second: int, piece: Profile, ends: Array, stable: int, unstable: int, q: float,
    parent: Parent | None,
) -> Seed:  # fmt: skip
    """The connection solved for at fixed q, on an interval and a mesh that fit it; `parent` : where it comes from."""
    source = "connection" if parent is None else f"{parent.branch}.{parent.label}"
    curve = ConnectionCurve(orbits, second, len(ends), stable, unstable)
    problem = ConnectionProblem(curve)
    if stable + unstable != curve.n:
        raise InputError(
            f"{source}: {stable} stable directions of the first and {unstable} unstable ones of "
            f"the second saddle in {curve.n} dimensions: such a connection does not form curves in two parameters"
        )
    z = curve.join(piece, ends, q)
    sizes = orbits.state_sizes(piece)
    for attempt in range(3):
        profile = curve.profile(z)
        scale = problem.scale_for(profile.h, sizes, max(1e-3, abs(float(z[-1]))), max(1e-3, abs(q)))
        curve.settle(z, sizes)
        solved = problem.at_unknown(-2, z, q, scale)
        if solved is None:
            raise InputError(f"{source}: Newton for the connecting orbit did not converge")
        z = solved
        if attempt < 2 and not fits(curve, z, sizes):
            z = fitted(curve, z, sizes)
        elif attempt == 1:
            break
        if attempt < 2:
            chosen = choose_mesh(curve.profile(z), sizes, orbits.tolerance, orbits.intervals)
            z = curve.join(curve.profile(z).on_mesh(chosen.h), curve.equilibria(z), q)
    return Seed(problem, z, parent=parent)
