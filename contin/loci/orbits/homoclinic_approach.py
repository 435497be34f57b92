"""Curves of special orbits whose period grows without bound: they follow a curve of homoclinic orbits, ever closer.

An orbit that spends the time t near a saddle, which it comes to at the rate s and leaves at the rate r, lies of the
order exp(-min(r, s) t) beside the connecting orbit, in the parameters too
(`contin.problems.orbits.ends.unbounded_period`). Where that is less than the error of the mesh, the curve cannot be
told from that of the connecting orbits. Rates and time are read off the orbit: which of the saddle's directions have
a part in it need not be known.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.problems.orbits.ends.distances import distances, extent_of
from contin.problems.orbits.ends.ends import LINGERING
from contin.problems.orbits.ends.passage import NEAR, beside
from contin.problems.orbits.ends.saddles import Saddle, rounded, saddles_near
from contin.problems.orbits.march.slow_passage import dwelling
from contin.problems.orbits.mesh.layout import Profile
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits
    from contin.problems.orbits.two_parameters import OfPeriodicOrbits

CLOSE: Final = 1e-4  # ... where the corrector fails: special orbits are regular to a part of what remains


def approached(problem: OfPeriodicOrbits, z: Array, before: Array, scale: Array, failed: bool = False) -> End | None:
    """The end of a curve (z, its row before) that cannot be told from one of connecting orbits; None elsewhere.

    failed : the corrector can go no further, which is explained already by less than the mesh's error.
    """
    curve = problem.curve
    orbits, profile = curve.at(z), curve.profile(z)
    if not orbits.autonomous or not profile.period > curve.profile(before).period:
        return None
    sizes = orbits.sizes(curve.orbit(z), curve.orbit(scale))
    part = dwelling(orbits, profile, sizes)
    if part < LINGERING:
        return None
    saddles = saddles_near(orbits, profile, sizes)
    if not saddles:
        return None
    off = _beside(orbits, profile, saddles, sizes)
    limit = CLOSE if failed else orbits.resolution
    return _end(problem, z, profile.period, saddles, off, scale, sizes) if off < limit else None


def _beside(orbits: FamilyOfOrbits, profile: Profile, saddles: list[Saddle], sizes: Array) -> float:
    """exp(-min(r, s) t) of the passage that makes least of it; 1 where there is none."""
    extent = extent_of(profile, sizes)
    gaps = np.min([distances(orbits, s.u, profile.u[:-1], sizes) for s in saddles], axis=0) / extent
    outside = np.flatnonzero(gaps > NEAR)
    if not outside.size:
        return 1.0
    first = int(outside[0])
    gaps, times = np.roll(gaps, -first), np.roll(profile.times[:-1], -first)
    times = (times - times[0]) % 1.0 * profile.period
    ends = np.flatnonzero(gaps > NEAR)
    largest = 0.0
    for left, right in pairwise([*ends.tolist(), len(gaps)]):
        if right - left < 2:
            continue
        closest = left + 1 + int(np.argmin(gaps[left + 1 : right]))
        after = profile.period if right == len(gaps) else float(times[right])
        sides = float(times[closest] - times[left]), after - float(times[closest])
        largest = max(largest, beside(float(gaps[closest]), sides))
    return largest or 1.0


def _end(
    problem: OfPeriodicOrbits, z: Array, period: float, saddles: list[Saddle], off: float, scale: Array,
    sizes: Array
) -> End:  # fmt: skip
    first, second = problem.parameters
    names = problem.system.state_names
    kind = "homoclinic" if len(saddles) == 1 else "heteroclinic"
    found: list[Fields] = [
        {
            "state": dict(zip(names, rounded(s.u, sizes).tolist(), strict=True)),
            "eigenvalues": s.eigenvalues,
            "saddle_quantity": s.quantity,
        }
        for s in saddles
    ]
    data: Fields = {"at": {first: float(z[-1]), second: float(z[-2])}, "error": off * float(scale[-1])}
    if len(saddles) == 1:
        data |= {"saddle": found[0]["state"], "passes": saddles[0].visits}
        data |= {k: found[0][k] for k in ("eigenvalues", "saddle_quantity")}
    else:
        data["saddles"] = found
    places = ", ".join("(" + ", ".join(f"{k} = {v:.8g}" for k, v in s["state"].items()) + ")" for s in found)
    text = (
        f"the period grows without bound (here {period:.6g}): from {problem.place(z)} on the curve cannot be told from "
        f"that of {kind} orbits ({off:.0e} of the scales away), saddle{'s' if len(saddles) > 1 else ''} {places}"
    )
    return End(kind, text, data)
