"""Where families found by shooting start: at a trajectory that nearly returns. And which flows want shooting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.told import Told
from contin.errors import NoSolutionError
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.number_of_segments import enough, split
from contin.problems.shooting.phase import quietest, rebased, section_at
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.records import Fields
from contin.search.orbit_by_simulation import (
    BUDGET,
    LONGEST,
    find_return,
    most_repeats,
    orbit_by_simulation,
    refuse_chance,
)
from contin.simulate.flight import fly
from contin.simulate.natural import natural_metric
from contin.systems.described import states_in_words

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

AT_REST = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class ShotOrbit(Told):
    """An orbit at fixed parameters p, found by shooting: the start of a continuation."""

    system: CompiledSystem
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
        nodes = replace(self.nodes, parameter=float(self.p[problem.active]))
        problem = problem.restricted(nodes.vector())
        if problem.fixed is not None:
            u = problem.fixed.onto(nodes.u)
            nodes = replace(nodes, u=u, offset=float(nodes.normal @ u[0]))
        return Seed(problem, nodes.vector())

    def __str__(self) -> str:
        u = self.nodes.u[0]
        states = states_in_words(self.system.state_names, u, lambda k: f"= {u[k]:.6g}")
        return f"periodic orbit of period {self.period:.10g} through {states}"


def shooting_chosen(system: CompiledSystem, method: str | None) -> bool:
    """`method` as written, or shooting where the flow is piecewise smooth."""
    return method == "shooting" or (method is None and system.n_switches > 0 and system.pieces.count > 0)


def settled_orbit(
    system: CompiledSystem, u: Array, p: Array, periods: Array, *, method: str | None = None, transient: float = 0.0,
    longest: float = LONGEST, budget: int = BUDGET, intervals: int | None = None, points: int = 4,
) -> PeriodicOrbit | ShotOrbit:  # fmt: skip
    """The orbit that the trajectory from u settles on, by the method that is asked for or that the flow wants.

    Raises as `contin.search.orbit_by_simulation.orbit_by_simulation`.
    """
    if not shooting_chosen(system, method):
        options: Fields = {"transient": transient, "intervals": intervals, "points": points}
        return orbit_by_simulation(system, u, p, periods, longest=longest, budget=budget, **options)
    near = find_return(system, u, p, periods, transient, longest, budget)
    orbit = orbit_from_return(system, near.u, p, periods, near.period, near.multiple, intervals)
    times = _covered(orbit, near.loops, periods)
    if times > 1:
        multiple = max(near.multiple // times, 1)
        near = replace(near, period=orbit.period / times, multiple=multiple, loops=max(near.loops // times, 1))
        orbit = orbit_from_return(system, orbit.nodes.u[0], p, periods, near.period, near.multiple, intervals)
    refuse_chance(near, orbit)
    return orbit


def _covered(orbit: ShotOrbit, loops: int, periods: Array) -> int:
    """How often an orbit repeats itself within its period: it is back at its first state after a part of it.

    A transient that has nearly gone closes best after several forcing periods or loops. Run through several times, an
    orbit has the multipliers' powers, and a doubling passes for a branch point.
    """
    whole, limit = most_repeats(orbit, loops, periods)
    if whole == 1:
        return 1
    problem = orbit.problem(orbit.system.parameter_names[0])
    u = orbit.nodes.u[0]
    path = problem.profile(orbit.seed(orbit.system.parameter_names[0]).z).u
    extent = np.maximum(np.ptp(path, axis=0), AT_REST * max(float(np.abs(path).max()), 1e-300))
    for count in range(whole, 1, -1):
        if whole % count == 0:
            back = fly(orbit.system, u, orbit.p, orbit.period / count).finished().end - orbit.winding / count
            if float(np.max(np.abs(back - u) / extent)) < limit:
                return count
    return 1


def orbit_from_return(
    system: CompiledSystem, u: Array, p: Array, periods: Array, period: float, multiple: int, segments: int | None
) -> ShotOrbit:
    """The orbit next to a trajectory that nearly returns to u after `period`, by Newton at fixed parameters."""
    angles = periods > 0.0
    unit = np.where(angles, periods, 1.0)
    u = np.where(angles, u - periods * np.floor(u / unit), u)
    change = fly(system, u, p, period).finished().end - u
    winding = np.where(angles, periods * np.round(change / unit), 0.0)
    problem = ShootingProblem(system, np.array(p, dtype=float), 0, winding, 1, multiple)
    sizes = natural_metric(system, u, np.asarray(p, dtype=float)[: system.m]).states
    full = problem.full_parameters(np.array([p[0]]))
    normal, offset = section_at(problem, u, full, sizes) if problem.autonomous else (np.zeros(len(u)), 0.0)
    z = Nodes(u[None], period, normal, offset, float(p[0])).vector()
    fraction = quietest(problem, z) if problem.autonomous else 0.0
    sizes = problem.state_sizes(problem.profile(z))
    count = segments or enough(problem, z)
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
