"""The periodic responses of a forced flow, from which its diagrams start: it has no equilibria."""

from __future__ import annotations

from contextlib import suppress
from typing import Any, Final

import numpy as np

from contin.api.machine_code import compiled
from contin.api.searches import reach_of
from contin.continuation.seed import Seed
from contin.diagram.orbits import known_orbit
from contin.errors import ContinError
from contin.search.equilibria_in_box import make_box
from contin.search.forced_responses import Response, response

SCATTERED: Final = 12  # trajectories at each value of the parameter


def responses_in(model: Any, parameter: str, values: list[float], box: Any, parameters: Any) -> list[Seed]:
    """Seeds of the different responses on which trajectories from all over the box settle, at these values.

    box : as of `contin.find_equilibria`.
    """
    system, seeds = compiled(model), []
    periods = np.asarray(model.periods(dict(parameters or {})), dtype=float)
    wanted = make_box(system.state_names, box if box is not None else reach_of(model, parameters), periods)
    for value in values:
        _, p = model.start_point(None, {**(parameters or {}), parameter: value})
        found: list[tuple[Any, Any]] = []
        for u in wanted.starts(SCATTERED):
            with suppress(ContinError, np.linalg.LinAlgError):  # one of many trajectories: it may escape
                reached: Response = response(system, u, p, periods)
                seed = reached.seed(parameter)
                if known_orbit(seed.problem, seed.z, found) is None:
                    found.append((seed.problem, seed.z))
                    seeds.append(seed)
    return seeds
