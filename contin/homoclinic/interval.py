"""The interval of time of a connecting orbit: long enough for the projections, no longer than rounding allows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.homoclinic.tail import Tail, tail_of
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.mesh.layout import Profile, node_times

if TYPE_CHECKING:
    from contin.homoclinic.equations import ConnectionCurve


@dataclass(frozen=True)
class Reach:
    """Distances of the ends from the saddles, relative to the orbit's extent."""

    wanted: float
    farthest: float  # beyond which, or nearer than which, the interval is changed
    nearest: float


HYPERBOLIC: Final = Reach(1e-5, 3e-4, 1e-8)
SADDLE_NODE: Final = Reach(3e-4, 3e-3, 1e-7)  # approached like 1 / t; the strong directions damp the projections' error
ADDED = 6  # intervals of an arc that is added
LEAST = 0.3  # part of its neighbour below which a cut interval is none of its own


def farther(curve: ConnectionCurve) -> Reach:
    """For an interval on which the projections' error is a hundred times smaller."""
    usual = reach_of(curve)
    return Reach(0.1 * usual.wanted, 0.3 * usual.wanted, 0.0)


def reach_of(curve: ConnectionCurve) -> Reach:
    if curve.truncation is not None:
        return Reach(curve.truncation, 3.0 * curve.truncation, 1e-2 * curve.truncation)
    return SADDLE_NODE if curve.node else HYPERBOLIC


def distances(curve: ConnectionCurve, z: Array, sizes: Array) -> tuple[float, float]:
    """Of both ends from their saddles, relative to the orbit's extent."""
    extent = extent_of(curve.profile(z), sizes)
    first, last = (float(np.max(np.abs(offset))) for offset in curve.offsets(z, sizes))
    return first / extent, (first if curve.reversor is not None else last) / extent  # (of half an orbit, one end)


def fits(curve: ConnectionCurve, z: Array, sizes: Array) -> bool:
    reach = reach_of(curve)
    return all(reach.nearest <= d <= reach.farthest for d in distances(curve, z, sizes))


def fitted(curve: ConnectionCurve, z: Array, sizes: Array, reach: Reach | None = None) -> Array:
    """z on an interval whose ends are as near to the saddles as is wanted: cut, or continued by the flow there."""
    profile, ends, reach = curve.profile(z), curve.termini(z), reach or reach_of(curve)
    first, last = distances(curve, z, sizes)
    if first > reach.farthest:
        tail = tail_of(curve, z, sizes, ends[0], profile.u[0] - ends[0], False, reach.wanted / first)
        profile = _extended(profile, ends[0], tail, False)
    if last > reach.farthest and curve.reversor is None:
        tail = tail_of(curve, z, sizes, ends[-1], profile.u[-1] - ends[-1], True, reach.wanted / last)
        profile = _extended(profile, ends[-1], tail, True)
    if first < reach.nearest or last < reach.nearest:
        profile = _cut(profile, ends[: 1 if curve.reversor is not None else 2], sizes, reach.wanted)
    return np.asarray(curve.join(profile, curve.equilibria(z), float(z[-2])))


def _extended(profile: Profile, saddle: Array, tail: Tail, at_end: bool) -> Profile:
    """The orbit with a tail at one end, on intervals over which the tail shrinks by equal factors."""
    edges = tail.times(np.linspace(0.0, 1.0, ADDED + 1))
    steps = np.diff(edges)
    if not (np.all(np.isfinite(steps)) and np.all(steps > 0.0)):
        return profile
    total = profile.period + float(edges[-1])
    moments = node_times(steps / edges[-1], profile.m)[1:] * edges[-1]
    arc = saddle + tail.offsets(moments)
    if not np.all(np.isfinite(arc)):
        return profile
    own, new = profile.h * (profile.period / total), steps / total
    if at_end:
        return replace(profile, u=np.vstack([profile.u, arc]), period=total, h=np.concatenate([own, new]))
    return replace(profile, u=np.vstack([arc[::-1], profile.u]), period=total, h=np.concatenate([new[::-1], own]))


def _cut(profile: Profile, ends: Sequence[Array], sizes: Array, wanted: float) -> Profile:
    """Without what is nearer to the saddle(s) than a tenth of the distance that is wanted; of half an orbit one."""
    times = np.unique(np.concatenate([profile.times, np.linspace(0.0, 1.0, 8 * len(profile.u))]))
    u = profile.at(times)
    extent = extent_of(profile, sizes)
    away = np.max(np.abs(u - ends[0]) / sizes, axis=1) > 0.1 * wanted * extent
    if len(ends) == 1:
        return arc_of(profile, float(times[np.argmax(away)]), 1.0)
    arrived = np.max(np.abs(u - ends[-1]) / sizes, axis=1) > 0.1 * wanted * extent
    return arc_of(profile, float(times[np.argmax(away)]), float(times[len(times) - 1 - np.argmax(arrived[::-1])]))


def arc_of(profile: Profile, start: float, end: float) -> Profile:
    """The stretch between two scaled times, on the mesh that it had.

    A cut interval of which little is left goes to its neighbour: on a very short one the top derivative, from which the
    error of the mesh is estimated, is rounding divided by h^m.
    """
    inside = profile.mesh[(profile.mesh > start) & (profile.mesh < end)]
    if len(inside) > 2 and inside[0] - start < LEAST * (inside[1] - inside[0]):
        inside = inside[1:]
    if len(inside) > 2 and end - inside[-1] < LEAST * (inside[-1] - inside[-2]):
        inside = inside[:-1]
    edges = np.concatenate([[start], inside, [end]])
    h = np.diff(edges) / (end - start)
    empty = Profile(profile.m, np.empty((len(h) * profile.m + 1, profile.n)), 1.0, h, profile.parameter)
    return replace(empty, u=profile.at(start + (end - start) * empty.times), period=(end - start) * profile.period)
