"""A periodic orbit with jumps from a simulation: the cycle of events that repeats, closed by Newton's method."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.told import Told
from contin.errors import NoSolutionError
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.hybrid.flow import HybridFlow
from contin.problems.hybrid.grazing import unexpected
from contin.problems.hybrid.hybrid_orbits import HybridOrbits
from contin.problems.hybrid.passage import Arc
from contin.problems.hybrid.return_system import ReturnSystem
from contin.search.orbit_by_simulation import ADVICE, CHANCE, FIRST_TIME, LONGEST, UNSTABLE, time_scale
from contin.search.tolerances import CLOSE
from contin.simulate.natural import SMALLER, absolute_tolerances, natural_metric
from contin.simulate.resets import Jump, fly_with_events

if TYPE_CHECKING:
    from contin.model.model import Model

LONGEST_CYCLE: Final = 128  # events
ENOUGH: Final = 3 * LONGEST_CYCLE
REPEATED: Final = 1e-6  # of the states' sizes: distance of a solved cycle and itself some events later, if it repeats
MOVED: Final = 0.05  # by which Newton's method may move it
PATIENCE: Final = 16.0  # longest intervals in which an event of a trajectory comes, or not at all
LONGEST_PERIOD: Final = 512.0  # of a family, in periods of the orbit that it begins with; a forced one's stays
BOX: Final = 1e100  # where a simulation escapes
RTOL: Final = 1e-10
BUDGET: Final = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class HybridOrbit(Told):
    """A periodic orbit with jumps at fixed parameters p: the start of a continuation."""

    map: ReturnSystem
    u: Array
    p: Array

    @property
    def system(self) -> ReturnSystem:
        """Whose parameters may vary."""
        return self.map

    def problem(self, parameter: str) -> HybridOrbits:
        """The continuation problem with this parameter free."""
        active = list(self.map.parameter_names).index(parameter)
        return HybridOrbits(EquilibriumProblem(self.map, self.p, active, _angles(self.map.flow, self.p)[self.map.kept]))

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""
        problem = self.problem(parameter)
        return Seed(problem, np.append(self.u, self.p[problem.active]))

    @property
    def period(self) -> float:
        found = self.map.passage(self.u, self.p)
        return np.nan if found is None else found.period

    @property
    def events(self) -> tuple[int, ...]:
        """Numbers (from 1) of the events of one period, in order."""
        return tuple(1 + k for arc in self.map.arcs for k in (arc.event, *arc.then))

    def __str__(self) -> str:
        names, found = self.map.flow.given.state_names, self.map.passage(self.u, self.p)
        after = np.full(len(names), np.nan) if found is None else found.flown[-1].after
        states = ", ".join(f"{k} = {v:.6g}" for k, v in zip(names, after, strict=False))
        noun = "event" if len(self.events) == 1 else "events"
        return f"periodic orbit of period {self.period:.10g} with {len(self.events)} {noun}, after the last at {states}"


@dataclass(frozen=True, eq=False)
class _Landing:
    """Jumps at one time."""

    time: float
    events: tuple[int, ...]
    after: Array


def hybrid_orbit(model: Model, u: Array, p: Array, transient: float) -> HybridOrbit:
    """The orbit that the trajectory from u settles on, or already lies on.

    Raises NoSolutionError where events do not repeat: none comes any more, they accumulate, or no cycle of up to
    `LONGEST_CYCLE` events closes.
    """
    flow = HybridFlow(model)
    state = np.append(u, np.zeros(flow.n - len(u)))
    scale = time_scale(flow.system, state, p)
    time = FIRST_TIME * scale + transient
    errors, natural = absolute_tolerances(flow.system, state, p, SMALLER * RTOL), natural_metric(flow.system, state, p)
    while True:
        times = np.linspace(0.0, time, 2000)
        flight, jumps = fly_with_events(
            flow.model, state, p, times, rtol=RTOL, atol=errors, box=BOX, budget=BUDGET
        )
        landings = _landings(jumps, transient)
        largest = np.abs(flight.u[len(flight.u) // 2 :]).max(axis=0, initial=0.0)
        sizes = np.where(largest > 0.0, largest, natural.states)
        found = _repeating(landings, flight.u, _angles(flow, p)) if flight.outcome == "done" else None
        if found is not None:
            return _closed(flow, p, *found, np.where(_angles(flow, p) > 0.0, 1.0, sizes), flight.end_time)
        over = _is_over(jumps, flight.end_time) or (not jumps and flight.steps >= BUDGET)
        if flight.outcome != "done" or over or time > LONGEST * scale or len(landings) > ENOUGH:
            if over:
                raise NoSolutionError(_without_events(jumps[-1].time if jumps else 0.0, flight.end_time))
            raise NoSolutionError(_why_none(landings, flight.outcome, flight.why, flight.end_time))
        time *= 4.0


def _angles(flow: HybridFlow, p: Array) -> Array:
    """Periods of the states (n,), 0 where they are no angles."""
    return flow.model.periods(dict(zip(flow.model.parameter_names, p.tolist(), strict=True)))


def _is_over(jumps: tuple[Jump, ...], end: float) -> bool:
    """True where events have happened, and none any more for much longer than between them."""
    if not jumps:
        return False
    times = np.array([0.0, *(jump.time for jump in jumps)])
    return bool(end - times[-1] > PATIENCE * max(float(np.diff(times).max()), end / (2.0 * PATIENCE)))


def _without_events(last: float, end: float) -> str:
    when = f"from t = {last:.4g} to {end:.4g}" if last else f"up to t = {end:.4g}"
    return (
        f"no event happens {when}: the orbits of this start have no jumps. Leave `events` out of the model to follow "
        "them, or start where an event happens"
    )


def _why_none(landings: list[_Landing], outcome: str, why: str, end: float) -> str:
    if outcome != "done":
        return f"no periodic orbit: the simulation stops at t = {end:.6g}: {why}"
    if not landings:
        return _without_events(0.0, end)
    return f"no periodic orbit: up to t = {end:.4g} no cycle of events closes. {ADVICE}."


def _landings(jumps: tuple[Jump, ...], transient: float) -> list[_Landing]:
    """Jumps after the transient, those at one time together; without the last time, at which more may follow."""
    found: list[_Landing] = []
    for jump in jumps:
        if jump.time < transient:
            continue
        if len(jump.events) > 1:
            raise NoSolutionError(
                f"at t = {jump.time:.6g} several events happen at the same time: orbits through such points are not "
                "followed, for there the map from jump to jump has no derivative"
            )
        if found and jump.time == found[-1].time:
            found[-1] = _Landing(jump.time, (*found[-1].events, *jump.events), jump.after)
        else:
            found.append(_Landing(jump.time, jump.events, jump.after))
    return found


def _repeating(landings: list[_Landing], u: Array, angles: Array) -> tuple[list[_Landing], Array] | None:
    """The landings of the last cycle, with the one before it, and what the states gain in it; or None."""
    extent = np.maximum(np.ptp(u[len(u) // 2 :], axis=0), 1e-300)
    extent = np.where(angles > 0.0, np.where(angles > 0.0, angles, 1.0), extent)
    for count in range(1, min(LONGEST_CYCLE, len(landings) // 2) + 1):
        last, before = landings[-1], landings[-1 - count]
        same = all(landings[-i].events == landings[-i - count].events for i in range(1, count + 1))
        change = last.after - before.after
        turns = np.where(angles > 0.0, angles * np.round(change / np.where(angles > 0.0, angles, 1.0)), 0.0)
        if same and float(np.max(np.abs(change - turns) / extent)) < CLOSE:
            return landings[-1 - count :], turns
    return None


def _covered(returning: ReturnSystem, u: Array, p: Array, sizes: Array) -> int:
    """How often a cycle of several events repeats itself: it is back at its first state after a part of them."""
    found = returning.passage(u, p)
    if found is None:
        return 1
    arcs, events = len(returning.arcs), [(arc.event, arc.then) for arc in returning.arcs]
    for count in range(arcs, 1, -1):
        part, rest = divmod(arcs, count)
        if rest or events != events[:part] * count:
            continue
        parts = [found.flown[k].after for k in range(part - 1, arcs, part)]
        steps = np.diff(np.array(parts), axis=0) - returning.winding / count
        if float(np.max(np.abs(steps) / sizes, initial=0.0)) < REPEATED:
            return count
    return 1


def _closed(
    flow: HybridFlow, p: Array, cycle: list[_Landing], winding: Array, sizes: Array, after: float
) -> HybridOrbit:
    """Newton's method from a cycle that nearly closes."""
    patience = (PATIENCE if flow.forced else LONGEST_PERIOD) * (cycle[-1].time - cycle[0].time)
    arcs = tuple(
        Arc(
            here.events[0], here.events[1:], here.time - before.time, patience,
            flow.is_on(here.events[0], before.after, p, sizes),
        )
        for before, here in itertools.pairwise(cycle)
    )  # fmt: skip
    angles = _angles(flow, p)
    u = np.where(angles > 0.0, np.mod(cycle[0].after, np.where(angles > 0.0, angles, 1.0)), cycle[0].after)
    returning = ReturnSystem(flow, arcs, winding, sizes)
    u, kept_sizes = u[returning.kept], sizes[returning.kept]
    problem = HybridOrbit(returning, u, p).problem(returning.parameter_names[0])
    scale = np.append(np.sqrt(len(u)) * kept_sizes, abs(p[0]) or 1.0)
    z = problem.at_parameter(np.append(u, p[0]), float(p[0]), scale)
    far = z is None or float(np.max(np.abs(z[:-1] - u) / kept_sizes)) > MOVED
    if z is None or far or unexpected(problem, z) is not None:
        raise NoSolutionError(
            f"the simulation nearly repeats after {len(arcs)} events, but Newton's method does not close the orbit: "
            "integrate longer (transient), or start nearer to the orbit"
        )
    times = _covered(returning, z[:-1], p, sizes)
    if times > 1:  # a transient whose sign alternates, say, closes best after two cycles
        return _closed(flow, p, cycle[: len(arcs) // times + 1], winding / times, sizes, after)
    if len(arcs) >= CHANCE and float(np.nanmax(np.abs(problem.multipliers(z)), initial=0.0)) > UNSTABLE:
        raise NoSolutionError(
            f"no periodic orbit: within t = {after:.4g} the trajectory does not settle on one; its nearest return, "
            f"after {len(arcs)} events, is by chance, near an unstable orbit. {ADVICE}."
        )
    return HybridOrbit(returning, z[:-1], p)
