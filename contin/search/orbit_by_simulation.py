"""A periodic orbit from a simulation: integrate until the trajectory returns, then polish by collocation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.errors import AtRestError, NoSolutionError
from contin.machine import elementary
from contin.model.evaluate import evaluate
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.search.tolerances import CLOSE
from contin.simulate.natural import natural_metric
from contin.simulate.trajectory import Section, integrate
from contin.systems.described import states_in_words

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

FIRST_TIME = 60.0  # time scales before the first look
LONGEST = 2e5  # time scales until giving up
WAITING = 20  # times as long where nothing has come back once: relaxation oscillations between slow states
BUDGET = 1_000_000  # steps between two looks: a trajectory that needs more escapes, or is stiff beyond use
CROSSINGS = 60  # returns compared at once
NEAR = 3e-2  # a return this close (relative to the orbit's extent) is tried when time is up
SETTLED = 0.7  # a trajectory whose last part is smaller than this part of the rest is still shrinking
CLOSED = 1e-9  # ... and one as close as this closes up to rounding, whatever Newton says
AT_REST = 1e-7  # extent (relative) of a trajectory that has come to rest
REPEATED_EXACTLY = 1e-6  # ... of an orbit of no forcing: one that has doubled departs by far more, but at its birth
REPEATED = 1e-5  # difference (relative to the extent) of a response and itself some periods later, if it repeats
LONGEST_MULTIPLE = 16  # forcing periods
WITHIN = 8  # looks at the state in each forcing period: one that is zero at the period's beginning has its size between
CHANCE = 4  # loops from which an unstable orbit is one that a chaotic trajectory came close to by chance
UNSTABLE = 1.05  # largest modulus of a multiplier above which an orbit is unstable beyond doubt
ADVICE = (
    "It may be chaotic or quasi-periodic, or drift slowly. Try: parameters at which an orbit is stable, following it "
    "from there; the orbits born at a Hopf point (from: LINE.HB1); another start; a longer transient"
)


@dataclass(frozen=True, eq=False)
class Return:
    """Where a trajectory nearly closes: a state of it, the time it takes (forcing periods: `multiple`), its loops."""

    u: Array
    period: float
    multiple: int
    loops: int
    distance: float  # relative to the extent
    after: float  # time simulated


def orbit_by_simulation(
    system: CompiledSystem,
    u: Array,
    p: Array,
    periods: Array,
    *,
    transient: float = 0.0,
    intervals: int | None = None,
    points: int = 4,
    longest: float = LONGEST,
    budget: int = BUDGET,
) -> PeriodicOrbit:
    """The orbit that the trajectory from u settles on (or already lies on), within `longest` time scales.

    `budget` : steps between two looks whether it has. Raises NoSolutionError where the trajectory comes to rest, does
    not return within the time, or where Newton on the closed trajectory fails; NotFiniteError where it escapes.
    """
    near = find_return(system, u, p, periods, transient, longest, budget)
    orbit = _polished(system, near, p, periods, intervals, points)
    resolved = orbit  # on a user's coarse mesh seven periods of a response do not look alike
    if intervals is not None and max(near.loops, near.multiple) > 1:
        resolved = _polished(system, near, p, periods, None, points)
    times = _covered(resolved, near.loops, periods)
    if times > 1:  # a transient that had nearly gone closed best after several periods
        state, shorter, multiple = resolved.profile.u[0], near.period / times, max(near.multiple // times, 1)
        near = replace(near, u=state, period=shorter, multiple=multiple, loops=max(near.loops // times, 1))
        orbit = _polished(system, near, p, periods, intervals, points)
    refuse_chance(near, orbit)
    return orbit


def _covered(orbit: PeriodicOrbit, loops: int, periods: Array) -> int:
    """How often an orbit of several loops, turns or forcing periods repeats itself within them."""
    times, u, winding = orbit.profile.times, orbit.profile.u, orbit.winding
    extent = np.maximum(np.ptp(u, axis=0), AT_REST * max(float(np.abs(u).max()), 1e-300))  # more than rounding
    whole, limit = most_repeats(orbit, loops, periods)
    for count in range(whole, 1, -1):
        if whole % count:
            continue
        later = times + 1.0 / count
        gained = np.floor(later)[:, None] * winding - winding / count
        shifted = orbit.profile.at(np.mod(later, 1.0)) + gained
        if float(np.max(np.abs(shifted - u) / extent)) < limit:
            return count
    return 1


def most_repeats(orbit: Any, loops: int, periods: Array) -> tuple[int, float]:
    """How often an orbit may repeat itself at most (divisors of this may, too), and how nearly it then does."""
    winding = orbit.winding
    if orbit.system.is_forced:
        return 1 if winding.any() else orbit.multiple, REPEATED
    turns = np.round(winding / np.where(periods > 0.0, periods, np.inf)).astype(int)
    return int(np.gcd.reduce(turns)) if winding.any() else loops, REPEATED_EXACTLY


def refuse_chance(near: Return, orbit: Any) -> None:
    """Raises NoSolutionError for an unstable orbit that a chaotic trajectory came close to by chance."""
    if near.loops < CHANCE:
        return
    seed = orbit.seed(orbit.system.parameter_names[0])
    largest = float(np.nanmax(np.abs(seed.problem.multipliers(seed.z)), initial=0.0))
    if largest > UNSTABLE:
        raise NoSolutionError(
            f"no periodic orbit: within t = {near.after:.4g} the trajectory does not settle on one. Its nearest "
            f"return, after {near.loops} loops, is by chance: the orbit there, of period {orbit.period:.6g}, is "
            f"unstable (a multiplier of modulus {largest:.2g}). {ADVICE}."
        )


def find_return(
    system: CompiledSystem, u: Array, p: Array, periods: Array, transient: float = 0.0, longest: float = LONGEST,
    budget: int = BUDGET,
) -> Return:  # fmt: skip
    """Where the trajectory from u, settled, nearly closes; errors as above."""
    start = np.array(u, dtype=float)
    if transient > 0.0:
        start = integrate(system, start, p, transient).end
    if system.is_forced:
        return _forced(system, start, p)
    scale = time_scale(system, start, p)
    largest = np.maximum(np.abs(start), CLOSED * natural_metric(system, start, p).states)
    time, total, best = FIRST_TIME * scale, 0.0, (np.inf, start, 0.0, 0)
    while total < longest * scale or (best[0] == np.inf and total < WAITING * longest * scale):
        path = integrate(system, start, p, time, times=np.linspace(0.0, time, 800), budget=budget)
        total += time
        largest = np.maximum(largest, np.abs(path.u).max(axis=0))
        extent, recent = np.ptp(path.u[400:], axis=0), np.ptp(path.u[-100:], axis=0)
        still = float(np.max(np.where(periods > 0, 0.0, extent / largest))) < AT_REST
        if still and not _turns(extent, periods):
            where = _in_words(system, path.end)
            raise AtRestError(
                f"the simulation comes to rest at an equilibrium ({where}) after t = {total:.4g}: no periodic orbit "
                "attracts this start. Start elsewhere, change the parameters, or start from a Hopf point.",
                path.end.copy(),
            )
        one_turn = np.where(periods > 0.0, periods, np.inf)  # more than that is no larger
        shrinking = bool(np.all(np.minimum(recent, one_turn) < SETTLED * np.minimum(extent, one_turn)))
        found = None if shrinking else _return(system, path.end, p, periods, time, extent, budget)
        if found is not None:
            if found[0] < best[0]:
                best = found
            if found[0] < CLOSE:
                break
        start, time = path.end, min(1.6 * time, max(0.2 * longest * scale, 0.5 * total))
    distance, at, period, loops = best
    if distance > NEAR:
        raise NoSolutionError(
            f"no return found: the trajectory does not close within t = {total:.4g} (nearest return: {distance:.1e} of "
            f"its extent). {ADVICE}."
        )
    return Return(at, period, 1, loops, distance, total)


def _turns(extent: Array, periods: Array) -> bool:
    return bool(np.any((periods > 0) & (extent > 0.5 * periods)))


def time_scale(system: CompiledSystem, u: Array, p: Array) -> float:
    _, jacobian = system.jacobian(u, np.append(p, 0.0) if system.is_forced else p)
    fastest = float(np.abs(np.linalg.eigvals(jacobian[:, : system.n])).max())
    return 1.0 / fastest if np.isfinite(fastest) and fastest > 0.0 else natural_metric(system, u, p).time


def _return(
    system: CompiledSystem, u: Array, p: Array, periods: Array, time: float, extent: Array, budget: int
) -> tuple[float, Array, float, int] | None:
    """(distance, state, period, loops): the best return to a section through u, of at most CROSSINGS.

    Within `budget` steps: a trajectory may escape after the look that took it for one that may return.
    """
    unit = np.where(extent > 0.0, extent, 1.0)
    normal = system.value(u, p) / elementary.square(unit)
    normal[periods > 0.0] = 0.0
    if normal.any():
        # the fastest place of the orbit makes the best section: move there first
        section = Section(normal, float(normal @ u), 1)
        path = integrate(system, u, p, time, section=section, events=CROSSINGS, budget=budget)
        states, times = path.event_states, path.event_times
    else:
        states, times = _full_turns(system, u, p, periods, time, extent, budget)
    best: tuple[float, Array, float, int] | None = None
    for k in range(1, len(states) // 2 + 1):
        difference = states[-1] - states[-1 - k]
        angles = periods > 0.0
        difference = np.where(
            angles, difference - periods * np.round(difference / np.where(angles, periods, 1.0)), difference
        )
        distance = float(np.max(np.abs(difference) / np.where(angles, periods, unit)))
        if best is None or distance < 0.3 * best[0]:
            best = distance, states[-1], float(times[-1] - times[-1 - k]), k
        if best[0] < CLOSE:
            break
    return best


def _full_turns(
    system: CompiledSystem, u: Array, p: Array, periods: Array, time: float, extent: Array, budget: int
) -> tuple[Array, Array]:
    """States (k, n) and times (k,) after every full turn of the angle that turns most, if only angles move."""
    fastest = int(np.argmax(extent / np.where(periods > 0.0, periods, np.inf)))
    sense = 1.0 if integrate(system, u, p, time, budget=budget).end[fastest] > u[fastest] else -1.0
    normal = np.zeros(system.n)
    normal[fastest] = sense
    states, times = [u], [0.0]
    while len(states) <= CROSSINGS and times[-1] < time:
        section = Section(normal, float(normal @ u) + len(states) * periods[fastest], 1)
        path = integrate(system, states[-1], p, time - times[-1], section=section, events=1, budget=budget)
        if not len(path.event_times):
            break
        states.append(path.event_states[-1])
        times.append(times[-1] + float(path.event_times[-1]))
    return np.array(states), np.array(times)


def _forced(system: CompiledSystem, u: Array, p: Array) -> Return:
    """Stroboscopic: the smallest multiple of the forcing period after which the state returns."""
    period = float(evaluate(system.forcing_period, dict(zip(system.parameter_names, p, strict=True))))
    start, best, total = u, (np.inf, u, 1), 0
    for _ in range(60):
        total += 64
        path = integrate(system, start, p, 64 * period, times=period / WITHIN * np.arange(64.0 * WITHIN + 1.0))
        sizes = natural_metric(system, path.u[-1], p).states
        u = path.u[::WITHIN]
        unit = np.maximum(np.ptp(u, axis=0), CLOSED * np.maximum(np.abs(path.u).max(axis=0), sizes))
        for k in range(1, LONGEST_MULTIPLE + 1):
            distance = float(np.max(np.abs(u[-1] - u[-1 - k]) / np.maximum(unit, np.abs(u[-1]))))
            if distance < 0.1 * best[0]:
                best = distance, u[-1], k
        if best[0] < CLOSE:
            break
        start = path.end
    if best[0] > NEAR:
        raise NoSolutionError(
            f"no periodic response found: the stroboscopic states do not return within {LONGEST_MULTIPLE} forcing "
            f"periods (nearest: {best[0]:.1e} of their extent). {ADVICE}."
        )
    return Return(best[1], best[2] * period, best[2], best[2], best[0], total * period)


def _in_words(system: CompiledSystem, u: Array) -> str:
    return states_in_words(system.state_names, u, lambda k: f"= {u[k]:.6g}")


def _polished(
    system: CompiledSystem, near: Return, p: Array, periods: Array, intervals: int | None, points: int
) -> PeriodicOrbit:
    """The nearly closed trajectory on an adapted mesh, solved by Newton at fixed parameters."""
    period, multiple = near.period, near.multiple
    problem: OrbitProblem | None = None
    h = np.full(100, 0.01)
    profile = Profile(points, np.empty((0, system.n)), period, h, 0.0)
    angles = periods > 0.0
    u = np.where(angles, near.u - periods * np.floor(near.u / np.where(angles, periods, 1.0)), near.u)
    for _ in range(3):
        profile = _sampled(system, u, p, period, h, points)
        change = profile.u[-1] - profile.u[0]
        winding = np.where(periods > 0.0, periods * np.round(change / np.where(periods > 0.0, periods, 1.0)), 0.0)
        problem = OrbitProblem(system, p, 0, winding, points, intervals, multiple)
        sizes = problem.state_sizes(profile)
        h = choose_mesh(profile, sizes, problem.tolerance, intervals).h
    assert problem is not None
    profile = replace(_sampled(system, u, p, period, h, points), parameter=float(p[0]))
    closed = profile.u - profile.times[:, None] * (profile.u[-1] - profile.u[0] - winding)
    z = replace(profile, u=closed).vector()
    scale = problem.initial_scale(z, (z[-1] - 0.5, z[-1] + 0.5))
    solved = problem.at_parameter(z, float(p[0]), scale)
    if solved is None or float(np.linalg.norm((solved - z) / scale)) > 1.0:
        raise NoSolutionError(_not_found(near))
    if problem.autonomous and problem.is_constant(solved, 1e3 * scale):
        raise NoSolutionError("the closed orbit is an equilibrium: start further away from it")
    return PeriodicOrbit(system, problem.profile(solved), np.array(p, dtype=float), problem.winding, multiple)


def _not_found(near: Return) -> str:
    """Why Newton may find no orbit next to a trajectory that nearly closes."""
    if near.distance < CLOSED:
        return (
            f"the trajectory closes, with period {near.period:.6g}, but Newton finds no isolated orbit: it seems to be "
            "one of a continuum of periodic orbits, as conservative systems have them. Give the equations a parameter "
            "that makes them dissipative (0 where they are not): the orbits are then a family in that parameter, born "
            "at the Hopf point of its branch of equilibria."
        )
    return (
        f"no periodic orbit: within t = {near.after:.4g} the trajectory does not settle on one. Newton finds none next "
        f"to its closest return, at {near.period:.6g} ({near.loops} loops, to {near.distance:.1e} of its extent). "
        f"{ADVICE}."
    )


def _sampled(system: CompiledSystem, u: Array, p: Array, period: float, h: Array, points: int) -> Profile:
    empty = Profile(points, np.empty((len(h) * points + 1, system.n)), period, h, 0.0)
    times = empty.times * period
    times[-1] = min(times[-1], period)
    path = integrate(system, u, p, period * (1.0 + 1e-12), times=times)
    return replace(empty, u=path.u)
