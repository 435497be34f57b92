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

FARTHER: Final = 4.0  # times as far as the end, of an equilibrium
SAMPLES: Final = 4001
SEEN: Final = 1e-2  # of a cycle's extent, from which on offsets tell how the manifolds bend


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
    """Some turns farther along the orbit, at the same phase: where its offset is well above the errors of the mesh."""
    names, states = problem.two.names, problem.model.state_names
    n, clock = len(states), values["T:"] * values[f"period:{problem.cycles[0]}"]
    own = [names.index(f"{name}:{place}") for name in states]
    base, extent = profile.u[0, own], float(np.linalg.norm(np.ptp(profile.u[:, own], axis=0)))
    turns = np.arange(0.0, 1.0, values[f"period:{place}"] / clock)
    offsets = profile.at(turns if place == 1 else 1.0 - turns)[:, :n] - base
    end, sizes = offsets[0], np.linalg.norm(offsets, axis=1)
    there = offsets[int(np.argmax(sizes >= SEEN * extent)) or len(turns) - 1]
    far = float(there @ there)
    found, mode = {}, 0
    while f"part{mode}:{place}" in values:
        w = profile.u[0, [names.index(adjoint_name(s, "start" if place == 1 else "end", mode)) for s in states]]
        found[f"part{mode}:{place}"] = float(w @ there) * float(end @ end) / far if far > 0.0 else 0.0
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
    gaps = np.linalg.norm(offsets, axis=1)
    chosen = int(np.argmax(gaps >= FARTHER * gaps[0])) or SAMPLES - 1
    there = offsets[chosen]
    outside = there - v @ np.linalg.lstsq(v, there, rcond=None)[0]
    part = outside * float(elementary.square(gaps[0] / gaps[chosen])) if gaps[chosen] > 0.0 else 0.0 * outside
    return {f"part{i}:{place}": float(x) for i, x in enumerate(part)}
