"""How long an orbit stays near a saddle on each of its visits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contin.abi import Array
from contin.problems.orbits.ends.distances import NEAR_SADDLE, distances, extent_of
from contin.problems.orbits.march.slow_passage import slow_intervals
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

GROWS = 0.02  # part of what the period gained that a visit must have gained to be one of those that grow without bound


class Resting(Protocol):
    """What is asked of a saddle, `contin.problems.orbits.ends.saddles.Saddle`: its state."""

    @property
    def u(self) -> Array: ...


def visits(
    problem: FamilyOfOrbits, saddle: Resting, profile: Profile, sizes: Array, earlier: Profile | None = None
) -> int:  # fmt: skip
    """How often the orbit comes near the saddle and is slow there before it goes away again.

    It may be slow more than once on one visit: along a slow manifold that leads away, for example. earlier : an orbit
    with a shorter period: visits that have not become longer since are not counted.
    """
    now = [time for time, slow in stays(problem, saddle, profile, sizes) if slow]
    if earlier is None:
        return max(1, len(now))
    then = [time for time, slow in stays(problem, saddle, earlier, sizes) if slow]
    if len(then) != len(now):
        return max(1, len(now))
    gained = profile.period - earlier.period
    return max(1, sum(a - b > GROWS * gained for a, b in zip(now, then, strict=True)))


def time_away(problem: FamilyOfOrbits, saddles: Sequence[Resting], profile: Profile, sizes: Array) -> float:
    """The time of a period that the orbit spends away from saddles."""
    return profile.period - sum(time for s in saddles for time, _ in stays(problem, s, profile, sizes))


def stays(problem: FamilyOfOrbits, saddle: Resting, profile: Profile, sizes: Array) -> list[tuple[float, bool]]:
    """How long each visit lasts, and whether the orbit is slow there, from the first one in the period on.

    Ends are linear between nodes: the difference of two orbits next to each other is far more exact than their times.
    """
    reach = NEAR_SADDLE * extent_of(profile, sizes)
    gaps = distances(problem, saddle.u, profile.u[:-1], sizes)
    away = np.flatnonzero(gaps > reach)
    if not away.size:
        return [(profile.period, True)]
    first = int(away[0])
    order = np.append(np.roll(np.arange(len(gaps)), -first), first)  # a closed curve that begins and ends away
    gaps, slow = gaps[order], slow_intervals(problem, profile, sizes)[order]
    times = (profile.times[order] - profile.times[first]) % 1.0 * profile.period
    times[-1] = profile.period
    outside = np.flatnonzero(gaps > reach)
    found = []
    for left, right in zip(outside[:-1].tolist(), outside[1:].tolist(), strict=True):
        if right - left > 1:
            begin = _crossing(times, gaps, reach, left)
            found.append((_crossing(times, gaps, reach, right - 1) - begin, bool(slow[left + 1 : right].any())))
    return found


def _crossing(times: Array, gaps: Array, reach: float, k: int) -> float:
    """When the distance is `reach` between nodes k and k + 1."""
    part = (reach - gaps[k]) / (gaps[k + 1] - gaps[k])
    return float(times[k] + part * (times[k + 1] - times[k]))
