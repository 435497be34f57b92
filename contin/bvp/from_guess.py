"""From a guess to a solution of a boundary-value problem at fixed parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.defects import resolving
from contin.bvp.kernel_at_branch_point import undetermined
from contin.bvp.sizes import largest
from contin.bvp.solutions_at_parameter import at_parameter_from_afar
from contin.bvp.two_point import TwoPoint, two_point
from contin.continuation.seed import Seed
from contin.errors import InputError, NoSolutionError
from contin.model.model import Model
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile, make_scale, node_times
from contin.systems.away_from_samples import PLACES, away, on_even_times

MESHES = (20, 40, 80, 160)  # intervals of the first mesh: as many as the guess needs, ...
RESOLVED = 0.02  # ... which is met to this part of its sizes
SAMPLED = 1281  # points at which the formulas of a guess are evaluated
ROUNDS = 6  # of meshes
ROUNDING = 1e-10  # part of the size of a function below which it is what remains of a zero


@dataclass(frozen=True, eq=False)
class BoundaryGuess:
    """A guess of the solution of `model`: functions of the independent variable at `times` (K,), values (K, n_states).

    p : all parameter values by name. It becomes a solution when a continuation says which parameter varies.
    """

    model: Model
    times: Array
    states: Array
    p: Mapping[str, float]
    free: tuple[str, ...]
    sampled: bool = False  # the states are samples, which the solution is to be near

    @property
    def system(self) -> Model:
        """Whose `parameter_names` a continuation may vary."""
        return self.model

    def seed(self, parameter: str) -> Seed:
        """The solution next to the guess, on a mesh that resolves it. NoSolutionError where Newton fails."""
        if parameter in self.free:
            raise InputError(f"{parameter} is solved for (`free`), and cannot vary too")
        two = two_point(self.model, self.free)
        base = np.array([self.p[name] for name in two.parameters])
        problem = BoundaryProblem(two, base, two.parameters.index(parameter))
        z = solved(problem, self._profile(two, problem))
        return Seed(problem, z, remarks=self._apart(problem.profile(z)))

    def _apart(self, found: Profile) -> tuple[str, ...]:
        """A note where the solution is not near the samples."""
        if not self.sampled:
            return ()
        solution = found.at(np.linspace(0.0, 1.0, PLACES))[:, : self.states.shape[1]]
        note = away(self.model.state_names, on_even_times(self.times, self.states), solution)
        return (note,) if note else ()

    def _profile(self, two: TwoPoint, problem: BoundaryProblem) -> Profile:
        """The guess on an even mesh fine enough for it, with constant free parameters and zero integrals."""
        span = self.times[-1] - self.times[0]
        places = (self.times - self.times[0]) / span
        size = np.abs(self.states).max(axis=0)
        for intervals in MESHES:
            found = self._on_even_mesh(two, problem, intervals)
            off = np.abs(found.at(places)[:, : two.n_states] - self.states).max(axis=0)
            if np.all(off <= RESOLVED * size):
                break
        return found

    def _on_even_mesh(self, two: TwoPoint, problem: BoundaryProblem, intervals: int) -> Profile:
        even, value = np.full(intervals, 1.0 / intervals), float(problem.base[problem.active])
        coarse = Profile(problem.points, np.zeros((intervals * problem.points + 1, two.n)), 1.0, even, value)
        h = problem.laid(even, coarse)
        s = node_times(h, problem.points)
        u = np.zeros((len(s), two.n))
        span = self.times[-1] - self.times[0]
        places = self.times[0] + span * s
        for k in range(two.n_states):
            u[:, k] = np.interp(places, self.times, self.states[:, k])
        for k, name in enumerate(two.free):
            u[:, two.n_states + k] = self.p[name]
        return Profile(problem.points, u, 1.0, h, value)


def boundary_guess(
    model: Model, start: Any = None, parameters: Mapping[str, Any] | None = None, free: Sequence[str] = (),
    samples: tuple[Array, Array] | None = None,
) -> BoundaryGuess:  # fmt: skip
    """A guess from a named start or mapping (formulas in the independent variable), or from samples (times, states)."""
    if model.interval is None:
        raise InputError(f"model {model.name!r} is of kind {model.kind!r}, not a boundary-value problem (kind: bvp)")
    unknown = [name for name in free if name not in model.parameter_names]
    if unknown:
        raise InputError(f"free: {model.name} has no parameter {unknown[0]!r}")
    p, times, states = model.start_functions(start, parameters, SAMPLED)
    if samples is not None:
        times, states = samples
    if not np.all(np.isfinite(states)):
        raise InputError(f"model {model.name}, start: a state's formula is not finite on the interval")
    return BoundaryGuess(model, times, states, p, tuple(free), samples is not None)


def _advice(problem: BoundaryProblem, z: Array) -> str:
    """What to try where no solution was found from the guess z."""
    loose = undetermined(problem, z)
    if loose:
        return f"{loose} Conditions may depend on each other."
    return (
        f"Start from formulas in {_time(problem)} closer to the solution, or at another parameter value. "
        f"{problem.trouble(z)}"
    )


def solved(problem: BoundaryProblem, guess: Profile) -> Array:
    """z of the solution next to a guess, the mesh adapted until it resolves it."""
    profile = guess
    for _ in range(ROUNDS):
        z = profile.vector()
        sizes = problem.natural_sizes(z, profile, abs(profile.parameter) or 1.0)
        scale = make_scale(profile.h, problem.points, sizes, 1.0, 1.0)
        found = problem.at_parameter(z, profile.parameter, scale)
        if found is None:
            found = at_parameter_from_afar(problem, z, profile.parameter, scale)
        if found is None:
            raise NoSolutionError(
                f"no solution of {problem.two.model.name} found from the start at {problem.parameters[0]} = "
                f"{profile.parameter:.10g}: Newton's method does not converge. {_advice(problem, z)}"
            )
        profile = _without_rounding(problem.profile(found), sizes)
        found = profile.vector()
        sizes = np.maximum(largest(problem, profile), 1e-9 * sizes)
        mesh = choose_mesh(profile, sizes, problem.tolerance, problem.intervals, closed=False)
        h = problem.laid(mesh.h, profile)
        if problem.intervals is None:  # (functions that are zero but for rounding have their natural size)
            natural = problem.natural_sizes(found, profile, abs(profile.parameter) or 1.0)
            h = resolving(problem, profile, h, np.maximum(sizes, natural))
        if len(h) == profile.intervals and np.allclose(h, profile.h, rtol=0.2):
            return found
        profile = profile.on_mesh(h)
    last = problem.at_parameter(profile.vector(), profile.parameter, _unit(problem, profile))
    return profile.vector() if last is None else last


def _without_rounding(profile: Profile, sizes: Array) -> Profile:
    """The solution with zeros in place of functions that Newton's method has left at rounding of their size."""
    left = np.abs(profile.u).max(axis=0) <= ROUNDING * sizes
    return replace(profile, u=np.where(left, 0.0, profile.u))


def _unit(problem: BoundaryProblem, profile: Profile) -> Array:
    sizes = problem.natural_sizes(profile.vector(), profile, 1.0)
    return make_scale(profile.h, problem.points, sizes, 1.0, 1.0)


def _time(problem: BoundaryProblem) -> str:
    interval = problem.two.model.interval
    return "t" if interval is None else interval.name
