"""Connecting orbits with a cycle at one end or both: found from trajectories, by homotopy.

1.  Trajectories leave the equilibrium (the cycle) along its unstable directions; the nearest approach to the other end
    (or samples) is a solution of the boundary-value problem with a miss. That is taken to zero with one parameter free,
    or, where connections persist, with the direction in which the orbit leaves.
2.  The time is made longer, so that the orbit comes nearer to the cycle.
3.  Distances that the conditions hold, from equilibria and from the cycle that it leaves, are made as small.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.from_guess import solved
from contin.bvp.two_point import two_point
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import trace
from contin.errors import ContinError, InputError, NoSolutionError
from contin.homoclinic.approach import Approach, approaches, of_samples
from contin.homoclinic.cycle_connection_problem import POINTS, ConnectionToCycle, CurveOfConnections, Homotopy
from contin.homoclinic.from_table import Path
from contin.homoclinic.parts_of_vectors import with_parts
from contin.homoclinic.units_of_ends import units_between
from contin.machine import elementary
from contin.model.advice import place_of_parameter
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile, node_times
from contin.problems.orbits.rests_and_cycles import Cycle, Rest
from contin.symbolic.passes.connecting import (
    DISTANCE,
    MISS,
    TIME,
    Connecting,
    CycleEnd,
    End,
    SaddleEnd,
    adjoint_name,
    connecting,
)

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

FINE: Final = 100  # intervals of the first guess, and ...
PER_TURN: Final = 25  # ... more for each turn as long as the cycle
GUESSED: Final = 1e-4  # error of the first mesh: tables of modes are no smoother
HOME: Final = 250  # steps of a homotopy
NEAR: Final = 1e-4  # of the cycle's extent (the orbit's, from an equilibrium), that the orbit's end comes to it
ENOUGH: Final = 1e-2  # ... with which it is content where it comes no nearer
HELD: Final = 3.0  # times as far as that a distance that is held may be
LONGEST: Final = 40.0  # periods by which the orbit is made longer at most


@dataclass(frozen=True, eq=False)
class CycleConnection:
    """An orbit from one end to another at parameters near those of an orbit that connects them."""

    system: CompiledSystem
    p: Array
    first: Rest | Cycle
    last: Rest | Cycle
    path: Path | None = None  # samples of the orbit
    truncation: float = NEAR  # see there

    @property
    def saddles(self) -> Array:
        """A state of either end, (2, n)."""
        return np.array([end.u if isinstance(end, Rest) else end.states[0] for end in (self.first, self.last)])

    def locus(self, parameters: tuple[str, str]) -> list[Seed]:
        """The curve in two parameters, which starts at the present value of the second one."""
        if self.problem.further != 1:
            raise InputError(self._words())
        return [self._found(parameters)]

    def seed(self, parameter: str) -> Seed:
        """The branch in one parameter, which starts at its present value."""
        if self.problem.further != 0:
            raise InputError(self._words())
        return self._found((parameter,))

    @cached_property
    def units(self) -> Array:
        """Of the states, in which all distances are measured."""
        return units_between(self.first, self.last, None if self.path is None else self.path.states)

    @cached_property
    def problem(self) -> Connecting:
        ends = self._end(self.first, True), self._end(self.last, False)
        return connecting(self.system.model, *ends, self.units.tolist())

    def _length(self, offset: Array) -> float:
        return float(np.linalg.norm(offset / self.units))

    def _end(self, end: Rest | Cycle, leaving: bool) -> End:
        if isinstance(end, Rest):
            count = end.dimension(leaving)
            if count == 0:
                raise InputError(f"the equilibrium has no {'unstable' if leaving else 'stable'} direction")
            return SaddleEnd(count)
        return CycleEnd(tuple(1 if m > 0.0 else -1 for m in end.outside(not leaving)))

    def _words(self) -> str:
        """How many parameters such orbits need."""
        dims = []
        for end, leaving in ((self.first, True), (self.last, False)):
            of = end.dimension(leaving) if isinstance(end, Rest) else 1 + len(end.outside(leaving))
            dims.append(of)
        text = (
            f"the unstable manifold of the first end has dimension {dims[0]}, the stable one of the second {dims[1]}, "
            f"in {self.system.n} dimensions: such orbits "
        )
        free = self.problem.further
        if free == 0:
            return text + "persist; name one parameter, in which they are followed"
        if free == 1:
            return text + "exist on curves in the plane of two parameters; name two parameters"
        return text + ("need more parameters; these are not followed" if free > 1 else "form families")

    # -- the homotopy --------------------------------------------------------------------------------------------------

    def _found(self, parameters: tuple[str, ...]) -> Seed:
        for name in parameters:
            place_of_parameter(name, self.system.parameter_names)
        failures, ends = [], (self.system, self.p, self.first, self.last)
        for one in approaches(*ends) if self.path is None else [of_samples(*ends, self.path)]:
            try:
                return self._brought(one, parameters)
            except ContinError as error:
                failures.append(str(error))
        tried = f" (the best of {len(failures)} trajectories that were tried)" if len(failures) > 1 else ""
        raise NoSolutionError(f"no connecting orbit was found: {failures[0]}{tried}")

    def _brought(self, approach: Approach, parameters: tuple[str, ...]) -> Seed:
        free = (*self.problem.free, *parameters[:1]) if self.problem.further else self.problem.free
        two = two_point(self.problem.model, free)
        values = self._values(approach)
        base = np.array([values[name] for name in two.parameters])
        problem: BoundaryProblem = Homotopy(two, base, two.parameters.index(MISS), points=POINTS)
        z = self._guess(problem, approach, values).vector()
        z = _followed(problem, z, (0.0, 2.0), -1, f"step 1 of the homotopy (the miss of {approach.gap:.2g} to zero)")
        problem, z = problem.with_active(TIME, z), _at(z, values[TIME])
        held = self._held(problem, z, values)
        problem, z = self._lengthened(problem, z, held)
        for name, (distance, wanted, _) in held.items():
            problem, z = problem.with_active(name, z), _at(z, distance)
            what = f"step 3 of the homotopy (the distance {distance:.2g} that is held, to {wanted:.2g})"
            z = _followed(problem, z, (wanted, 1.1 * distance), -1, what)
        return self._in_parameters(problem, z, parameters)

    def _held(
        self, problem: BoundaryProblem, z: Array, values: dict[str, float]
    ) -> dict[str, tuple[float, float, float]]:
        """Distances that the conditions hold and are too large: their values, those wanted, periods that this takes."""
        n, u = self.system.n, problem.profile(z).u
        extent, held = self._length(np.ptp(u[:, :n], axis=0)), {}
        clock = next(end.period for end in (self.first, self.last) if isinstance(end, Cycle))
        for place, end in ((1, self.first), (2, self.last)):
            distance = values.get(f"{DISTANCE}{place}", 0.0)
            if isinstance(end, Rest):
                rates = np.linalg.eigvals(end.matrix).real
                rate = float(np.min(np.abs(rates[rates > 0.0 if place == 1 else rates < 0.0]))) * clock
            elif place == 1 and isinstance(self.last, Cycle):
                rate = min(abs(float(elementary.log(abs(m)))) for m in end.outside(True))
                extent = self._length(np.ptp(end.states, axis=0))
            else:
                continue
            wanted = self.truncation * extent
            if distance > HELD * wanted:
                held[f"{DISTANCE}{place}"] = distance, wanted, float(elementary.log(distance / wanted)) / rate
        return held

    def _lengthened(
        self, problem: BoundaryProblem, z: Array, held: dict[str, tuple[float, float, float]]
    ) -> tuple[BoundaryProblem, Array]:
        """Step 2, as far as it goes; with the time that step 3 will need."""
        gap, rate = self._gap(problem, z)
        more = sum(periods for *_, periods in held.values())
        if gap > self.truncation:
            more += float(elementary.log(gap / (0.3 * self.truncation))) / rate
        if more == 0.0:
            return problem, z
        more = min(more, LONGEST)
        at = float(z[-1])
        try:
            return problem, _followed(problem, z, (at, at + more), 1, "step 2 of the homotopy (a longer time)")
        except NoSolutionError:
            if gap <= ENOUGH:
                return problem, z
            raise

    def _gap(self, problem: BoundaryProblem, z: Array) -> tuple[float, float]:
        """Distance from the cycle(s), of their extent; rate of approach a period."""
        u, n = problem.profile(z).u, self.system.n
        gap, rate = 0.0, np.inf
        for place, end in ((1, self.first), (2, self.last)):
            held = place == 1 and isinstance(self.last, Cycle)  # then its distance is a parameter
            if isinstance(end, Cycle) and not held:
                k = problem.two.names.index(f"{self.system.state_names[0]}:cycle{place}")
                offset = u[0 if place == 1 else -1, :n] - u[0, k : k + n]
                own = self._length(offset) / self._length(np.ptp(u[:, k : k + n], axis=0))
                rates = [abs(float(elementary.log(abs(m)))) for m in end.outside(place == 1)]
                if own > gap:
                    gap, rate = own, min(rates, default=1.0)
        return gap, rate

    def _in_parameters(self, problem: BoundaryProblem, z: Array, parameters: tuple[str, ...]) -> Seed:
        """The same solution with the user's first parameter varying."""
        two, own = problem.two, self.problem
        profile = problem.profile(z)
        values = dict(zip(two.parameters, problem.full_parameters(z)[:-1].tolist(), strict=True))
        cycles = tuple(place for place, end in ((1, self.first), (2, self.last)) if isinstance(end, Cycle))
        first = parameters[0]
        if own.further == 0:
            one = ConnectionToCycle(
                two, np.array([values[name] for name in two.parameters]), two.parameters.index(first),
                points=POINTS, flow=self.system, cycles=cycles, units=self.units,
            )  # fmt: skip
            return Seed(one, solved(one, replace(profile, parameter=values[first])))
        second = parameters[1]
        turned = two_point(own.model, (*own.free, second))
        column = two.n_states + two.free.index(first)
        u = profile.u.copy()
        values[first] = float(u[0, column])
        u[:, column] = values[second]
        base = np.array([values[name] for name in turned.parameters])
        curve = CurveOfConnections(
            turned, base, turned.parameters.index(first), points=POINTS, flow=self.system, cycles=cycles,
            units=self.units, second=second,
        )  # fmt: skip
        return Seed(curve, solved(curve, replace(profile, u=u, parameter=values[first])))

    # -- the guess -----------------------------------------------------------------------------------------------------

    def _values(self, one: Approach) -> dict[str, float]:
        """Of all constants of the boundary-value problem."""
        names = self.system.parameter_names
        values = dict(zip(names, (float(x) for x in self.p), strict=False))
        clock = next((end.period for end in (self.first, self.last) if isinstance(end, Cycle)), 1.0)
        values |= {MISS: 1.0, TIME: one.time / clock}
        for place, end, state in ((1, self.first, one.start), (2, self.last, one.finish)):
            if isinstance(end, Rest):
                values |= _at_rest(end, place, state, self.system.state_names, self.units)
                continue
            cycle = end.shifted(one.phases[place - 1])
            offset = state - cycle.states[0]
            values[f"period:{place}"] = end.period
            values[f"{DISTANCE}{place}"] = self._length(offset)
            for k, multiplier in enumerate(end.outside(place == 2)):
                w = cycle.adjoint(multiplier, np.zeros(1), self.units)[0]
                values[f"sigma{k}:{place}"] = float(elementary.log(abs(multiplier)))
                values[f"part{k}:{place}"] = float(w @ offset)
        return values

    def _guess(self, problem: BoundaryProblem, one: Approach, values: dict[str, float]) -> Profile:
        """On a mesh that resolves it, chosen from an even one."""
        turns = max((one.time / end.period for end in (self.first, self.last) if isinstance(end, Cycle)), default=1.0)
        count = int(FINE + PER_TURN * turns)
        fine = self._on(problem, one, values, np.full(count, 1.0 / count))
        seen, n = np.abs(fine.u).max(axis=0), self.system.n
        sizes = np.append(np.maximum(seen[:n], self.units), np.where(seen[n:] > 0.0, seen[n:], 1.0))
        sizes = with_parts(sizes, seen, problem.two.names)
        return self._on(problem, one, values, choose_mesh(fine, sizes, GUESSED, None, closed=False).h)

    def _on(self, problem: BoundaryProblem, one: Approach, values: dict[str, float], h: Array) -> Profile:
        two, m, n = problem.two, problem.points, self.system.n
        s = node_times(h, m)
        u = np.zeros((len(s), two.n))
        u[:, :n] = one.path(s)
        for place, end in ((1, self.first), (2, self.last)):
            if not isinstance(end, Cycle):
                continue
            cycle = end.shifted(one.phases[place - 1])
            for k, name in enumerate(self.system.state_names):
                u[:, two.names.index(f"{name}:cycle{place}")] = cycle.profile.at(s)[:, k]
            for j, multiplier in enumerate(end.outside(place == 2)):
                w = cycle.adjoint(multiplier, s, self.units)
                for k, name in enumerate(self.system.state_names):
                    u[:, two.names.index(adjoint_name(name, "start" if place == 1 else "end", j))] = w[:, k]
        for k, name in enumerate(two.free):
            u[:, two.n_states + k] = values[name]
        return Profile(m, u, 1.0, h, values[MISS])


