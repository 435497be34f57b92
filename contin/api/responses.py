"""What diagrams start from: equilibria, or the periodic responses of a forced flow, which has none."""

from __future__ import annotations

from contextlib import suppress
from typing import Any, Final

import numpy as np

from contin.api.machine_code import compiled
from contin.api.starts import equilibrium, reach_of
from contin.bvp.start import boundary_guess
from contin.continuation.departure import Seed
from contin.diagram.orbits import known_orbit
from contin.errors import ContinError
from contin.problems.deflation import make_box
from contin.problems.responses import Response, response
from contin.records import Record

SCATTERED: Final = 12  # trajectories at each value of the parameter


def solution(model: Any, start: Any, parameters: Record | None) -> Any:
    """An equilibrium; of a forced flow the periodic response that its trajectory settles on.

    Raises as `contin.equilibrium` and `contin.problems.responses.response` do.
    """
    if getattr(model, "interval", None) is not None:
        return boundary_guess(model, start, parameters)
    if getattr(model, "forcing", None) is None:
        return equilibrium(model, start, parameters)
    u, p = model.start_point(start, dict(parameters or {}))
    return response(compiled(model), u, p, np.asarray(model.periods(), dtype=float))


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
