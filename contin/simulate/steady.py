"""When has a trajectory settled? Functions of the state over three successive windows of time, compared.

A steady state here is whatever repeats: an equilibrium, a cycle, two oscillators that beat, also quasiperiodic motion.
It is not decided by waiting a fixed long time: the windows grow with the time that has passed, so that a beating as
slow as may be comes to fit into them, until they agree.

Means are taken with the weight sin^4 over the window. Of an oscillation with N turns in the window such a mean keeps
about 1.3/N^5 of the amplitude (a plain one 1/N), wherever the window begins, so that windows of equal motion agree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.machine import elementary
from contin.simulate.between_samples import resolved
from contin.simulate.extrema import extremes, extremes_between, on_trajectory
from contin.simulate.flight import fly
from contin.simulate.natural import Metric, natural_metric
from contin.simulate.reach import left_reach
from contin.simulate.run import observed, over_time
from contin.systems.steps import iterates

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

STATISTICS: Final = ("min", "mean", "max")
FINEST: Final = 20_000  # samples of the shortest window
WINDOWS: Final = 200.0  # longest time, in windows
GROWTH: Final = 1.25  # of the time between two looks
BEFORE: Final = 0.1  # part of a quantity's largest modulus ever that counts towards its size now
STEADY_NOISE: Final = 1e-2  # (of the tolerance) changes below this have no direction
ESCAPED: Final = 1e12  # natural sizes: a state this large is not one that the model was made for
DECAY: Final = 0.95  # a change that shrinks by less does not tell what is left


@dataclass(frozen=True)
class Criterion:
    """How long to wait, and what counts as settled.

    window : the shortest window of time.  After a time T, at least 4 windows, the second, third and last quarter of T
    are compared: mean and standard deviation of every quantity. tolerance : settled where what is still to change,
    extrapolated from both changes, is less than this (in units of the quantity's largest modulus); changes that grow
    (a state about to be left) settle nothing.  longest : time at which waiting ends, unsettled (default: 200 windows).
    samples : times in the shortest window at which the quantities are evaluated.
    rtol : of the integrator.  box : modulus of a state at which a run has escaped; by default `ESCAPED` natural sizes.
    """

    window: float
    tolerance: float = 1e-4
    longest: float = 0.0
    samples: int = 400
    rtol: float = 1e-8
    box: float | None = None

    def __post_init__(self) -> None:
        if self.longest == 0.0:
            object.__setattr__(self, "longest", WINDOWS * self.window)
        for name in ("window", "tolerance", "longest", "rtol", "box"):
            value = getattr(self, name)
            if value is None and name == "box":
                continue
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{name} must be a positive number; got {value!r}")
        if not 8 <= self.samples <= FINEST:
            raise InputError(f"samples must be a whole number from 8 to {FINEST}; got {self.samples!r}")
        if self.longest < 4.0 * self.window:
            raise InputError(f"longest must be at least four windows ({4.0 * self.window:g}); got {self.longest:g}")


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


def settle(system: CompiledSystem, u: Array, p: Array, criterion: Criterion, metric: Metric | None = None) -> Settled:
    """Integrate (iterate) until the system's observables have settled.

    `system` : compiled, with the quantities to measure as its observables (`contin.simulate.measures`).
    metric : natural sizes; by default those at u.
    """
    u = np.array(u, dtype=float)
    metric = natural_metric(system, u, p) if metric is None else metric
    box = np.full(system.n, criterion.box) if criterion.box is not None else ESCAPED * metric.states
    errors = metric.tolerances(1e-3 * criterion.rtol)
    advance = _iterates(system, p, box) if system.kind == "map" else _flight(system, p, criterion, errors, box)
    quarter = max(round(criterion.window), 8) if system.kind == "map" else criterion.samples
    step = 1.0 if system.kind == "map" else criterion.window / criterion.samples
    most = int(criterion.longest / step * (1.0 + 1e-12))
    so_far = _Samples(np.empty(0), np.empty((0, system.n)), np.empty((0, len(system.observable_names))))
    done, target = 0, 4 * quarter
    while True:
        u, found, end, outcome, why = advance(u, done, target - done)
        so_far = so_far.followed_by(found)
        done = len(so_far.t)
        left = left_reach(system, found.states, over_time(system, p, found.t))
        if outcome == "done" and left is not None:
            outcome, why = "stopped", left[1]
        if outcome != "done":
            return Settled(_summary(so_far.last(max(done // 4, 1))), u, end, outcome, why)
        settled = _has_settled(so_far.values, criterion.tolerance)
        if settled or done >= most:
            last = so_far.last(done // 4)
            seen = None if system.kind == "map" else _seen_between(system, p, last, criterion.rtol, errors)
            how, words = ("settled", "") if settled else ("unsettled", f"not settled at t = {step * done:.6g}")
            return Settled(_summary(last, seen), u, step * done, how, words)
        target = min(int(np.ceil(GROWTH * done)), most)


@dataclass(frozen=True, eq=False)
class _Samples:
    """Times (T,), states (T, n) and values of the observables (T, k)."""

    t: Array
    states: Array
    values: Array

    def followed_by(self, other: _Samples) -> _Samples:
        return _Samples(
            np.concatenate([self.t, other.t]), np.vstack([self.states, other.states]),
            np.vstack([self.values, other.values]),
        )  # fmt: skip

    def last(self, count: int) -> _Samples:
        return _Samples(self.t[-count:], self.states[-count:], self.values[-count:])


Advance = Callable[[Array, int, int], tuple[Array, _Samples, float, str, str]]


def _flight(system: CompiledSystem, p: Array, criterion: Criterion, errors: Array, box: Array) -> Advance:
    """(u, samples so far, samples wanted) -> (u, samples, time, outcome, why) of a flow."""
    step = criterion.window / criterion.samples

    def advance(u: Array, done: int, count: int) -> tuple[Array, _Samples, float, str, str]:
        times = step * np.arange(done + 1.0, done + count + 1.0)
        flight = fly(
            system, u, p, float(times[-1]) - step * done, start=step * done, times=times, rtol=criterion.rtol,
            atol=errors, box=box,
        )  # fmt: skip
        t, states = flight.t, flight.u
        if flight.outcome == "done" and len(t) < count:  # the last time differs from the end by rounding
            t, states = times, np.vstack([states, flight.end[None, : system.n]])
        found = _Samples(t, states, observed(system, states, p, t))
        return flight.end[: system.n].copy(), found, flight.end_time, flight.outcome, flight.why

    return advance


def _iterates(system: CompiledSystem, p: Array, box: Array) -> Advance:
    """The same of a map."""

    def advance(u: Array, done: int, count: int) -> tuple[Array, _Samples, float, str, str]:
        points = iterates(system, u, p, count, box)
        states, taken, how = points[1:], len(points) - 1, ("done", "")
        u = points[-1].copy()
        if not np.all(np.abs(u) <= box):
            taken, how = taken - 1, ("escaped", "left the box")
        t = np.arange(done + 1.0, done + taken + 1.0)
        found = _Samples(t, states[:taken], observed(system, states[:taken], p, t))
        return u, found, float(done + taken + (how[0] != "done")), *how

    return advance


def _has_settled(values: Array, tolerance: float) -> bool:
    """True where the second, third and last quarter of the samples agree, or approach a limit that is near enough."""
    count = len(values) // 4
    windows = values[len(values) - 3 * count :].reshape(3, count, -1)
    if not np.all(np.isfinite(windows)):
        return False
    weights = elementary.pow(elementary.sin(np.pi * (np.arange(count) + 0.5) / count), 4.0)
    weights /= weights.sum()
    means = np.einsum("j,wjk->wk", weights, windows)
    spreads = np.sqrt(np.einsum("j,wjk->wk", weights, elementary.square(windows - means[:, None])))
    moduli = np.ascontiguousarray(np.abs(values).T)
    size = np.maximum(moduli[:, len(values) - 3 * count :].max(axis=1), BEFORE * moduli.max(axis=1))
    size = np.where(size > 0.0, size, 1.0)
    first, second = (
        max(float((np.abs(s[k + 1] - s[k]) / size).max(initial=0.0)) for s in (means, spreads)) for k in (0, 1)
    )
    if max(first, second) <= STEADY_NOISE * tolerance:
        return True
    ratio = second / first if first > 0.0 else np.inf
    return bool(ratio < DECAY and second <= tolerance and second * ratio / (1.0 - ratio) <= tolerance)


def _seen_between(
    system: CompiledSystem, p: Array, last: _Samples, rtol: float, errors: Array
) -> tuple[Array, Array]:
    """Extremes of a flow's observables, (k,) each, between the samples too."""
    t, states = resolved(system, p, last.t, last.states, rtol, errors)
    at = on_trajectory(system, p, t, states, rtol, errors)
    low, high = extremes_between(t, observed(system, states, p, t), at)
    smallest, largest = extremes(last.values)
    return np.minimum(low, smallest), np.maximum(high, largest)


def _summary(samples: _Samples, seen: tuple[Array, Array] | None = None) -> Array:
    """(3, k): smallest value, mean with the weight sin^4, largest value; NaN without values.

    seen : of a flow that came to its end, the extremes between the samples too.
    """
    values = samples.values
    if not len(values):
        return np.full((3, values.shape[1]), np.nan)
    weights = elementary.pow(elementary.sin(np.pi * (np.arange(len(values)) + 0.5) / len(values)), 4.0)
    mean = weights @ values / weights.sum()
    smallest, largest = extremes(values) if seen is None else seen
    return np.array([smallest, mean, largest])


def named_statistics(names: tuple[str, ...], statistics: Array) -> dict[str, float]:
    """{quantity}_{min|mean|max}: value."""
    return {
        f"{name}_{what}": float(statistics[row, k])
        for k, name in enumerate(names)
        for row, what in enumerate(STATISTICS)
    }
