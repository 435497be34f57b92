"""A periodic orbit of a large system from samples of one period."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.told import Told
from contin.errors import InputError, NoSolutionError
from contin.problems.large_orbits.from_starts import FromStarts
from contin.problems.large_orbits.large_orbit import INTERVALS, LargeOrbitProblem
from contin.problems.large_orbits.layout import OnPoints
from contin.problems.large_orbits.radau import STAGES, Trajectory
from contin.systems.away_from_samples import away, on_even_times
from contin.systems.functions.function_system import FunctionSystem

COMPARED: Final = 200  # states of many, by which an orbit is compared with its samples
COLLAPSED: Final = 1e-6  # amplitude, as a part of that of the samples, of an orbit that is an equilibrium


@dataclass(frozen=True, eq=False, repr=False)
class LargeOrbit(Told):
    """An orbit of a large system at fixed parameters: the start of a continuation."""

    problem: LargeOrbitProblem
    z: Array
    remarks: tuple[str, ...] = ()  # about where it comes from: notes of branches that start here

    @property
    def system(self) -> FunctionSystem:
        return self.problem.system

    @property
    def period(self) -> float:
        return float(self.z[-2])

    def seed(self, parameter: str) -> Seed:
        """Where a continuation with this parameter free starts."""
        problem = self.problem.with_active(parameter, self.z)
        return Seed(problem, np.append(self.z[:-1], problem.base[problem.active]), remarks=self.remarks)

    def __str__(self) -> str:
        return f"periodic orbit of period {self.period:.10g}, {self.problem.n} states"


def large_orbit_from_samples(
    system: FunctionSystem, t: Array, u: Array, p: Array, method: str | None = None, intervals: int | None = None
) -> LargeOrbit:
    """The periodic orbit near samples u (K, n) at times t (K,), the last the first again, at parameters p.

    By collocation on `intervals`; with method 'shooting' solved for again, on so many segments.
    Raises NoSolutionError where Newton does not converge, or only to an equilibrium.
    """
    from scipy.interpolate import CubicSpline

    if len(t) < 4 or not np.all(np.diff(t) > 0.0):
        raise InputError("samples of an orbit must be four at least, at increasing times")
    shooting = method == "shooting"
    count = INTERVALS if shooting or intervals is None else intervals
    problem = LargeOrbitProblem(system, p.copy(), 0, OnPoints(count))
    period = float(t[-1] - t[0])
    empty = Trajectory(np.zeros((count, STAGES, 1)), period)
    states = np.asarray(CubicSpline(t, u)(t[0] + period * empty.times[1:]))
    z = problem.vector(Trajectory(states.reshape(count, STAGES, -1), period), float(p[0]))
    found = _solved(problem, z, u)
    if shooting:
        if problem.source.mass is not None:
            raise InputError("orbits of a function with a mass matrix are computed by collocation: leave `method` out")
        problem, moved, _ = problem.relaid(FromStarts(intervals or 1))
        found = _solved(problem, moved(found), u)
    return LargeOrbit(problem, found, _apart(problem, found, t, u))


def _apart(problem: LargeOrbitProblem, z: Array, t: Array, u: Array) -> tuple[str, ...]:
    """A note where the orbit is not near the samples, in some of its states."""
    path, names = problem.profile(z), problem.system.state_names
    some = np.unique(np.linspace(0, u.shape[1] - 1, COMPARED).astype(int))
    samples, solution = on_even_times(t, u[:, some]), on_even_times(path.times, path.u[:, some])
    note = away([names[k] for k in some] if names else (), samples, solution, "closed")
    return (f"{note}. Their period is {float(t[-1] - t[0]):.6g}, its own {path.period:.6g}",) if note else ()


def _solved(problem: LargeOrbitProblem, z: Array, samples: Array) -> Array:
    """The orbit at the parameters of z."""
    value = float(z[-1])
    solved = problem.at_parameter(z, value, problem.initial_scale(z, (value - 0.5, value + 0.5)))
    if solved is None:
        raise NoSolutionError(
            "the samples are not near a periodic orbit at these parameters: Newton does not converge from them. They "
            "must cover one period, the last line the first again; check the parameters they belong to."
        )
    largest = float(np.max(np.ptp(problem.profile(solved).u, axis=0)))
    if not largest > COLLAPSED * float(np.max(np.ptp(samples, axis=0))):
        raise NoSolutionError("the samples lead to an equilibrium, not to an orbit: its amplitude there is too small")
    return solved
