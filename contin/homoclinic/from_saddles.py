"""A connecting orbit between two given saddles: what a curve, or a branch, of them starts from."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.errors import ContinError, InputError, NoSolutionError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.from_table import Path, as_profile
from contin.homoclinic.guesses import Between, approaches_from_either, trajectory, turns
from contin.homoclinic.homotopy import brought_home
from contin.homoclinic.interval import distances
from contin.homoclinic.reversor import Reversor
from contin.homoclinic.solved_connection import solved_connection
from contin.homoclinic.symmetric_guesses import crossings, half_of
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import indices
from contin.simulate.natural import natural_metric
from contin.systems.away_from_samples import away, on_even_times

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

NEAR: Final = 0.3  # distance of the ends from the saddles, of the extent, at which Newton's method is tried first
NEUTRAL: Final = 1e-6  # rates this small beside the largest are those of a centre
POINT: Final = 0.05  # extent of the solution, of the guess's, below which it is the saddle
ONE_SADDLE: Final = 1e-8  # of the states' sizes: saddles this near are one


@dataclass(frozen=True, eq=False)
class ConnectingOrbit:
    """Two saddles (the same one for a homoclinic orbit) at parameters near those of an orbit that connects them.

    path : samples of the orbit, where there are any; otherwise trajectories in the unstable manifold are tried.
    truncation : distance of the orbit's ends from the saddles, relative to its extent; by default what digits need.
    """

    system: CompiledSystem
    p: Array
    saddles: Array  # (2, n)
    path: Path | None = None
    truncation: float | None = None
    reversor: Reversor | None = None  # then the orbit is symmetric, and half of it is solved for

    def locus(self, parameters: tuple[str, str]) -> list[Seed]:
        """The curve of connecting orbits in two parameters, which starts at the present value of the second one.

        Where the first one moves no orbit to the second saddle (a plane that stays invariant), of the first one.
        """
        first, second = indices(self.system, parameters)
        try:
            return [self._found(first, second)]
        except NoSolutionError:
            with suppress(ContinError):  # the failure with the parameters as they are named is told
                return [self._named_anew(self._found(second, first), first, second)]
            raise

    def seed(self, parameter: str) -> Seed:
        """The branch of connecting orbits in one parameter, which starts at its present value."""
        first = list(self.system.parameter_names).index(parameter)
        return self._found(first, first)

    def _found(self, first: int, second: int) -> Seed:
        """The first guess that leads to a connecting orbit; one parameter where they are the same."""
        if self.reversor is not None:
            return self._symmetric(first, second, self.reversor)
        n, persists = self.system.n, first == second
        rates = [np.linalg.eigvals(self._matrix(u)).real for u in self.saddles]
        stable, unstable = int(np.sum(rates[0] < 0.0)), int(np.sum(rates[1] > 0.0))
        self._check_count(n - stable, n - unstable, persists)
        orbits = OrbitProblem(self.system, self.p.copy(), first, np.zeros(n), 4)
        q, guesses = 0.0 if persists else float(self.p[second]), []
        for arc in self._guesses(float(self.p[first]), n - stable, n - unstable):
            winding = turns(self.periods, arc.u[-1] - self.saddles[1])
            loop = self.between.is_loop
            curve = ConnectionCurve(
                orbits, second, 1 if loop else 2, stable, unstable, slots=(-1,) if persists else (-2, -1),
                winding=winding if loop and winding.any() else None, truncation=self.truncation,
            )  # fmt: skip
            ends = self.saddles[:1] if loop else np.array([self.saddles[0], self.saddles[1] + winding])
            guesses.append((curve, arc, ends))
        return self._told(*_first_solved(guesses, q))

    def _named_anew(self, seed: Seed, first: int, second: int) -> Seed:
        """An orbit that was found with the parameters the other way round."""
        curve, z = seed.problem.curve, seed.z  # type: ignore[attr-defined]
        arc, q = curve.profile(z), float(z[-2])
        orbits = OrbitProblem(self.system, self.p.copy(), first, np.zeros(self.system.n), 4)
        own = replace(curve, orbits=orbits, second=second)
        found = solved_connection(own, replace(arc, parameter=q), curve.equilibria(z), arc.parameter, None)
        return replace(found, remarks=seed.remarks)

    def _told(self, seed: Seed, guess: Profile) -> Seed:
        """The seed, with a note where samples have led to an orbit that is not near them."""
        if self.path is None:
            return seed
        whole, half = seed.problem.profile(seed.z), seed.problem.curve.profile(seed.z)  # type: ignore[attr-defined]
        times, states, compared = guess.times * guess.period, guess.u, [whole]
        if self.reversor is not None:  # the guess is half of the first pulse, and samples may be of one half
            times, states, compared = self.path.times, self.path.states, [whole, half]
        notes = []
        for one in compared:
            span = max(one.period, float(times[-1] - times[0]))
            a, b = on_even_times(times, states, span), on_even_times(one.times * one.period, one.u, span)
            notes.append(away(self.system.state_names, a, b, "open"))
        return replace(seed, remarks=(notes[0],)) if all(notes) else seed

    def _symmetric(self, first: int, second: int, reversor: Reversor) -> Seed:
        """Half of an orbit that the reversor maps onto itself."""
        n, persists = self.system.n, first == second
        rates = np.linalg.eigvals(self._matrix(self.saddles[0])).real
        leaving = int(np.sum(rates > NEUTRAL * np.abs(rates).max()))
        self._check_symmetric(leaving, n - len(reversor.rows), persists)
        orbits = OrbitProblem(self.system, self.p.copy(), first, np.zeros(n), 4)
        curve = ConnectionCurve(
            orbits, second, 1, n - leaving, len(reversor.rows), slots=(-1,) if persists else (-2, -1),
            truncation=self.truncation, reversor=reversor,
        )  # fmt: skip
        parameter, q = float(self.p[first]), 0.0 if persists else float(self.p[second])
        if self.path is not None:
            arcs = [half_of(self.path, self.between, reversor, parameter)]
        else:
            arcs = [trajectory(self.between, one, parameter) for one in crossings(self.between, reversor)]
        return self._told(*_first_solved([(curve, arc, self.saddles[:1]) for arc in arcs], q))

    def _check_symmetric(self, leaving: int, fixed: int, persists: bool) -> None:
        n, free = self.system.n, leaving + fixed - self.system.n
        words = (
            f"the unstable manifold of the saddle has dimension {leaving}, the fixed space of the reversor {fixed}, in "
            f"{n} dimensions: symmetric orbits "
        )
        if leaving == 0 or free > 0 or free < -1:
            raise InputError(words + ("form families" if free > 0 else "need more parameters; these are not followed"))
        if free == 0 and not persists:
            raise InputError(words + "persist; name one parameter, in which they are followed")
        if free < 0 and persists:
            raise InputError(words + "exist on curves in the plane of two parameters; name two parameters")

    def _check_count(self, leaving: int, arriving: int, persists: bool) -> None:
        """Dimensions of both manifolds decide how many parameters a connection needs."""
        n, free = self.system.n, leaving + arriving - self.system.n
        if free == int(persists):
            return
        where = f"the unstable manifold of the first saddle has dimension {leaving}, the stable one of the second"
        words = f"{where} {arriving}, in {n} dimensions: "
        if free == 1:
            raise InputError(words + "such orbits persist; name one parameter, in which they are followed")
        if free == 0:
            raise InputError(words + "such orbits exist on curves in the plane of two parameters; name two parameters")
        if free < 0:
            raise InputError(words + f"such orbits need {1 - free} special parameters; these are not followed")
        raise InputError(words + "such orbits form families at fixed parameters, none of which is told from the others")

    def _guesses(self, parameter: float, leaving: int, arriving: int) -> list[Profile]:
        """Samples, or trajectories; of manifolds of these dimensions."""
        if self.path is not None:
            return [as_profile(self.path, self.between, parameter)]
        found = approaches_from_either(self.between, leaving, arriving)
        return [trajectory(self.between, one, parameter) for one in found]

    @cached_property
    def between(self) -> Between:
        apart = self.saddles[0] - self.saddles[1]
        near = np.abs(apart - turns(self.periods, apart)) <= ONE_SADDLE * self.sizes
        return Between(self.system, self.p, self.saddles, self.sizes, self.periods, bool(np.all(near)))

    @cached_property
    def periods(self) -> Array:
        values = dict(zip(self.system.parameter_names, (float(x) for x in self.p), strict=False))
        return np.asarray(self.system.model.periods(values), dtype=float)

    @cached_property
    def sizes(self) -> Array:
        """Of the states (n,), in which all lengths are measured: natural ones at the first saddle, or the saddles'."""
        natural = natural_metric(self.system, self.saddles[0], self.p).states
        return np.asarray(np.maximum(natural, np.abs(self.saddles).max(axis=0)))

    def _matrix(self, u: Array) -> Array:
        return np.asarray(self.system.jacobian(u, self.p)[1][:, : self.system.n])


