"""Where a flow comes to rest, by a linearly implicit method: stiffness costs nothing, slow approaches few steps.

The Rosenbrock pair of order 2(3) of Shampine and Reichelt (The MATLAB ODE suite, SIAM J. Sci. Comput. 18, 1997), which
is L-stable: near a stable equilibrium its steps grow without bound. It is not accurate enough for cycles: a trajectory
that goes on and on uses up its steps, and what is left is a state on or near what attracts it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.machine import elementary
from contin.simulate.natural import natural_metric

if TYPE_CHECKING:
    from contin.systems.protocol import System

STEPS: Final = 1_500
FEWEST: Final = 150
EFFORT: Final = 4e8  # STEPS n^3 is at most this, about
LOOP_STEPS: Final = 6_000  # of a stiff cycle
LOOP_TOLERANCE: Final = 1e-6
NEAR: Final = 3e-2  # part of its extent as close as which a cycle returns
TOLERANCE: Final = 1e-4  # relative error of a step
STILL: Final = 1e-6  # relative change in a step below which nothing moves
CALM: Final = 10  # ... in so many steps in a row, each up to five times as long as the one before
PUSH: Final = 1e-3  # relative, off an equilibrium that is not stable
PUSHES: Final = 2
ESCAPED: Final = 1e9  # natural sizes
_D: Final = 1.0 / (2.0 + np.sqrt(2.0))
_E: Final = 6.0 + np.sqrt(2.0)
Resolvent = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Relaxed:
    """The state after `time`: outcome `rest`, `moving` (its steps are used up), `escaped` or `failed` (not finite)."""

    u: Array
    time: float
    outcome: str
    stable: bool = False
    mean: Array | None = None  # over time, of what still moves


@dataclass(frozen=True, eq=False)
class Rest:
    """An equilibrium: whether it is stable, and the direction (n,) in which states leave it fastest, where known."""

    u: Array
    stable: bool
    fastest: Array | None = None


class Flow(Protocol):
    """M u' = f(u), as the method asks for it; `sizes` (n,) and `time`: natural ones at the start."""

    sizes: Array
    time: float

    def value(self, u: Array) -> Array: ...
    def weigh(self, x: Array) -> Array:
        """M x."""

    def at(self, u: Array) -> tuple[Array, Callable[[float], Resolvent | None]]:
        """f(u), and for a step h the map r -> (M - h f_u)^-1 r, None where there is none."""


class DenseFlow:
    """u' = f(u, p) of a compiled system at fixed p."""

    def __init__(self, system: System, u: Array, p: Array) -> None:
        self.system, self.p = system, p
        metric = natural_metric(system, u, p)
        self.sizes, self.time = metric.states, metric.time

    def value(self, u: Array) -> Array:
        return self.system.value(u, self.p)

    def weigh(self, x: Array) -> Array:
        return x

    def at(self, u: Array) -> tuple[Array, Callable[[float], Resolvent | None]]:
        f, jacobian = self.system.jacobian(u, self.p)
        matrix = jacobian[:, : len(u)]

        def resolvent(h: float) -> Resolvent | None:
            inner = np.eye(len(u)) - h * matrix
            if not np.all(np.isfinite(inner)):
                return None
            try:
                inverse = np.linalg.inv(inner)
            except np.linalg.LinAlgError:  # the step is repeated with a tenth of its length
                return None
            return lambda r: np.asarray(inverse @ r)

        return f, resolvent


def relax(system: System, u: Array, p: Array) -> Relaxed:
    """Follow u' = f(u, p) until it rests; off an equilibrium that is unstable it is pushed twice."""
    steps = int(np.clip(EFFORT / float(system.n * system.n * system.n), FEWEST, STEPS))
    p = np.asarray(p, dtype=float)

    def rest(u: Array) -> Rest:
        values, vectors = np.linalg.eig(system.jacobian(u, p)[1][:, : system.n])
        lead = int(np.argmax(values.real))
        stable = bool(values[lead].real <= STILL * float(np.abs(values).max()))
        return Rest(u, stable, vectors[:, lead].real)

    return to_rest(lambda u: DenseFlow(system, u, p), np.array(u, dtype=float), steps, rest)


def to_rest(flow: Callable[[Array], Flow], u: Array, steps: int, rest: Callable[[Array], Rest | None]) -> Relaxed:
    """Follow a flow from u until it rests; off an equilibrium that is unstable it is pushed twice.

    flow : with natural sizes at a state.  rest : the equilibrium next to where it has come to rest, None without one.
    """
    time, used = 0.0, 0
    for attempt in range(PUSHES + 1):
        end, taken = run(flow(u), u, steps - used)
        time, used = time + end.time, used + taken
        here = rest(end.u) if end.outcome == "rest" else None
        if here is None:
            return Relaxed(end.u, time, end.outcome, mean=end.mean)
        if here.stable or here.fastest is None or attempt == PUSHES:
            return Relaxed(here.u, time, "rest", here.stable)
        size = np.maximum(np.abs(here.u), flow(here.u).sizes)
        u = here.u + PUSH * here.fastest / float(np.max(np.abs(here.fastest) / size))
    raise AssertionError("the last attempt returns")


