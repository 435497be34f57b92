"""Seeds as the settings want them discretised: made for collocation, on another mesh or for shooting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.loci.shooting.curve import ShootingCurve
from contin.loci.shooting.shot_locus import ShotLocusProblem
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.on_mesh import on_mesh
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.search.shot_orbit import orbit_from_return, shooting_chosen

if TYPE_CHECKING:
    from contin.problems.orbits.collocated_orbits import OrbitProblem

REACH = 3e-2  # (arclength) from an equilibrium to the first special orbit
NEARBY = 1e-4  # scaled time after which the direction of a small cycle is looked at again


def orbits_as_chosen(seed: Seed, settings: Settings) -> Seed:
    """Of an `OrbitProblem`: for shooting where that is asked for, or the flow is piecewise smooth, else on a mesh."""
    problem: Any = seed.problem
    chosen = shooting_chosen(problem.system, settings.method)
    return shooting_seed(seed, settings) if chosen else on_mesh(seed, settings)


def loci_as_chosen(seed: Seed, settings: Settings) -> Seed:
    """Of an `OrbitLocusProblem` whose orbits are born at an equilibrium, likewise."""
    problem: Any = seed.problem
    chosen = seed.born and shooting_chosen(problem.system, settings.method)
    return born_by_shooting(seed, settings) if chosen else seed


@dataclass(frozen=True, eq=False)
class OnNodes:
    """How an orbit on a mesh, and changes of it, are told by nodes at `times`; `normal` is that of the section.

    `orbits` : the `OrbitProblem` with the mesh.  `flow` : the same orbits by shooting.  `h` : the mesh.
    """

    orbits: Any
    flow: ShootingProblem
    times: Array
    normal: Array
    h: Array

    @classmethod
    def along(cls, orbits: OrbitProblem, z: Array, raw: Array, sizes: Array, count: int) -> Self:
        """For a family that leaves the orbit z in the direction `raw`.

        The section is square to the flow; around a point at rest it contains the direction to the first node.
        """
        profile, times = orbits.profile(z), np.arange(count) / count
        flow = shot(orbits, count)
        out = cls(orbits, flow, times, np.zeros(orbits.n), profile.h)
        if not orbits.autonomous:
            return out
        velocity = flow.system.value(profile.u[0], orbits.full_parameters(z)) / sizes
        if orbits.is_constant(z, np.ones(len(z))):
            change = out._profile(raw)
            first, next_ = change.at(np.array([0.0, NEARBY])) / sizes
            velocity = next_ - first
            velocity = velocity - float(velocity @ first) / float(first @ first) * first
        normal = velocity / (sizes * max(float(np.linalg.norm(velocity)), 1e-300))
        return replace(out, normal=normal)

    def orbit(self, z: Array) -> Array:
        """z of the nodes."""
        profile = self.orbits.profile(z)
        u = profile.at(self.times)
        return Nodes(u, profile.period, self.normal, float(self.normal @ u[0]), profile.parameter).vector()

    def change(self, raw: Array) -> Array:
        """A direction in the model's units; the section stays."""
        found = self._profile(raw)
        return Nodes(found.at(self.times), found.period, np.zeros(self.flow.n), 0.0, found.parameter).vector()

    def metric(self, sizes: Array, scale: Array) -> Array:
        """The metric of the nodes with the period's and the parameter's scale of another one."""
        return make_scale(sizes, len(self.times), float(scale[-2 - len(self.h)]), float(scale[-1]))

    def _profile(self, raw: Array) -> Profile:
        along = raw.copy()
        along[-1 - len(self.h) : -1] = self.h
        found: Profile = self.orbits.profile(along)
        return found


def shot(orbits: OrbitProblem, count: int) -> ShootingProblem:
    """The same orbits by shooting, in `count` segments."""
    winding = np.asarray(orbits.winding, dtype=float)
    measures = orbits.measures
    return ShootingProblem(
        orbits.system, orbits.base, orbits.active, winding, count, orbits.multiple, measures=measures
    )


def scaled(raw: Array, bend: Array | None, scale: Array) -> tuple[Array, Array | None]:
    """Unit direction and curvature of z + s raw + s^2 bend / 2 in a metric."""
    d = raw / scale
    length = float(np.linalg.norm(d))
    d = d / length
    if bend is None:
        return d, None
    k = bend / scale / elementary.square(length)
    return d, k - float(k @ d) * d


def shooting_seed(seed: Seed, settings: Settings) -> Seed:
    """A seed of an `OrbitProblem` as one for shooting."""
    problem: Any = seed.problem
    if seed.direction is None:
        profile, p = problem.profile(seed.z), problem.full_parameters(seed.z)
        system = problem.system
        orbit = orbit_from_return(
            system, profile.u[0], p[: len(problem.base)],
            np.asarray(system.model.periods(shot(problem, 1).constants())), profile.period, problem.multiple,
            settings.intervals,
        )  # fmt: skip
        return orbit.seed(problem.parameters[0])
    assert seed.scale is not None
    raw, sizes = seed.direction * seed.scale, problem.sizes(seed.z, seed.scale)
    nodes = OnNodes.along(problem, seed.z, raw, sizes, settings.intervals or 1)
    scale = nodes.metric(sizes, seed.scale)
    bend = None if seed.curvature is None else nodes.change(seed.curvature * seed.scale)
    d, k = scaled(nodes.change(raw), bend, scale)
    return replace(seed, problem=nodes.flow, z=nodes.orbit(seed.z), direction=d, curvature=k, scale=scale)


def born_by_shooting(seed: Seed, settings: Settings) -> Seed:
    """A seed of an `OrbitLocusProblem`, of orbits that are born at an equilibrium, as one for shooting."""
    problem: Any = seed.problem
    assert seed.direction is not None
    assert seed.scale is not None
    old, raw = problem.curve, seed.direction * seed.scale
    bend = np.zeros_like(raw) if seed.curvature is None else seed.curvature * seed.scale
    orbits, rest, metric = old.at(seed.z), old.orbit(seed.z), old.orbit(seed.scale)
    sizes = orbits.sizes(rest, metric)
    nodes = OnNodes.along(orbits, rest, old.orbit(raw), sizes, settings.intervals or 1)
    curve = ShootingCurve(old.type, nodes.flow, old.second)

    def laid(change: Array) -> Array:
        return curve.join(nodes.change(old.orbit(change)), float(change[-2]), old.further(change))

    z = curve.join(nodes.orbit(rest), float(seed.z[-2]), old.further(seed.z))
    scale = curve.join(nodes.metric(sizes, metric), float(seed.scale[-2]), 1.0)
    d, k = scaled(laid(raw), laid(bend), scale)
    assert k is not None
    ahead = z + scale * (REACH * d + 0.5 * elementary.square(REACH) * k)  # at rest every orbit is special
    curve = curve.settled(ahead, scale)
    shot_problem = ShotLocusProblem(curve, second_bounds=problem.second_bounds, first_bounds=problem.first_bounds)
    return replace(seed, problem=shot_problem, z=z, direction=d, curvature=k, scale=scale, reach=REACH)
