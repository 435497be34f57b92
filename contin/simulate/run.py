"""Simulation of a model from a start: trajectories of flows, stiff or not, and iterates of maps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.simulate.flight import DONE, fly

STIFF: Final = ("Radau", "LSODA", "BDF")
METHODS: Final = ("DOP853", *STIFF)
RTOL: Final = 1e-9
SAMPLES: Final = 5000  # so that fast oscillations are drawn as curves
BUDGET: Final = 1_000_000  # steps; more are a sign of a stiff model
LONGEST_MAP: Final = 10_000_000


@dataclass(frozen=True, eq=False)
class Simulation:
    """States (T, n) and observables (T, k) at times t (T,).

    outcome : done, escaped (from the box), sliding or stopped; `why` in words, `end_time` when. `crossings` counts the
    switching surfaces crossed, `steps` the integrator's steps.
    """

    model: Any
    method: str
    p: Array
    t: Array
    states: Array
    observables: Array
    end_time: float
    steps: int
    crossings: int
    outcome: str
    why: str

    @property
    def complete(self) -> bool:
        return self.outcome == DONE

    @property
    def columns(self) -> dict[str, Array]:
        """t, every state, every observable."""
        columns = {"t": self.t}
        columns.update(zip(self.model.state_names, self.states.T, strict=True))
        columns.update(zip(self.model.observables, self.observables.T, strict=True))
        return columns

    def __str__(self) -> str:
        if not self.complete:
            return f"stopped at t = {self.end_time:.6g}: {self.why}"
        crossed = f", {self.crossings} switching surfaces crossed" if self.crossings else ""
        return f"{self.method}: {self.steps} steps to t = {self.end_time:.6g}{crossed}"


def simulate(
    model: Any, start: str | Mapping[str, Any] | None = None, parameters: Mapping[str, Any] | None = None, *,
    time: float = 100.0, transient: float = 0.0, samples: int = SAMPLES, method: str = "DOP853", rtol: float = RTOL,
    atol: float | None = None, box: float = 1e100, budget: int = BUDGET,
) -> Simulation:  # fmt: skip
    """Integrate a model (iterate a map) from a start over `time`, after a `transient` that is not kept.

    start : a named start, a mapping of states, or None for the states' values.  samples : equally spaced times that the
    solution is kept at; a map keeps every iterate.
    method : DOP853 (compiled; piecewise-smooth flows piece by piece), or for stiff flows Radau, LSODA, BDF (scipy, with
    the compiled equations and Jacobian).  rtol, atol : tolerances (atol: 1e-3 rtol by default).
    box : modulus of a state at which the simulation ends as escaped.  budget : most steps of the integrator.

    A solution that blows up, escapes or slides gives the part before, with `outcome` and `why`. Raises InputError.
    """
    if method not in METHODS:
        raise InputError(f"method must be one of {', '.join(METHODS)}; got {method!r}")
    for name, value in (("time", time), ("rtol", rtol), ("box", box)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} must be a positive number; got {value!r}")
    if not (np.isfinite(transient) and transient >= 0.0):
        raise InputError(f"transient must be 0 or a positive number; got {transient!r}")
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 2:
        raise InputError(f"samples must be a whole number, 2 or more; got {samples!r}")
    u, p = model.start_point(start, dict(parameters or {}))
    from contin.lowering import compile_system

    system = compile_system(model)
    if model.kind == "map":
        return _iterated(model, system, u, p, time, transient, box)
    times = np.linspace(transient, transient + time, samples)
    absolute = 1e-3 * rtol if atol is None else atol
    if method in STIFF:
        from contin.simulate.stiff import integrate_stiff

        t, states, steps, outcome, why = integrate_stiff(system, u, p, times, method, rtol, absolute, box)
        end, crossings = (float(t[-1]) if len(t) else 0.0), 0
    else:
        flight = fly(system, u, p, float(times[-1]), times=times, rtol=rtol, atol=absolute, box=box, budget=budget)
        t, states, steps, outcome, why = flight.t, flight.u, flight.steps, flight.outcome, flight.why
        end, crossings = flight.end_time, flight.crossed
    return Simulation(model, method, p, t, states, observed(system, states, p, t), end, steps, crossings, outcome, why)


def observed(system: Any, states: Array, p: Array, t: Array) -> Array:
    """Observables at the states (T, k)."""
    if not system.observable_names or not len(states):
        return np.empty((len(states), len(system.observable_names)))
    rows = np.tile(np.asarray(p, dtype=float), (len(states), 1))
    if system.is_forced:
        rows = np.column_stack([rows, t])
    return np.asarray(system.observables(np.ascontiguousarray(states), rows)).reshape(len(states), -1)


def _iterated(model: Any, system: Any, u: Array, p: Array, time: float, transient: float, box: float) -> Simulation:
    """Every iterate after the transient."""
    count, skipped = round(time), round(transient)
    if count + skipped > LONGEST_MAP:
        raise InputError(f"a map is iterated at most {LONGEST_MAP} times; got {count + skipped}")
    kept, outcome, why = [u], "done", ""
    full = np.append(p, 0.0) if system.is_forced else p
    for k in range(count + skipped):
        u = system.value(u, full)
        if not np.all(np.abs(u) <= box):
            outcome, why = "escaped", f"iterate {k + 1} is not finite, or left the box of {box:.6g}"
            break
        kept.append(u)
    states = np.array(kept[skipped:]).reshape(-1, system.n)
    t = np.arange(skipped, skipped + len(states), dtype=float)
    end = float(len(kept) - 1)
    return Simulation(model, "map", p, t, states, observed(system, states, p, t), end, len(kept) - 1, 0, outcome, why)
