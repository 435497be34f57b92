"""How large each state is among points that are known: the metric in which a diagram compares states and orbits.

A distance is that many sizes, state by state, so that a state of order 1e-9 counts beside one of order 1e3.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.simulate.natural import natural_metric

if TYPE_CHECKING:
    from contin.problems.contracts import InOneParameter

PLAIN: Final = 1e-6  # of the largest state: what is larger than this is no rounding error


def sizes_among(problem: InOneParameter, points: Sequence[Array], value: float) -> Array:
    """Size of each state (n,), all positive, among `points`, each (n,) or (k, n), at a value of the free parameter.

    The largest modulus; an angle's period / (2 pi). Where that is next to nothing beside the other states, the natural
    metric decides whether it is a small unit, or a zero with rounding errors, and how large the state would be.
    """
    system = problem.system
    n = int(system.n)
    rows = np.concatenate([np.zeros((1, n)), *(np.reshape(u, (-1, n)) for u in points)])
    p = np.array(problem.base, dtype=float)
    p[problem.active] = value
    periods = np.asarray(system.model.periods(dict(zip(system.parameter_names, p[: system.m].tolist(), strict=True))))
    largest = np.abs(rows).max(axis=0)
    angles = periods > 0.0
    if np.any((largest <= PLAIN * largest.max()) & ~angles):
        at = np.ascontiguousarray(rows[min(1, len(rows) - 1)])
        largest = natural_metric(system, at, p[: system.m], largest).states
    return np.asarray(np.where(angles, periods / (2.0 * np.pi), largest))


def length(difference: Array, sizes: Array) -> float:
    """The largest component of a difference (..., n) in the metric."""
    return float(np.max(np.abs(difference) / sizes, initial=0.0))
