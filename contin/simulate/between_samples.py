"""A sampled trajectory again, as finely as the integrator's own steps, where it does more than the samples see.

Relaxation oscillations spike within a part of a sample: the largest of their samples says little of their height.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.simulate.flight import DONE, fly

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

DENSE: Final = 2  # steps a sample, from which samples are too few
PARTS: Final = 8  # looks within a step; in one of DOP853's there is less than a sixth of a turn
MOST: Final = 20_000  # steps of which the times are kept: the last ones, about


def resolved(
    system: CompiledSystem, p: Array, t: Array, states: Array, rtol: float, atol: Array
) -> tuple[Array, Array]:
    """Times (T,) and states (T, n) up to the last sample: the samples, or more at the end where they are too few.

    t (K,), states (K, n) : samples of a trajectory of a flow. From one of them it is integrated again.
    """
    span = float(t[-1] - t[0]) if len(t) > 1 else 0.0
    if not span > 0.0:
        return t, states
    taken = fly(system, states[0], p, span, start=float(t[0]), rtol=rtol, atol=atol).steps
    if taken <= DENSE * len(t):
        return t, states
    first = max(len(t) - 2 - len(t) * MOST // taken, 0)
    t, states = t[first:], states[first:]
    span = float(t[-1] - t[0])
    ends: list[float] = [float(t[0])]
    fly(system, states[0], p, span, start=float(t[0]), rtol=rtol, atol=atol, steps=ends)
    steps = np.unique(ends)
    parts = np.arange(PARTS) / PARTS
    times = np.append((steps[:-1, None] + np.diff(steps)[:, None] * parts).ravel(), steps[-1])[1:]
    flight = fly(system, states[0], p, span, start=float(t[0]), times=times, rtol=rtol, atol=atol)
    return (flight.t, flight.u) if flight.outcome == DONE and len(flight.t) else (t, states)
