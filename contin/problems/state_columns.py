"""Columns that every branch of states has: the states by name, and the model's observables."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.systems.protocol import System


def state_columns(system: System, u: Array, parameters: Callable[[], Array]) -> dict[str, Array]:
    """Of rows u (m, n); `parameters` gives all parameter values of each (m, p), where observables need them."""
    columns = {name: u[:, k].copy() for k, name in enumerate(system.state_names)}
    if system.observable_names:
        recorded = system.observables(np.ascontiguousarray(u), parameters())
        columns |= {name: recorded[:, k].copy() for k, name in enumerate(system.observable_names)}
    return columns
