"""The interval of time of a connecting orbit: long enough for the projections, no longer than rounding allows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.problems.orbits.layout import Profile

WANTED = 1e-5  # distance of the ends from the saddles, relative to the orbit's extent
FARTHEST, NEAREST = 3e-4, 1e-8  # ... beyond which the interval is changed
ADDED = 4  # intervals of a piece that is added
LONGEST = 30.0  # time that is added at once, in units of the slowest rate


def distances(curve: Any, z: Array, sizes: Array) -> tuple[float, float]:
    """Of both ends from their saddles, relative to the orbit's extent."""
    profile, ends = curve.profile(z), curve.equilibria(z)
    extent = float(np.max(np.ptp(profile.u, axis=0) / sizes))
    first = float(np.max(np.abs(profile.u[0] - ends[0]) / sizes))
    last = float(np.max(np.abs(profile.u[-1] - ends[-1]) / sizes))
    return first / extent, last / extent


def fits(curve: Any, z: Array, sizes: Array) -> bool:
    return all(NEAREST <= d <= FARTHEST for d in distances(curve, z, sizes))


def fitted(curve: Any, z: Array, sizes: Array) -> Array:
    """z on an interval whose ends are about WANTED from the saddles: cut, or continued by the linear flow there."""
    profile, ends = curve.profile(z), curve.equilibria(z)
    first, last = distances(curve, z, sizes)
    if first > FARTHEST:
        profile = _extended(curve, profile, z, ends[0], first, False)
    if last > FARTHEST:
        profile = _extended(curve, profile, z, ends[-1], last, True)
    if first < NEAREST or last < NEAREST:
        profile = _cut(profile, ends, sizes)
    return np.asarray(curve.join(profile, ends, float(z[-2])))


def _extended(curve: Any, profile: Profile, z: Array, saddle: Array, distance: float, at_end: bool) -> Profile:
    from scipy.linalg import expm

    matrix = curve.matrix(saddle, z)
    real = np.linalg.eigvals(matrix).real
    rate = float(np.min(-real[real < 0.0])) if at_end else float(np.min(real[real > 0.0]))
    time = min(np.log(distance / WANTED), LONGEST) / rate
    count = ADDED * profile.m
    step = time / count
    offset = (profile.u[-1] if at_end else profile.u[0]) - saddle
    # only the part that decays away from the orbit: the rest is the error of the projection
    values, vectors = np.linalg.eig(matrix)
    kept = values.real < 0.0 if at_end else values.real > 0.0
    part = np.real(vectors[:, kept] @ np.linalg.lstsq(vectors, offset.astype(complex), rcond=None)[0][kept])
    flow = expm(matrix * (step if at_end else -step))
    rows = [part]
    for _ in range(count):
        rows.append(flow @ rows[-1])
    piece = saddle + np.array(rows[1:])
    total = profile.period + time
    own, new = profile.h * (profile.period / total), np.full(ADDED, time / ADDED / total)
    if at_end:
        return replace(profile, u=np.vstack([profile.u, piece]), period=total, h=np.concatenate([own, new]))
    return replace(profile, u=np.vstack([piece[::-1], profile.u]), period=total, h=np.concatenate([new, own]))


def _cut(profile: Profile, ends: Array, sizes: Array) -> Profile:
    times = np.linspace(0.0, 1.0, 8 * len(profile.u))
    u = profile.at(times)
    extent = float(np.max(np.ptp(profile.u, axis=0) / sizes))
    away = np.max(np.abs(u - ends[0]) / sizes, axis=1) > 0.1 * WANTED * extent
    arrived = np.max(np.abs(u - ends[-1]) / sizes, axis=1) > 0.1 * WANTED * extent
    start, end = float(times[np.argmax(away)]), float(times[len(times) - 1 - np.argmax(arrived[::-1])])
    inside = profile.mesh[(profile.mesh > start + 1e-9) & (profile.mesh < end - 1e-9)]
    edges = np.concatenate([[start], inside, [end]])
    h = np.diff(edges) / (end - start)
    empty = Profile(profile.m, np.empty((len(h) * profile.m + 1, profile.n)), 1.0, h, profile.parameter)
    return replace(empty, u=profile.at(start + (end - start) * empty.times), period=(end - start) * profile.period)