def stiff_loop(system: System, u: Array, p: Array) -> tuple[Array, Array] | None:
    """Times (K,) and states (K, n) of one turn on a cycle that a stiff flow is on, closed up to the method's error."""
    path: list[tuple[float, Array]] = []
    u, p = np.array(u, dtype=float), np.asarray(p, dtype=float)
    end, _ = run(DenseFlow(system, u, p), u, LOOP_STEPS, LOOP_TOLERANCE, path)
    if end.outcome != "moving" or len(path) < CALM:
        return None
    t, states = np.array([time for time, _ in path]), np.array([state for _, state in path])
    late = states[len(states) // 3 :]
    extent = np.ptp(late, axis=0)
    extent = np.where(extent > 0.0, extent, 1.0)
    for j in np.argsort(-np.ptp(late, axis=0) / np.maximum(np.abs(late).max(axis=0), np.finfo(float).tiny)):
        level = states[:, j] - 0.5 * (late[:, j].min() + late[:, j].max())
        up = np.flatnonzero((level[:-1] < 0.0) & (level[1:] >= 0.0))
        for k in range(1, len(up) // 2 + 1):
            first, last = (_crossing(t, states, level, i) for i in (up[-1 - k], up[-1]))
            if float(np.max(np.abs(last[1] - first[1]) / extent)) < NEAR:
                inside = slice(up[-1 - k] + 1, up[-1] + 1)
                times = np.concatenate([[first[0]], t[inside], [last[0]]])
                return times - times[0], np.vstack([first[1], states[inside], last[1]])
    return None


def _crossing(t: Array, states: Array, level: Array, i: int) -> tuple[float, Array]:
    part = level[i] / (level[i] - level[i + 1])
    return float(t[i] + part * (t[i + 1] - t[i])), states[i] + part * (states[i + 1] - states[i])


def run(
    flow: Flow, u: Array, steps: int, tolerance: float = TOLERANCE, path: list[tuple[float, Array]] | None = None
) -> tuple[Relaxed, int]:
    """Where the flow comes to rest from u, or is after so many steps, and the steps taken; `path` takes the states."""
    n = len(u)
    limit = ESCAPED * np.maximum(flow.sizes, np.abs(u))
    size = np.maximum(np.abs(u), flow.sizes)
    h, time, calm = 1e-3 * flow.time, 0.0, 0
    weighted, weight = np.zeros(n), 0.0
    here = flow.at(u)
    for taken in range(steps):
        trial = _step(flow, u, h, *here)
        error = np.inf if trial is None else float(np.max(np.abs(trial[1]) / np.maximum(size, np.abs(trial[0]))))
        if not error <= tolerance:  # NaN is caught too
            h *= 0.1 if not np.isfinite(error) else max(0.2, 0.8 * elementary.pow(tolerance / error, 1.0 / 3.0))
            if h <= 1e-14 * max(time, flow.time):
                return Relaxed(u, time, "failed"), taken
            continue
        assert trial is not None
        change = float(np.max(np.abs(trial[0] - u) / size))
        if 2 * taken > steps:  # what lies before is transient
            weighted, weight = weighted + h * trial[0], weight + h
        u, time = trial[0], time + h
        if path is not None:
            path.append((time, u))
        size = np.maximum(size, np.abs(u))
        if np.any(np.abs(u) > limit):
            return Relaxed(u, time, "escaped"), taken
        calm = calm + 1 if change < STILL else 0
        if calm >= CALM:
            return Relaxed(u, time, "rest"), taken
        h *= min(5.0, 0.8 * elementary.pow(tolerance / max(error, 1e-300), 1.0 / 3.0))
        here = flow.at(u)
    return Relaxed(u, time, "moving", mean=weighted / weight if weight > 0.0 else None), steps


def _step(
    flow: Flow, u: Array, h: float, f: Array, resolvents: Callable[[float], Resolvent | None]
) -> tuple[Array, Array] | None:
    """(state, estimated error) after a step; None where the linear systems or the equations fail."""
    solve = resolvents(h * _D) if np.all(np.isfinite(f)) else None
    if solve is None:
        return None
    k1 = solve(f)
    f1 = flow.value(u + 0.5 * h * k1)
    k2 = solve(f1 - flow.weigh(k1)) + k1
    after = u + h * k2
    f2 = flow.value(after)
    k3 = solve(f2 - _E * (flow.weigh(k2) - f1) - 2.0 * (flow.weigh(k1) - f))
    return (after, h / 6.0 * (k1 - 2.0 * k2 + k3)) if np.all(np.isfinite(after)) else None
