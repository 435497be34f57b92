"""Smallest and largest values of sampled functions; of a flow between its samples too, of a map at its iterates."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.simulate.flight import fly
from contin.simulate.run import observed

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

FINER: Final = 32  # samples between two samples, around an extreme one
ALIKE: Final = 0.5  # second differences of neighbours that differ by less are those of a smooth function


def extremes(values: Array) -> tuple[Array, Array]:
    """Smallest and largest of every column; NaN without rows."""
    if not len(values):
        nothing = np.full(values.shape[1], np.nan)
        return nothing, nothing
    return values.min(axis=0), values.max(axis=0)


def extremes_between(values: Array, around: Callable[[int], Array]) -> tuple[Array, Array]:
    """The same of a function of time: `around(row)` gives values of all columns, finer, between the row's neighbours.

    There the smooth ones take a parabola; what jumps or has a corner takes its largest sample. With 13 samples a turn
    and 32 times as many around the extreme, a sine's error is below 1e-9 of its amplitude.
    """
    smallest, largest = extremes(values)
    finer: dict[int, Array] = {}
    for column in range(values.shape[1]):
        for result, sign in ((smallest, -1.0), (largest, 1.0)):
            row = int(np.argmax(sign * values[:, column]))
            if row not in finer:
                finer[row] = around(row)
            found = sign * finer[row][:, column]
            if len(found) and np.all(np.isfinite(found)):
                result[column] = sign * max(sign * result[column], top(found))
    return smallest, largest


def top(values: Array) -> float:
    """Largest of equally spaced values; between them by a parabola where the second differences say that it is one."""
    best = int(np.argmax(values))
    if not 2 <= best <= len(values) - 3:
        return float(values[best])
    left, bend, right = np.diff(values[best - 2 : best + 3], 2).tolist()
    if not (bend < 0.0 and max(abs(left - bend), abs(right - bend)) < ALIKE * abs(bend)):
        return float(values[best])
    slope = 0.5 * float(values[best + 1] - values[best - 1])
    return float(float(values[best]) - 0.5 * slope * slope / bend)


def trajectory_around(
    system: CompiledSystem, p: Array, t: Array, states: Array, rtol: float, atol: Array
) -> Callable[[int], Array]:
    """`around` for `extremes_between`: the observables on the trajectory through a row's neighbours."""

    def around(row: int) -> Array:
        low, high = max(row - 1, 0), min(row + 1, len(t) - 1)
        times = np.linspace(t[low], t[high], FINER * (high - low) + 1)[1:]
        span = float(t[high] - t[low])
        if not span > 0.0:
            return np.empty((0, len(system.observable_names)))
        flight = fly(system, states[low], p, span, start=float(t[low]), times=times, rtol=rtol, atol=atol)
        return observed(system, flight.u, p, flight.t)

    return around
