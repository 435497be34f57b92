"""The solution that a run starts from by default: an equilibrium, or for other kinds of models their own solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.api.fixed_totals import for_branches, is_auto, named_start
from contin.api.machine_code import compiled
from contin.api.starts import equilibrium
from contin.lazy import module
from contin.records import Record


def solution(model: Any, start: Any, parameters: Record | None) -> Any:
    """An equilibrium; of a forced flow the periodic response that its trajectory settles on.

    Raises as `contin.equilibrium` and `contin.search.forced_responses.response` do.
    """
    if is_auto(model, start):
        return module("auto start").find_start(model, parameters)
    if getattr(model, "interval", None) is not None:
        return module("boundary").boundary_guess(model, start, parameters)
    if getattr(model, "forcing", None) is None:
        return equilibrium(model, start, parameters)
    start, model = named_start(model, start), for_branches(model)
    u, p = model.start_point(start, dict(parameters or {}))
    return module("responses").response(compiled(model), u, p, np.asarray(model.periods(), dtype=float))
