"""Times to look at a trajectory: samples, and parts of the integrator's steps where it does more than they see.

Relaxation oscillations spike within a part of a sample: the largest of their samples says little of their height.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.simulate.flight import BUDGET, DONE, fly

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

DENSE: Final = 2  # steps between two samples, beyond which these are too few
PARTS: Final = 8  # looks within a step; in one of DOP853's there is less than a sixth of a turn
MOST: Final = 20_000  # steps of which the times are kept: the last ones, about


def resolved(
    system: CompiledSystem, p: Array, t: Array, states: Array, rtol: float, atol: Array
) -> tuple[Array, Array]:
    """Times (T,) and states (T, n) up to the last sample: the samples, and more where they are too few.

    t (K,), states (K, n) : samples of a trajectory of a flow. From one of them it is integrated again.
    """
    span = float(t[-1] - t[0]) if len(t) > 1 else 0.0
    if not span > 0.0:
        return t, states
    ends, few = [float(t[0])], DENSE * len(t)
    flight = fly(system, states[0], p, span, start=float(t[0]), rtol=rtol, atol=atol, steps=ends, budget=few)
    if flight.outcome != DONE:
        taken = fly(system, states[0], p, span, start=float(t[0]), rtol=rtol, atol=atol).steps
        first = max(len(t) - 2 - len(t) * MOST // taken, 0) if taken > few else 0
        t, states = t[first:], states[first:]
        span = float(t[-1] - t[0])
        ends = ends_of_steps(system, states[0], p, span, start=float(t[0]), rtol=rtol, atol=atol).tolist()
    times = resolving(t, np.unique(ends))
    if times is t:
        return t, states
    flight = fly(system, states[0], p, span, start=float(t[0]), times=times, rtol=rtol, atol=atol)
    return (flight.t, flight.u) if flight.outcome == DONE and len(flight.t) else (t, states)


def ends_of_steps(
    system: CompiledSystem, u: Array, p: Array, span: float, *, rtol: float, atol: Array, start: float = 0.0,
    budget: int = BUDGET,
) -> Array:  # fmt: skip
    """The times at which the steps begin and end of the integration from u over `span`."""
    ends: list[float] = [start]
    fly(system, u, p, span, start=start, rtol=rtol, atol=atol, budget=budget, steps=ends)
    return np.unique(ends)


def resolving(times: Array, ends: Array, parts: int = PARTS) -> Array:
    """The times t (K,), and equal parts of every step where more than DENSE of them end between two of these.

    Returns t itself where that is so nowhere.
    """
    between = np.diff(np.searchsorted(ends, times))
    crowded = np.append(between > DENSE, False)
    if not crowded.any():
        return times
    inside = in_parts(ends, parts)
    place = np.searchsorted(times, inside, side="right") - 1
    return np.union1d(times, inside[(place >= 0) & crowded[place]])


def in_parts(ends: Array, parts: int) -> Array:
    """Equal parts of steps that begin and end at `ends`."""
    inside = ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(parts) / parts)
    return np.append(inside.ravel(), ends[-1])