def _first_solved(guesses: list[tuple[ConnectionCurve, Profile, Array]], q: float) -> tuple[Seed, Profile]:
    """The first orbit that is found, and its guess."""
    failures: list[str] = []
    for curve, arc, ends in guesses:
        try:
            return _solved(curve, arc, ends, q), arc
        except ContinError as error:
            failures.append(str(error))
    tried = f" (the best of {len(failures)} trajectories that were tried)" if len(failures) > 1 else ""
    raise NoSolutionError(f"no connecting orbit was found: {failures[0]}{tried}")


def _solved(curve: ConnectionCurve, arc: Profile, ends: Array, q: float) -> Seed:
    """By Newton's method where the guess is near, and by homotopy where that fails or the guess is not near."""
    z = curve.join(arc, ends, q)
    if curve.reversor is not None:
        return _no_point(solved_connection(curve, arc, ends, q, None), arc)
    if max(distances(curve, z, curve.orbits.state_sizes(arc))) <= NEAR:
        with suppress(InputError):  # homotopy is tried next, whose failure is told
            return solved_connection(curve, arc, ends, q, None)
    home, ends = brought_home(curve, arc, ends, q)
    return solved_connection(curve, home, ends, q, None)


def _no_point(seed: Seed, guess: Profile) -> Seed:
    """The seed, unless its orbit is the saddle itself, which solves the equations of symmetric orbits too."""
    found = seed.problem.profile(seed.z)  # type: ignore[attr-defined]
    if float(np.ptp(found.u, axis=0).max()) < POINT * float(np.ptp(guess.u, axis=0).max()):
        raise NoSolutionError("Newton's method came to the saddle itself")
    return seed
