"""Where curves of connecting orbits start: at the end of a family whose period diverges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.interval import arc_of
from contin.homoclinic.solved_connection import solved_connection
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.ends.distances import extent_of, turns
from contin.problems.orbits.ends.invariant_circle import bottlenecks
from contin.problems.orbits.ends.saddles import saddles_and_elsewhere
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import indices
from contin.transitions.registry import born

WIDTHS = 6.0  # of a bottleneck: how far from a saddle-node an orbit is cut, inside ...
CLOSEST, FARTHEST = 1e-3, 0.03  # ... of its extent
CLOSE = 1e-5  # distance of the ends from the saddle, relative to the orbit's extent


@born(OrbitProblem, "HOM", "the curves of connecting orbits", parameters=2)
def connections_of_family(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of homoclinic orbits (of every heteroclinic one) that a family of orbits ends at."""
    first, second = indices(problem.system, parameters)
    profile = problem.profile(point.z)
    sizes = problem.state_sizes(profile)
    if point.normal_form.get("kind") == "saddle-node":
        return [loop_of_saddle_node(problem, point, parameters)]
    visited, _ = saddles_and_elsewhere(problem, profile, sizes)
    if not visited:
        raise InputError(f"{point.branch}.{point.label}: the orbit does not come near a saddle")
    loops = _passages(problem, profile, visited, sizes)
    if not loops:
        raise InputError(f"{point.branch}.{point.label}: the orbit does not leave the saddle that it comes near")
    orbits, orbit = problem.freed(problem.system.parameter_names[first], point.z)
    seeds = []
    for a, b, start, end in loops:
        arc = _arc(profile, start, end)
        arc = replace(arc, u=arc.u - turns(problem, arc.u[0] - visited[a].u))
        winding = turns(problem, arc.u[-1] - visited[b].u)
        ends = np.array([visited[a].u] if a == b else [visited[a].u, visited[b].u + winding])
        stable = int(np.sum(visited[a].eigenvalues.real < 0.0))
        unstable = int(np.sum(visited[b].eigenvalues.real > 0.0))
        arc = replace(arc, parameter=float(orbit[-1]))
        parent = Parent.of(point)
        q = float(orbits.base[second])
        turned = winding if a == b and winding.any() else None
        curve = ConnectionCurve(orbits, second, len(ends), stable, unstable, winding=turned)
        seeds.append(solved_connection(curve, arc, ends, q, parent))
    if any(not np.allclose(seeds[0].z[-2:], s.z[-2:]) for s in seeds):
        return seeds
    return seeds if len(visited) > 1 else seeds[:1]  # loops of one saddle: images of each other, or one twice


def loop_of_saddle_node(problem: OrbitProblem, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve of homoclinic orbits to a saddle-node that a family of orbits ends at.

    Inside the bottleneck the orbit is not that of the fold yet: it is cut some widths of that away from it.
    """
    first, second = indices(problem.system, parameters)
    profile = problem.profile(point.z)
    sizes = problem.state_sizes(profile)
    folds = bottlenecks(problem, profile, sizes, float(point.scale[-1]) if point.scale.size else 1.0)
    if len(folds) != 1:
        raise InputError(f"{point.branch}.{point.label}: the orbit passes {len(folds)} folds of equilibria, not one")
    at = folds[0].z
    beside = min(max(WIDTHS * folds[0].width(profile.parameter) / extent_of(profile, sizes), CLOSEST), FARTHEST)
    values = np.linalg.eigvals(problem.system.jacobian(at[:-1], problem.full_parameters(at))[1][:, : problem.n])
    others = np.delete(values, int(np.argmin(np.abs(values)))).real
    times = np.linspace(0.0, 1.0, 16 * len(profile.u) + 1)[:-1]
    times = np.unique(np.concatenate([profile.times[:-1], times]))
    gaps = profile.at(times) - at[:-1]
    away = np.max(np.abs(gaps - turns(problem, gaps)) / sizes, axis=1) / extent_of(profile, sizes)
    slowest = int(np.argmin(away))
    outside = np.flatnonzero(np.roll(away, -slowest) > beside)
    start, end = np.roll(times, -slowest)[outside[[0, -1]]]
    arc = _arc(profile, float(start), float(end if end > start else end + 1.0))
    arc = replace(arc, u=arc.u - turns(problem, arc.u[0] - at[:-1]))
    winding = turns(problem, arc.u[-1] - at[:-1])
    p = problem.full_parameters(at)
    orbits = replace(problem, base=p, active=first)
    stable, unstable = int(np.sum(others < 0.0)), int(np.sum(others > 0.0))
    turned = winding if winding.any() else None
    curve = ConnectionCurve(orbits, second, 1, stable, unstable, node=True, winding=turned)
    arc = replace(arc, parameter=float(p[first]))
    return solved_connection(curve, arc, at[None, :-1], float(p[second]), Parent.of(point))


def _passages(
    problem: OrbitProblem, profile: Profile, visited: Sequence[Any], sizes: Array
) -> list[tuple[int, int, float, float]]:
    """(saddle left, saddle reached, from, to) of the loops between visits, in scaled time (to may exceed 1)."""
    extent = extent_of(profile, sizes)
    times = np.linspace(0.0, 1.0, 8 * len(profile.u) + 1)[:-1]
    times = np.unique(np.concatenate([profile.times[:-1], times]))
    u = profile.at(times)
    gaps = [u - s.u - turns(problem, u - s.u) for s in visited]
    distances = np.array([np.max(np.abs(gap) / sizes, axis=1) for gap in gaps]) / extent
    near, which = distances.min(axis=0), distances.argmin(axis=0)
    minima = [
        k for k in range(len(times))
        if near[k] <= near[k - 1] and near[k] < near[(k + 1) % len(times)] and near[k] < 0.1
    ]  # fmt: skip
    minima = _slowest(_merged(minima, near), near, which, visited)
    loops = []
    for k, begin in enumerate(minima):
        finish = minima[(k + 1) % len(minima)]
        span = np.arange(begin, finish if finish > begin else finish + len(times)) % len(times)
        a, b = int(which[begin]), int(which[finish])
        outside_a = np.flatnonzero(distances[a][span] > max(CLOSE, 2.0 * near[begin]))
        outside_b = np.flatnonzero(distances[b][span] > max(CLOSE, 2.0 * near[finish]))
        if not (len(outside_a) and len(outside_b)):  # two visits of one saddle, with no loop between them
            continue
        start, end = float(times[span[outside_a[0]]]), float(times[span[outside_b[-1]]])
        loops.append((a, b, start, end if end > start else end + 1.0))
    return loops


def _slowest(minima: list[int], near: Array, which: Array, visited: Sequence[Any]) -> list[int]:
    """As many minima of each saddle as it has visits, the nearest ones: on its way out an orbit that turns about a
    saddle-focus comes near it again."""
    kept: list[int] = []
    for saddle, about in enumerate(visited):
        own = sorted((k for k in minima if which[k] == saddle), key=lambda k: float(near[k]))
        kept += own[: about.visits]
    return sorted(kept)


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


def _arc(profile: Profile, start: float, end: float) -> Profile:
    """The stretch from `start` to `end` (which may exceed 1) of a closed orbit on a mesh of its own."""
    winding = profile.u[-1] - profile.u[0]
    twice = replace(
        profile, u=np.vstack([profile.u, profile.u[1:] + winding]), period=2.0 * profile.period,
        h=np.concatenate([profile.h, profile.h]) / 2.0,
    )  # fmt: skip
    return arc_of(twice, start / 2.0, end / 2.0)
