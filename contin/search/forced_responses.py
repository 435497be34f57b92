"""Periodic responses of a forced flow: what its one-parameter diagrams start from, as others do from equilibria."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError, NotFiniteError
from contin.model.evaluate import evaluate
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.search.orbit_from_samples import orbit_from_samples
from contin.search.shot_orbit import ShotOrbit, orbit_from_return, settled_orbit, shooting_chosen
from contin.simulate.trajectory import integrate

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

SAMPLES: Final = 200  # of one forcing period of a trajectory
LONG: Final = 50  # forcing periods over which a trajectory's mean is taken
STEPS: Final = 200_000  # ... that it may take

Response = PeriodicOrbit | ShotOrbit


def response(system: CompiledSystem, u: Array, p: Array, periods: Array) -> Response:
    """The response that the trajectory from u settles on; where it settles on none, one of the forcing's own period.

    Newton looks for the latter from one forcing period of the trajectory, from the state u held, and from the
    trajectory's mean held: so responses are found beside chaos, and where nothing is damped.

    Raises NoSolutionError, or NotFiniteError, as the trajectory does, where Newton finds none either.
    """
    try:
        return settled_orbit(system, u, p, periods)
    except (NoSolutionError, NotFiniteError) as error:
        found = _of_one_period(system, u, p, periods)
        if found is None:
            kind = NotFiniteError if isinstance(error, NotFiniteError) else NoSolutionError
            raise kind(f"{error} Newton finds no response of the forcing's own period from there either.") from None
        return found


def _of_one_period(system: CompiledSystem, u: Array, p: Array, periods: Array) -> Response | None:
    period = float(evaluate(system.forcing_period, dict(zip(system.parameter_names, p, strict=True))))
    times = np.linspace(0.0, period, SAMPLES + 1)
    for states in _guesses(system, u, p, times):
        # one of several guesses; where all fail, that is said
        with suppress(NoSolutionError, NotFiniteError, np.linalg.LinAlgError):  # ... by the caller
            if shooting_chosen(system, None):
                return orbit_from_return(system, states[0], p, periods, period, 1, None)
            return orbit_from_samples(system, times, states, p, periods)
    return None


def _guesses(system: CompiledSystem, u: Array, p: Array, times: Array) -> Iterator[Array]:
    """States (times, n) over one forcing period."""
    with suppress(NotFiniteError):  # one guess less
        yield np.asarray(integrate(system, u, p, float(times[-1]), times=times, budget=STEPS).u)
    yield np.tile(u, (len(times), 1))
    with suppress(NotFiniteError):  # one guess less
        long = np.linspace(0.0, LONG * times[-1], LONG * 20)
        path = integrate(system, u, p, float(long[-1]), times=long, budget=STEPS)
        yield np.tile(path.u.mean(axis=0), (len(times), 1))