def _at_rest(end: Rest, place: int, state: Array, names: tuple[str, ...], units: Array) -> dict[str, float]:
    basis = end.basis(place == 1, units)
    dual = basis / np.square(units)[:, None]
    small, c = dual.T @ end.matrix @ basis, dual.T @ (state - end.u)
    values = {f"{name}:saddle{place}": float(x) for name, x in zip(names, end.u, strict=True)}
    for i, j in np.ndindex(*basis.shape):
        values |= {f"v{i}{j}:{place}": float(basis[i, j]), f"r{i}{j}:{place}": float(dual[i, j])}
    for i, j in np.ndindex(*small.shape):
        values[f"l{i}{j}:{place}"] = float(small[i, j])
    values |= {f"c{j}:{place}": float(x) for j, x in enumerate(c)}
    values[f"{DISTANCE}{place}"] = float(np.linalg.norm(c))
    missed = state - end.u - basis @ c
    return values | {f"part{i}:{place}": float(x) for i, x in enumerate(missed)}


def _at(z: Array, value: float) -> Array:
    z = z.copy()
    z[-1] = value
    return z


def _followed(problem: BoundaryProblem, z: Array, bounds: tuple[float, float], sense: int, what: str) -> Array:
    """The solution at the bound to which the parameter of the homotopy goes; NoSolutionError, with its step."""
    settings = Settings(steps=HOME)
    z = solved(problem, problem.profile(z))  # on a mesh that resolves it
    branch = trace(Seed(problem, z, arms=(sense,), passing=True), bounds, settings=settings)
    end, row = branch.ends[1 if sense > 0 else 0], branch.z[-1 if sense > 0 else 0]
    row = row[~np.isnan(row)]
    goal = bounds[1] if sense > 0 else bounds[0]
    if end.reason != "bound" or abs(float(row[-1]) - goal) > 1e-9 * max(abs(goal), 1.0):
        raise NoSolutionError(f"{what} stops at {float(row[-1]):.4g} of {goal:.4g}: {end.text}")
    return np.asarray(row)
