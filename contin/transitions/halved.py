"""From doubled orbits back: the family of half the period, at the period doubling where the doubled orbits end."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.errors import NoSolutionError
from contin.problems.hybrid.hybrid_orbits import HybridOrbits
from contin.problems.maps.cycle import CycleProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.search.orbit_from_samples import orbit_from_samples
from contin.search.shot_orbit import orbit_from_return
from contin.systems.iterate import iterate

if TYPE_CHECKING:
    from contin.problems.shooting.shot_orbits import ShootingProblem

SAMPLES: Final = 400  # of half the orbit


def halved(problem: OrbitProblem | ShootingProblem | HybridOrbits | CycleProblem, z: Array) -> Seed:
    """A start on the family of half the period at the orbit (or cycle of a map) z, which runs through one twice.

    Raises NoSolutionError where Newton does not find that one.
    """
    if isinstance(problem, CycleProblem):
        return _half_a_cycle(problem, z)
    if isinstance(problem, HybridOrbits):
        return Seed(problem.halved(), z)
    profile, system = problem.profile(z), problem.system
    p = problem.full_parameters(z[~np.isnan(z)])[: len(problem.base)]
    s = np.linspace(0.0, 0.5, SAMPLES + 1)
    if isinstance(problem, OrbitProblem):  # its own times are dense where the orbit is steep
        s = np.unique(np.concatenate([s, profile.times[profile.times < 0.5]]))
    states = profile.at(s)
    if isinstance(problem, OrbitProblem):
        periods = np.asarray(system.model.periods())
        try:
            orbit: Any = orbit_from_samples(system, s * profile.period, states, p, periods)
        except NoSolutionError as error:  # what it says of samples is for users who give some
            raise NoSolutionError(
                "the orbits end in a family of half their period, which Newton's method does not find from the last of "
                "them: start it from a simulation beside it (`as: orbit`)"
            ) from error
    else:
        multiple = max(problem.multiple // 2, 1)
        periods = np.asarray(system.model.periods())
        orbit = orbit_from_return(system, states[0], p, periods, 0.5 * profile.period, multiple, None)
    seed: Seed = orbit.seed(problem.parameters[0])
    return seed


def _half_a_cycle(problem: CycleProblem, z: Array) -> Seed:
    """The same points, once: they solve the equations of the shorter cycle as they are."""
    system, times = problem.system.base, problem.period // 2
    inner = replace(problem.inner, system=iterate(system, times))
    if times == 1:
        return Seed(inner, problem.first(z))
    return Seed(CycleProblem(inner), np.append(z[: times * problem.n], z[-1]))
