"""Stable orbits that no family on a line leads to, found from where unstable equilibria send trajectories."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.diagram.identity import wrapped
from contin.diagram.orbits import known_orbit
from contin.diagram.phase.cycles import cycles_reached
from contin.diagram.phase.rest import ZERO as ZERO_OF_REST
from contin.diagram.phase.rest import is_rest
from contin.diagram.phase.states import State, images_of, points_of
from contin.diagram.sizes import length, sizes_among
from contin.errors import AtRestError, ContinError, NoSolutionError, NotFiniteError
from contin.search.equilibrium_from_guess import converge
from contin.search.orbit_by_simulation import UNSTABLE, time_scale
from contin.search.orbit_from_samples import orbit_from_samples
from contin.search.shot_orbit import settled_orbit
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

PUSH, LEAST = 1e-2, 1e-3  # length of the push along an unstable direction, of the state; which is at least this large
LONGEST: Final = 4000.0  # time scales in which a trajectory is to settle on an orbit
LASTING: Final = 20_000.0  # ... and in which one that did not must go on, to be an attractor and no long transient
TRANSIENT, STEPS = 300.0, 6_000  # time scales of the first look, which must not take more steps (or escapes)
LEG: Final = 100_000  # steps between two looks whether a trajectory has settled; more where it escapes, growing stiff
ARRIVED: Final = 1e-3  # distance (relative) from a stable equilibrium at which a trajectory has reached it
TRIED, SCATTERED = 6, 12  # trajectories at one point of the box, from beside unstable equilibria and from anywhere
SMALL: Final = 0.1  # ... and from points so much nearer to zero
BESIDE: Final = 1e-3  # distance (relative) of a start from the stable state of another point of the box
ZERO: Final = 1e-12  # relative to the states' sizes: a state at rest that decays to nothing is zero
WINDOW, RESTING = 20.0, 1e-4  # time scales in which a trajectory at rest moves less than this part of the states' sizes
SAMPLES: Final = 400  # of an orbit
FAIR: Final = 1e-8  # relative tolerance of trajectories that settle
ROUGH: Final = 1e-7  # ... that may not: on an attractor without a period none is followed for long, anyway
SMALLER: Final = 1e-2  # absolute tolerances beside these, relative to the states' sizes
ROUNDS, ONE_ROUND = 64, 1e-5  # most rounds of an orbit that is run through several times; distance of these (relative)
BRIEF: Final = 600.0  # time scales for an orbit in the box of an attractor without a period that is known from before
ROOM: Final = 0.05  # of the extent of the box, around it


@dataclass(frozen=True, eq=False)
class Reached:
    """What trajectories settled on that was not known.

    `seeds` : of branches, in the parameter of the line.  `rests` : states at rest where the equations have no
    derivatives.  `aperiodic` : 1 where some trajectory goes on for ever without a period.  `wild` : corners of boxes
    that hold such trajectories.  `failed` : why some could not be followed; that they escape is none of it.
    """

    seeds: tuple[Seed, ...] = ()
    rests: tuple[State, ...] = ()
    aperiodic: int = 0
    wild: tuple[tuple[Array, Array], ...] = ()
    failed: tuple[str, ...] = ()


def reached(
    problem: EquilibriumProblem, states: Sequence[State], value: float, starts: Sequence[Array] | None = None,
    lasting: bool = True,
    wild: Sequence[tuple[Array, Array]] = (),
) -> Reached:  # fmt: skip
    """Stable states on which trajectories settle, without those that are known.

    `problem` : of the equilibria on the line.  `states` : all that is known where its parameter has this value.
    Trajectories start from `starts`; by default beside every unstable equilibrium, on both sides along its most
    unstable direction, and from `SCATTERED` points around all known states and as many near zero. `lasting` : those
    that do not settle for long are followed until it is plain that they never do. `wild` : boxes in which one did so
    before; of trajectories that stay in one, the first is given some time to settle on an orbit there, after all.
    """
    if problem.system.kind == "map":
        known = [state.vector for state in states]
        scattered = _scattered(problem, states, value) if starts is None else starts
        return Reached(*_of_a_map(problem, known, value, scattered))
    search = _Trajectories(problem, list(states), value, lasting, wild=list(wild))
    if starts is None:
        starts = [*_pushed(problem, states, value)[:TRIED], *_scattered(problem, states, value)]
    for u in starts:
        try:
            search.follow(u)
        except NotFiniteError:  # it escapes
            continue
        except (ContinError, np.linalg.LinAlgError) as error:
            search.failed.append(str(error))
    return Reached(tuple(search.seeds), tuple(search.rests), search.aperiodic, tuple(search.wild), tuple(search.failed))


def _of_a_map(
    problem: EquilibriumProblem, known: Sequence[Array], value: float, starts: Sequence[Array]
) -> tuple[Any, ...]:
    seeds, aperiodic, failed = cycles_reached(problem, known, value, starts)
    return tuple(seeds), (), aperiodic, (), tuple(failed)


@dataclass(eq=False)
class _Trajectories:
    """Follows trajectories at one point of the box and collects what is new."""

    problem: Any
    states: list[State]
    value: float
    lasting: bool = True
    seeds: list[Seed] = field(default_factory=list)
    rests: list[State] = field(default_factory=list)
    wild: list[tuple[Array, Array]] = field(default_factory=list)  # boxes that hold trajectories without a period
    failed: list[str] = field(default_factory=list)  # why some trajectories could not be followed
    looked: bool = False  # for orbits in such a box: other trajectories that stay there are taken for the same

    @property
    def aperiodic(self) -> int:
        """1 where there was such a trajectory."""
        return int(bool(self.wild))

    def __post_init__(self) -> None:
        self.p = self.problem.full_parameters(np.append(np.zeros(self.problem.n), self.value))[: len(self.problem.base)]
        self.periods = np.asarray(self.problem.angle_periods, dtype=float)
        self.sizes = sizes_among(self.problem, [points_of(state) for state in self.states], self.value)
        self.equilibria = [state.vector for state in self.states if state.orbit is None and state.unstable == 0]
        self.resting = any(is_rest(self.problem, v, self.sizes) for v in self.equilibria)
        self.orbits = [state.orbit for state in self.states if state.orbit is not None]

    def follow(self, u: Array) -> None:
        """Let a trajectory settle; raises ContinError where it escapes."""
        system = self.problem.system
        if not np.all(np.isfinite(system.jacobian(u, self.p)[1])):
            return  # no trajectory starts where the equations have no values or no derivatives
        scale = time_scale(system, u, self.p)
        size = self._size(u)
        end = integrate(system, u, self.p, TRANSIENT * scale, rtol=FAIR, atol=SMALLER * FAIR * size, budget=STEPS).end
        if self._is_at_rest(end) or any(_is_on(end, orbit, self.periods, self.sizes) for orbit in self.orbits):
            return
        window = integrate(system, end, self.p, WINDOW * scale, times=np.linspace(0.0, WINDOW * scale, 200))
        if length(np.ptp(window.u, axis=0), self._size(end)) < RESTING:
            self._rest(end)
        elif not self._is_wild(window.u):
            self._orbit(end, scale)
        elif not self.looked:
            self.looked = True
            self._orbit(end, scale, BRIEF)

    def _is_wild(self, points: Array) -> bool:
        """True where a trajectory stays in the box of one that has no period."""
        return any(bool(np.all((low <= points) & (points <= high))) for low, high in self.wild)

    def _size(self, u: Array) -> Array:
        """Of each state, (n,): among those that are known, and of u."""
        return np.where(self.periods > 0.0, self.sizes, np.maximum(self.sizes, np.abs(u)))

    def _is_at_rest(self, u: Array) -> bool:
        """True near a stable equilibrium, or its image under a symmetry."""
        if self.resting and is_rest(self.problem, u, ARRIVED / ZERO_OF_REST * self.sizes):
            return True
        size = max((length(v, self.sizes) for v in self.equilibria), default=0.0)
        near = ARRIVED * max(size, ARRIVED)
        return any(
            length(wrapped(w - v, self.periods), self.sizes) < near
            for w in images_of(self.problem, np.append(u, self.value), self.sizes)
            for v in self.equilibria
        )

    def _rest(self, u: Array) -> None:
        """An equilibrium that no branch led to; where Newton fails, the state itself."""
        try:
            solution = converge(self.problem.system, u, self.p, self.periods)
        except (ContinError, np.linalg.LinAlgError):
            solution = None  # followed to where Newton does not converge: the state itself stands for it
        at = np.array(u if solution is None else solution.u)
        at[np.abs(at) < ZERO * self.sizes] = 0.0
        if self._is_at_rest(at):
            return
        self.equilibria.append(at)
        z = np.append(at, self.value)
        if solution is None or not _is_regular(self.problem, z):
            names = self.problem.system.state_names
            self.rests.append(State(dict(zip(names, at.tolist(), strict=True)), 0, at))
        else:
            self.seeds.append(Seed(self.problem, z))

    def _wander(self, u: Array, scale: float) -> None:
        """A trajectory that has not settled for long: an attractor if it does not in the time that follows either."""
        system, time = self.problem.system, TRANSIENT * scale
        size = self._size(u)
        rate = STEPS / TRANSIENT  # as in the first look
        u = integrate(
            system, u, self.p, LASTING * scale, rtol=ROUGH, atol=SMALLER * ROUGH * size, budget=int(rate * LASTING)
        ).end
        if self._is_at_rest(u) or any(_is_on(u, orbit, self.periods, self.sizes) for orbit in self.orbits):
            return
        path = integrate(system, u, self.p, time, times=np.linspace(0.0, time, 2000), rtol=ROUGH).u
        extent = np.ptp(path, axis=0)
        if length(extent, size) > RESTING:
            self.looked = True
            self.wild.append((path.min(axis=0) - ROOM * extent, path.max(axis=0) + ROOM * extent))

    def _orbit(self, u: Array, scale: float, longest: float = LONGEST) -> None:
        try:
            orbit = settled_orbit(self.problem.system, u, self.p, self.periods, longest=longest, budget=LEG)
        except AtRestError:  # at rest: counted among the equilibria
            return
        except NoSolutionError:
            if self.lasting and longest >= LONGEST:
                self._wander(u, scale)
            return
        seed = self._once_round(orbit.seed(self.problem.parameters[0]))
        problem: Any = seed.problem
        if longest < LONGEST and np.nanmax(np.abs(problem.multipliers(seed.z)), initial=0.0) > UNSTABLE:
            return  # passed by chance, as orbits in a chaotic attractor are
        if known_orbit(problem, seed.z, self.orbits) is None:
            self.orbits.append((problem, seed.z))
            self.seeds.append(seed)

    def _once_round(self, seed: Seed) -> Seed:
        """The orbit that this one runs through several times, as a slowly decaying spiral around it seems to do."""
        problem: Any = seed.problem
        if problem.system.n_switches:
            return seed
        profile = problem.profile(seed.z)
        s = np.linspace(0.0, 1.0, SAMPLES + 1)
        here = profile.at(s)
        allowed = ONE_ROUND * max(length(np.ptp(here, axis=0), self.sizes), 1e-300)
        rounds = np.arange(ROUNDS, 1, -1)
        first = wrapped(profile.at(1.0 / rounds) - here[0], self.periods)  # most are elsewhere there already
        for times in rounds[[length(gap, self.sizes) < allowed for gap in first]].tolist():
            gap = wrapped(profile.at((s + 1.0 / times) % 1.0) - here, self.periods)
            if length(gap, self.sizes) < allowed:
                states = profile.at(s / times)
                t = s * profile.period / times
                once = orbit_from_samples(problem.system, t, states, self.p, self.periods)
                return once.seed(problem.parameters[0])
        return seed


def _is_regular(problem: EquilibriumProblem, z: Array) -> bool:
    return bool(np.all(np.isfinite(problem.linear_part(z))))


def _is_on(u: Array, orbit: tuple[Any, Array], periods: Array, sizes: Array) -> bool:
    """True near a known orbit (which may be unstable: a trajectory that lingers there is followed no further)."""
    problem, z = orbit
    points = problem.profile(z).at(np.linspace(0.0, 1.0, SAMPLES))
    size, grain = length(np.ptp(points, axis=0), sizes), length(np.diff(points, axis=0), sizes)
    return float((np.abs(wrapped(points - u, periods)) / sizes).max(axis=1).min()) < grain + ARRIVED * size


def _pushed(problem: EquilibriumProblem, states: Sequence[State], value: float) -> list[Array]:
    """Starts beside the unstable equilibria, the most unstable ones first."""
    starts: list[tuple[float, Array]] = []
    sizes = sizes_among(problem, [points_of(state) for state in states], value)
    for state in states:
        if state.orbit is not None or state.unstable == 0:
            continue
        matrix = problem.linear_part(np.append(state.vector, value))
        if not np.all(np.isfinite(matrix)):  # rest where the equations have no derivatives: no direction is known
            continue
        values, vectors = np.linalg.eig(matrix)
        k = int(np.argmax(values.real))
        q = np.real(vectors[:, k])
        size = max(length(state.vector, sizes), LEAST)
        step = PUSH * size * q / max(length(q, sizes), 1e-300)
        starts += [(-float(values[k].real), state.vector + sign * step) for sign in (1.0, -1.0)]
    return [u for _, u in sorted(starts, key=lambda item: item[0])]


def _scattered(problem: Any, states: Sequence[State], value: float) -> list[Array]:
    """Points spread over the box of all known states, and as much beside it (the same for the same states).

    States that are zero in all that is known, as on an invariant axis, spread by their natural sizes.
    """
    points = np.concatenate([points_of(state) for state in states] or [np.zeros((1, problem.n))])
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.maximum(high - low, 0.5 * np.maximum(np.abs(low), np.abs(high)))
    sizes = sizes_among(problem, [points], value)
    room = np.where(room > ZERO * sizes, room, sizes)
    generator = np.random.default_rng(7)
    anywhere = generator.uniform(low - room, high + room, (SCATTERED, len(low)))
    scattered = np.concatenate([anywhere, SMALL * anywhere])
    between = generator.uniform(low, high, scattered.shape)
    p = problem.full_parameters(np.append(np.zeros(problem.n), value))[: len(problem.base)]
    # beside the known states there may be no states at all, as where powers of negative numbers are taken
    usable = [bool(np.all(np.isfinite(problem.system.value(u, p)))) for u in scattered]
    return list(np.where(np.array(usable)[:, None], scattered, between))


def within_basins(problem: EquilibriumProblem, states: Sequence[State], value: float) -> list[Array]:
    """A point beside every stable state: where to look for its like at other parameters."""
    generator = np.random.default_rng(3)
    points = [points_of(state)[0] for state in states if state.unstable == 0]
    sizes = sizes_among(problem, points, value)
    return [u + BESIDE * sizes * generator.normal(size=len(u)) for u in points]
