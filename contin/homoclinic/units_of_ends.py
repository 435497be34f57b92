"""Natural sizes of the states between both ends of a connecting orbit, in which its distances are measured."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.problems.orbits.rests_and_cycles import Cycle, Rest

LEAST: Final = 1e-3  # of what the other states move a state by
EVERY: Final = 40  # of a cycle's states, one at which the equations are asked


def units_between(first: Rest | Cycle, last: Rest | Cycle, further: Array | None = None) -> Array:
    """(n,) extents of both ends, and of `further` states, up to powers of 2 (whose products are exact).

    A state that is the same at both ends counts as far as the others move it in a turn of the cycle, or in its own
    time: |f_u| takes their sizes to its size, so that the answer has every state's own unit.
    """
    ends = [end.u[None] if isinstance(end, Rest) else end.states for end in (first, last)]
    seen = np.vstack([*ends, *([] if further is None else [further])])
    sizes = np.ptp(seen, axis=0)
    clock = max(end.period for end in (first, last) if isinstance(end, Cycle))
    moved = _moved(first, np.vstack([end[::EVERY] for end in ends]), clock)
    for _ in sizes:
        sizes = np.maximum(sizes, LEAST * np.max(moved * sizes, axis=1))
    sizes = np.where(sizes > 0.0, sizes, LEAST * float(sizes.max()))  # what nothing moves
    return np.asarray(np.ldexp(1.0, np.frexp(sizes)[1]))


def _moved(end: Rest | Cycle, states: Array, clock: float) -> Array:
    """How far a state is moved by another one of size 1, (n, n)."""
    system, p = end.system, end.p
    whole = system.jacobians(np.ascontiguousarray(states), np.tile(p, (len(states), 1)))[1]
    largest = np.abs(np.asarray(whole)[:, :, : system.n]).max(axis=0)
    own = np.diag(largest).copy()
    np.fill_diagonal(largest, 0.0)
    return np.asarray(largest * np.minimum(clock, 1.0 / np.maximum(own, 1.0 / clock))[:, None])
