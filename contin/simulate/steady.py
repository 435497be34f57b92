"""When has a trajectory settled? Functions of the state over two successive windows of time, compared.

A steady state here is whatever repeats: an equilibrium, a cycle, a beating of two oscillators, provided the window is
longer than a few of its periods. It is not decided by waiting a fixed long time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.simulate.flight import fly
from contin.simulate.run import observed

STATISTICS: Final = ("min", "mean", "max")
FINEST: Final = 20_000  # samples of a window


@dataclass(frozen=True)
class Criterion:
    """How long to wait, and what counts as settled.

    window : time over which minima, means and maxima are taken.  tolerance : they differ by less than this (times the
    size of the quantity) between two successive windows.  longest : time at which waiting ends, unsettled.
    samples : times a window at which the quantities are evaluated.
    """

    window: float
    tolerance: float = 1e-3
    longest: float = 1e4
    samples: int = 400
    rtol: float = 1e-8
    box: float = 1e6

    def __post_init__(self) -> None:
        for name in ("window", "tolerance", "longest", "rtol", "box"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{name} must be a positive number; got {value!r}")
        if not 8 <= self.samples <= FINEST:
            raise InputError(f"samples must be a whole number from 8 to {FINEST}; got {self.samples!r}")
        if self.longest < 2.0 * self.window:
            raise InputError(f"longest must be at least two windows ({2.0 * self.window:g}); got {self.longest:g}")


@dataclass(frozen=True, eq=False)
class Settled:
    """Statistics (3, k): min, mean, max of each quantity over the last window, the state then, and the outcome.

    outcome : settled, unsettled (the longest time is over), escaped, sliding or stopped; `why` in words.
    """

    statistics: Array
    u: Array
    time: float
    outcome: str
    why: str = ""


def settle(system: Any, u: Array, p: Array, criterion: Criterion) -> Settled:
    """Integrate until the system's observables have settled.

    A compiled system whose model's observables are the quantities to watch (`contin.simulate.scan` makes one).
    """
    u, time, before = np.array(u, dtype=float), 0.0, None
    statistics = np.full((3, len(system.observable_names)), np.nan)
    if system.kind == "map":
        return _settle_map(system, u, p, criterion)
    atol = 1e-3 * criterion.rtol
    step = criterion.window / criterion.samples
    while time + criterion.window <= criterion.longest * (1.0 + 1e-12):
        times = time + step * np.arange(1.0, criterion.samples + 1.0)
        flight = fly(
            system, u, p, criterion.window, start=time, times=times, rtol=criterion.rtol, atol=atol, box=criterion.box
        )
        if flight.outcome != "done":
            return Settled(statistics, flight.end[: system.n], flight.end_time, flight.outcome, flight.why)
        u, time = flight.end[: system.n].copy(), time + criterion.window
        statistics = _statistics(observed(system, flight.u, p, flight.t))
        if before is not None and _alike(before, statistics, criterion.tolerance):
            return Settled(statistics, u, time, "settled")
        before = statistics
    return Settled(statistics, u, time, "unsettled", f"not settled at t = {time:.6g}")


def _settle_map(system: Any, u: Array, p: Array, criterion: Criterion) -> Settled:
    """The same for a map: a window of `window` iterates."""
    count, time, before = max(round(criterion.window), 8), 0, None
    statistics = np.full((3, len(system.observable_names)), np.nan)
    while time + count <= criterion.longest:
        states = np.empty((count, system.n))
        for k in range(count):
            u = system.value(u, p)
            if not np.all(np.abs(u) <= criterion.box):
                return Settled(statistics, u, float(time + k), "escaped", "left the box")
            states[k] = u
        time += count
        statistics = _statistics(observed(system, states, p, np.arange(count, dtype=float)))
        if before is not None and _alike(before, statistics, criterion.tolerance):
            return Settled(statistics, u, float(time), "settled")
        before = statistics
    return Settled(statistics, u, float(time), "unsettled", f"not settled after {time} iterates")


def _statistics(values: Array) -> Array:
    return np.array([values.min(axis=0), values.mean(axis=0), values.max(axis=0)])


def _alike(a: Array, b: Array, tolerance: float) -> bool:
    """True where no statistic moved by more than tolerance, in units of each quantity's largest modulus (or 1)."""
    size = np.maximum(np.maximum(np.abs(a).max(axis=0), np.abs(b).max(axis=0)), 1e-3)
    return bool(np.all(np.abs(a - b) <= tolerance * size))


def named_statistics(names: tuple[str, ...], statistics: Array) -> dict[str, float]:
    """{quantity}_{min|mean|max}: value."""
    return {
        f"{name}_{what}": float(statistics[row, k])
        for k, name in enumerate(names)
        for row, what in enumerate(STATISTICS)
    }


def watching(model: Any, measures: Mapping[str, str | Any] | None) -> Any:
    """The model with the quantities to watch as its observables.

    By default: for oscillators declared under `averaging` their amplitudes r1, r2, .. and the cosines c12, .. of their
    phase differences; otherwise states and observables.
    """
    from contin.model.expression import Expression, symbol

    if measures:
        chosen = {name: e if isinstance(e, Expression) else model.expression(str(e)) for name, e in measures.items()}
    elif model.averaging is not None:
        chosen = _of_oscillators(model)
    else:
        chosen = {name: symbol(name) for name in model.state_names} | dict(model.observables)
    return model.replace(observables=chosen)


def _of_oscillators(model: Any) -> dict[str, Any]:
    pairs = [(o.position, o.velocity) for o in model.averaging.oscillators]
    amplitudes = {f"r{k + 1}": model.expression(f"sqrt({x}^2 + {y}^2)") for k, (x, y) in enumerate(pairs)}
    cosines = {}
    x1, y1 = pairs[0]
    for k, (x, y) in enumerate(pairs[1:], 2):
        product = f"sqrt(({x1}^2 + {y1}^2)*({x}^2 + {y}^2)) + 1e-12"
        cosines[f"c1{k}"] = model.expression(f"({x1}*{x} + {y1}*{y})/({product})")
    return amplitudes | cosines
