"""Where families found by shooting start: at a simulation, or at a seed made for collocation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.errors import NoSolutionError
from contin.problems.orbits.loci.problem import OrbitLocusProblem
from contin.problems.orbits.problem import OrbitProblem
from contin.problems.orbits.start import configured
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.phase import quietest, rebased, section_at
from contin.problems.shooting.problem import ShootingProblem
from contin.problems.shooting.segments import Segments

GROWTH = 1e3  # of perturbations in a segment, above which more segments are taken
MOST = 64
AT_REST = 1e-9


@dataclass(frozen=True, eq=False)
class ShotOrbit:
    """An orbit at fixed parameters p, found by shooting: the start of a continuation."""

    system: Any
    nodes: Nodes
    p: Array
    winding: Array
    multiple: int = 1

    @property
    def period(self) -> float:
        return self.nodes.period

    def problem(self, parameter: str) -> ShootingProblem:
        """The continuation problem with this parameter free."""
        active = list(self.system.parameter_names).index(parameter)
        return ShootingProblem(self.system, self.p, active, self.winding, self.nodes.count, self.multiple)

    def seed(self, parameter: str) -> Seed:
        problem = self.problem(parameter)
        return Seed(problem, replace(self.nodes, parameter=float(self.p[problem.active])).vector())

    def __str__(self) -> str:
        u = self.nodes.u[0]
        states = ", ".join(f"{k} = {v:.6g}" for k, v in zip(self.system.state_names, u, strict=True))
        return f"periodic orbit of period {self.period:.10g} through {states}"


def shooting_wanted(problem: Any, settings: Settings) -> bool:
    """True where the orbits of this problem are to be found by shooting."""
    return shooting_chosen(problem.system, settings.method)


def shooting_chosen(system: Any, method: str | None) -> bool:
    """`method` as written, or shooting where the flow is piecewise smooth."""
    return method == "shooting" or (method is None and system.n_switches > 0 and system.pieces.count > 0)


def orbit_from_return(
    system: Any, u: Array, p: Array, periods: Array, period: float, multiple: int, segments: int | None
) -> ShotOrbit:
    """The orbit next to a trajectory that nearly returns to u after `period`, by Newton at fixed parameters."""
    from contin.simulate.flight import fly

    angles = periods > 0.0
    unit = np.where(angles, periods, 1.0)
    u = np.where(angles, u - periods * np.floor(u / unit), u)
    change = fly(system, u, p, period).finished().end - u
    winding = np.where(angles, periods * np.round(change / unit), 0.0)
    problem = ShootingProblem(system, np.array(p, dtype=float), 0, winding, 1, multiple)
    sizes = np.maximum(np.abs(u), 1e-3 * float(np.abs(u).max()))
    full = problem.full_parameters(np.array([p[0]]))
    normal, offset = section_at(problem, u, full, sizes) if problem.autonomous else (np.zeros(len(u)), 0.0)
    z = Nodes(u[None], period, normal, offset, float(p[0])).vector()
    fraction = quietest(problem, z) if problem.autonomous else 0.0
    sizes = problem.state_sizes(problem.profile(z))
    count = segments or _enough(problem, z)
    problem = replace(problem, count=count)
    z = split(problem, z, count)
    if problem.autonomous:
        z = rebased(problem, z, fraction, sizes)
    scale = make_scale(sizes, count, 2.0 * period, 1.0)
    solved = problem.at_parameter(z, float(p[0]), scale)
    if solved is None or float(np.linalg.norm((solved - z) / scale)) > 1.0:
        raise NoSolutionError(
            f"the simulation nearly returns after {period:.6g}, but Newton does not close the orbit: integrate longer "
            "(transient), or start nearer to the orbit"
        )
    extent = np.ptp(problem.profile(solved).u, axis=0)
    if problem.autonomous and not winding.any() and float(np.max(extent / sizes)) < AT_REST:
        raise NoSolutionError("the closed orbit is an equilibrium: start further away from it")
    return ShotOrbit(system, Nodes.of(solved, len(u)), np.array(p, dtype=float), winding, multiple)


def _enough(problem: Any, z: Array) -> int:
    """As many segments as keep perturbations in each from growing by more than GROWTH."""
    count = 1
    while count < MOST:
        segments = Segments.of(replace(problem, count=count), split(problem, z, count))
        if segments is None or float(np.abs(segments.transitions).max()) < GROWTH:
            break
        count *= 2
    return count


def split(problem: Any, z: Array, count: int) -> Array:
    """The same orbit with another number of segments."""
    from contin.problems.shooting.sampling import states

    nodes = Nodes.of(z, problem.n)
    if nodes.count == count:
        return z
    one = replace(problem, count=nodes.count)
    return replace(nodes, u=states(one, z, np.arange(count) / count)).vector()


def on_its_mesh(seed: Seed, settings: Settings) -> Seed:
    """The seed as the settings want it: orbits on a mesh of that many intervals, or by shooting; others as they are."""
    if isinstance(seed.problem, OrbitLocusProblem) and seed.born and shooting_wanted(seed.problem, settings):
        from contin.problems.shooting.loci.start import born_by_shooting

        return born_by_shooting(seed)
    if not isinstance(seed.problem, OrbitProblem):
        return seed
    return shooting_seed(seed, settings) if shooting_wanted(seed.problem, settings) else configured(seed, settings)


def shooting_seed(seed: Seed, settings: Settings) -> Seed:
    """A seed made for collocation (from a Hopf point, or an orbit) as one for shooting."""
    problem: OrbitProblem = seed.problem  # type: ignore[assignment]
    profile = problem.profile(seed.z)
    flow = ShootingProblem(
        problem.system, problem.base, problem.active, np.asarray(problem.winding, dtype=float), 1, problem.multiple
    )
    p = problem.full_parameters(seed.z)
    rest = seed.direction is not None and problem.is_constant(seed.z, np.ones(len(seed.z)))
    if seed.direction is None:
        orbit = orbit_from_return(
            problem.system, profile.u[0], p[: len(problem.base)],
            np.asarray(problem.system.model.periods(flow.constants())), profile.period, problem.multiple,
            settings.intervals,
        )  # fmt: skip
        return orbit.seed(problem.parameters[0])
    assert seed.scale is not None
    count = settings.intervals or 1
    flow = replace(flow, count=count)
    times = np.arange(count) / count
    raw = seed.direction * seed.scale
    raw[profile.u.size + 1 : -1] = profile.h
    change = problem.profile(raw)
    sizes = problem.sizes(seed.z, seed.scale)
    u, along = profile.at(times), change.at(times)
    if problem.autonomous:
        velocity = flow.system.value(u[0], p) / sizes
        if rest:  # a small ellipse around the Hopf point: the section contains the direction to its first node
            velocity, first = (change.at(np.array([1e-4]))[0] - along[0]) / sizes, along[0] / sizes
            velocity = velocity - float(velocity @ first) / float(first @ first) * first
        normal = velocity / (sizes * max(float(np.linalg.norm(velocity)), 1e-300))
    else:
        normal = np.zeros(problem.n)
    z = Nodes(u, profile.period, normal, float(normal @ u[0]), profile.parameter).vector()
    scale = make_scale(sizes, count, float(seed.scale[profile.u.size]), float(seed.scale[-1]))
    direction = np.zeros(len(z))
    direction[: along.size] = along.ravel() / scale[: along.size]
    direction[-1] = change.parameter / scale[-1]
    direction[along.size] = change.period / scale[along.size]
    direction /= np.linalg.norm(direction)
    return replace(seed, problem=flow, z=z, direction=direction, curvature=None, scale=scale)
