"""How far the invariant manifolds that a connecting orbit leaves and enters bend away from their linear spaces.

The orbit's ends are held in the linear spaces, from which the manifolds differ by terms of second order in the
distance. What these are the orbit itself tells: at a point a few times as far from its end it lies on the manifold to
a higher order, so that its part outside of the linear space, over its squared distance, is the manifold's curvature.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile
from contin.symbolic.passes.connecting import adjoint_name

if TYPE_CHECKING:
    from contin.homoclinic.ends_of_connection import EndsOfConnection

FARTHER: Final = 4.0  # times as far as the end
SAMPLES: Final = 4001
SEEN: Final = 1e-2  # of a cycle's extent, from which on offsets tell how the manifolds bend, and ...
WIDE: Final = 16.0  # ... up to how many times that
PER_TURN: Final = 200  # samples


def bends(problem: EndsOfConnection, z: Array) -> dict[str, float]:
    """What the conditions at the ends miss on the true manifolds, by the names of their constants `part..`."""
    profile = problem.profile(z)
    values = dict(zip(problem.two.parameters, problem.full_parameters(z)[:-1].tolist(), strict=True))
    free = {name: float(profile.u[0, problem.two.n_states + k]) for k, name in enumerate(problem.two.free)}
    values |= free
    found: dict[str, float] = {}
    for place in (1, 2):
        of = _of_cycle if place in problem.cycles else _of_equilibrium
        found |= of(problem, profile, values, place)
    return found


def _of_cycle(problem: EndsOfConnection, profile: Profile, values: dict[str, float], place: int) -> dict[str, float]:
    """The largest curvature along the orbit where its offset from the cycle is small and well above the mesh's errors.

    Offsets are those from the cycle at the orbit's own time. The curvature depends on the phase, and the directions in
    which the orbit comes on their rates: the largest value stands for that at the end, and counts up to twice where
    it is that of a part of a turn (strong contraction).
    """
    names, states = problem.two.names, problem.model.state_names
    n, clock, period = len(states), values["T:"] * values[f"period:{problem.cycles[0]}"], values[f"period:{place}"]
    own = [names.index(f"{name}:cycle{place}") for name in states]
    extent = float(problem.length(np.ptp(profile.u[:, own], axis=0)))
    back = np.arange(0.0, 1.0, period / clock / PER_TURN)  # of the orbit's time
    phases = back * clock / period % 1.0
    there, cycle = (profile.at(x if place == 1 else 1.0 - x) for x in (back, phases))
    offsets = there[:, :n] - cycle[:, own]
    sizes = problem.length(offsets)
    least = max(SEEN * extent, FARTHER * float(sizes[0]))
    chosen = np.flatnonzero((sizes >= least) & (sizes <= WIDE * least))
    unseen = max(1.0 - len(chosen) / PER_TURN, 0.0)
    found, mode = {}, 0
    while f"part{mode}:{place}" in values:
        w = [names.index(adjoint_name(s, "start" if place == 1 else "end", mode)) for s in states]
        curved = np.sum(cycle[:, w] * offsets, axis=1)[chosen] / elementary.square(sizes[chosen])
        largest = float(curved[int(np.argmax(np.abs(curved)))]) if len(curved) else 0.0
        found[f"part{mode}:{place}"] = (1.0 + unseen) * largest * elementary.square(float(sizes[0]))
        mode += 1
    return found


def _of_equilibrium(
    problem: EndsOfConnection, profile: Profile, values: dict[str, float], place: int
) -> dict[str, float]:  # fmt: skip
    """Where it is a few times as far from the equilibrium."""
    states = problem.model.state_names
    n, s = len(states), np.linspace(0.0, 1.0, SAMPLES)
    x0 = np.array([values[f"{name}:saddle{place}"] for name in states])
    k = sum(1 for j in range(n) if f"c{j}:{place}" in values)
    v = np.array([[values[f"v{i}{j}:{place}"] for j in range(k)] for i in range(n)])
    offsets = profile.at(s)[:, :n] - x0
    offsets = offsets if place == 1 else offsets[::-1]
    gaps = problem.length(offsets)
    chosen = int(np.argmax(gaps >= FARTHER * gaps[0])) or SAMPLES - 1
    there = offsets[chosen]
    units = np.ones(n) if problem.units is None else problem.units
    outside = there - v @ np.linalg.lstsq(v / units[:, None], there / units, rcond=None)[0]
    part = outside * float(elementary.square(gaps[0] / gaps[chosen])) if gaps[chosen] > 0.0 else 0.0 * outside
    return {f"part{i}:{place}": float(x) for i, x in enumerate(part)}
