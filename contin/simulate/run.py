"""Simulation of a model from a start: trajectories of flows, stiff or not, and iterates of maps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin import lazy
from contin.abi import Array
from contin.errors import InputError
from contin.limits import LARGEST_TABLE, check_count
from contin.model.kinds import need_model, need_time
from contin.model.model import Model
from contin.model.parts import TIME
from contin.records import Record
from contin.simulate.consistent import consistent_start, moved_onto, onto_constraints
from contin.simulate.crossings import section_of, separated
from contin.simulate.flight import DONE, ESCAPED, STOPPED
from contin.simulate.path import EVENT, NO_EVENT, STIFF, path_of
from contin.simulate.reach import left_reach
from contin.simulate.resets import Jump
from contin.simulate.systems import in_time, need_formulas
from contin.symbolic.passes.conserved import with_named_totals

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.lowering.system import CompiledSystem

METHODS: Final = ("DOP853", *STIFF)
RTOL: Final = 1e-9
SAMPLES: Final = 5000  # so that fast oscillations are drawn as curves
BUDGET: Final = 50_000_000  # steps: a minute or two


@dataclass(frozen=True, eq=False, repr=False)
class Simulation:
    """States (T, n) and observables (T, k) at times t (T,).

    outcome : done, event (`until` became true), no event (it did not), escaped (from the box), sliding or stopped;
    `why` in words, `end_time` when. `crossings` counts the switching surfaces crossed, `steps` the integrator's steps.
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
    note: str = ""  # which states were changed to have consistent initial values
    jumps: tuple[Jump, ...] = ()  # at the model's `events`, in order
    crossed: tuple[Jump, ...] | None = None  # of the section that was asked for

    @property
    def complete(self) -> bool:
        return self.outcome in (DONE, EVENT)

    @property
    def columns(self) -> dict[str, Array]:
        """t, every state, every observable."""
        columns = {"t": self.t}
        if self.model.state_names or not self.states.shape[1]:
            columns.update(zip(self.model.state_names, self.states.T, strict=True))
        else:  # a function of many states, without names
            columns["norm"] = np.sqrt(np.mean(self.states * self.states, axis=1))
            columns["min"], columns["max"] = self.states.min(axis=1), self.states.max(axis=1)
        columns.update(zip(self.model.observables, self.observables.T, strict=True))
        return columns

    @property
    def drawn(self) -> dict[str, Array]:
        """The columns with the two states of each jump, and a gap between them."""
        if not self.jumps:
            return self.columns
        jumps = [j for j in self.jumps if len(self.t) and j.time >= self.t[0]]
        both = np.array([y for j in jumps for y in (j.before, j.after)]).reshape(2 * len(jumps), self.states.shape[1])
        times = np.repeat([j.time for j in jumps], 2)
        bare = in_time(self.model.replace(events=()))
        beside = [times, *both.T, *observed(bare, both, self.p, times).T]
        drawn = {}
        for (name, column), extra in zip(self.columns.items(), beside, strict=True):
            pairs = extra.reshape(-1, 2)
            gaps = np.full(len(jumps), np.nan) if name != TIME else pairs[:, 0]
            rows = np.column_stack([pairs[:, :1], gaps, pairs[:, 1:]]).ravel()
            drawn[name] = np.insert(column, np.repeat(np.searchsorted(self.t, times[::2], "right"), 3), rows)
        return drawn

    @property
    def events(self) -> dict[str, Array]:
        """One row for each event: its time `t`, its number `event` in the model (from 1), states before and after."""
        rows = [(j, k) for j in self.jumps for k in j.events]
        n = self.states.shape[1]
        before = np.array([j.before for j, _ in rows]).reshape(len(rows), n)
        after = np.array([j.after for j, _ in rows]).reshape(len(rows), n)
        found = {"t": np.array([j.time for j, _ in rows]), "event": np.array([k + 1.0 for _, k in rows])}
        for i, name in enumerate(self.model.state_names):
            found |= {f"{name}.before": before[:, i], f"{name}.after": after[:, i]}
        return found

    @property
    def section(self) -> dict[str, Array] | None:
        """t, every state and observable at the crossings of the section; None where none was asked for."""
        if self.crossed is None:
            return None
        times = np.array([c.time for c in self.crossed])
        states = np.array([c.before for c in self.crossed]).reshape(len(times), self.states.shape[1])
        seen = observed(in_time(self.model.replace(events=())), states, self.p, times)
        return dict(zip(self.columns, [times, *states.T, *seen.T], strict=True))

    @property
    def table(self) -> dict[str, Array]:
        """The columns under the model's labels: what a foreign model calls them; the time gives way to a label `t`."""
        labels = {name: self.model.labels.get(name, name) for name in self.columns if name != TIME}
        clock = next(name for name in (TIME, "time", "time_") if name not in labels.values())
        return {labels.get(name, clock): column for name, column in self.columns.items()}

    def plot(self, x: str | None = None, y: str | None = None, *, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: time series beside column y over column x (default: the first two states).

        ax : draw y over x into these axes instead.  options : limits, log, size, legend, title, style (`contin.draw`).
        """
        names = [*self.model.state_names, *self.model.observables]
        drawn: Figure = lazy.module("drawn trajectories").drawn(
            self.drawn, names, ax, {"x": x, "y": y, **options}, section=self.section
        )
        return drawn

    def __repr__(self) -> str:
        return f"<Simulation of {self.model.name!r}: {self}>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook trajectories").simulation_page(self))

    def __str__(self) -> str:
        if self.outcome in (NO_EVENT, ESCAPED):
            return self.why
        if not self.complete:
            return f"stopped at t = {self.end_time:.6g}: {self.why}"
        jumped = f", {len(self.jumps)} jumps" if self.jumps else ""
        jumped += "" if self.crossed is None else f", {len(self.crossed)} crossings of the section"
        crossed = f", {self.crossings} switching surfaces crossed" if self.crossings else ""
        reached = f"{self.why} at t = {self.end_time:.12g}" if self.outcome == EVENT else f"t = {self.end_time:.6g}"
        note = f" ({self.why})" if self.outcome == DONE and self.why else ""
        begun = f"; {self.note}" if self.note else ""
        return f"{self.method}: {self.steps} steps to {reached}{crossed}{jumped}{note}{begun}"


def simulate(
    model: Any, start: str | Record | None = None, parameters: Record | None = None, *,
    time: float = 100.0, transient: float = 0.0, samples: int = SAMPLES, method: str = "DOP853", rtol: float = RTOL,
    atol: float | None = None, box: float = 1e100, budget: int = BUDGET, until: str | None = None,
    section: str | Mapping[str, object] | None = None,
) -> Simulation:  # fmt: skip
    """Integrate a model (iterate a map) from a start over `time`, after a `transient` that is not kept.

    start : a named start, a mapping of states, or None for the states' values.  samples : equally spaced times that the
    solution is kept at; a map keeps every iterate.
    method : DOP853 (compiled; piecewise-smooth flows piece by piece), or for stiff flows Radau, LSODA, BDF (scipy, with
    the compiled equations and Jacobian).  rtol, atol : tolerances (atol by default 1e-3 rtol in the states' natural
    sizes).  box : modulus of a state at which the simulation ends as escaped (by default where numbers end).
    budget : most steps of the integrator.
    until : a condition such as "x > 2 and y < 0"; the simulation ends exactly where it becomes true.
    section : an expression, 'x - 1' or 'x = 1', or {when, direction: up, down or both}: the result's `section` has the
    states, after the transient, at which it crosses zero (upwards, unless it says otherwise).

    The flow may use the time `t` without `forcing`, and have no states; states may be infinite or not a number.
    A solution that blows up, escapes or slides gives the part before, with `outcome` and `why`. Raises InputError.
    """
    need_model(model)
    need_time(model, "trajectories")
    jumping = isinstance(model, Model) and bool(model.events)
    model = model if jumping else with_named_totals(model, parameters or ())
    if section is not None:
        need_formulas(model, "section", "look for the crossings in the states of the result")
    flown = model if section is None else model.replace(events=(*model.events, section_of(model, section)))
    if method not in METHODS:
        raise InputError(f"method must be one of {', '.join(METHODS)}; got {method!r}")
    for name, value in (("rtol", rtol), ("box", box)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} must be a positive number; got {value!r}")
    for name, value in (("time", time), ("transient", transient)):
        if not (np.isfinite(value) and value >= 0.0):
            raise InputError(f"{name} must be 0 or a positive number; got {value!r}")
    check_count("samples", samples, 1, max(2, LARGEST_TABLE // (1 + len(model.state_names))))
    check_count("budget", budget)
    if until is not None:
        need_formulas(model, "until", "look for the event in the states of the result")
    u, p = model.start_point(start, dict(parameters or {}), finite=False)
    system = in_time(model.replace(events=()) if jumping else model, method not in STIFF)
    given, u = u, consistent_start(system, u, p)
    if model.kind == "map":
        found: Simulation = lazy.module("iterates").iterated(model, system, u, p, time, transient, box, until)
        return found
    times = np.linspace(transient, transient + time, samples)
    path = path_of(flown, system, u, p, times, method, until, rtol=rtol, atol=atol, box=box, budget=budget)
    t, states, end, outcome, why = path.t, path.states, path.end, path.outcome, path.why
    left = left_reach(system, states, over_time(system, p, t))
    if left is not None:
        count, why = left
        t, states, outcome = t[:count], states[:count], STOPPED
        end = float(t[-1]) if count else 0.0
    states, note = onto_constraints(system, states, over_time(system, p, t)), moved_onto(system, given, u)
    seen = observed(system, states, p, t)
    counts = path.steps, path.crossings if system.n_switches else 0
    jumps, crossed = (path.jumps, ()) if section is None else separated(path.jumps, len(model.events))
    kept = None if section is None else tuple(c for c in crossed if c.time >= transient)
    return Simulation(model, method, p, t, states, seen, end, *counts, outcome, why, note, jumps, kept)


def observed(system: CompiledSystem, states: Array, p: Array, t: Array) -> Array:
    """Observables at the states (T, k)."""
    if not system.observable_names or not len(states):
        return np.empty((len(states), len(system.observable_names)))
    rows = over_time(system, p, t)
    return np.asarray(system.observables(np.ascontiguousarray(states), rows)).reshape(len(states), -1)


def over_time(system: CompiledSystem, p: Array, t: Array) -> Array:
    """The parameters at the times t, (T, p_size)."""
    rows = np.tile(np.asarray(p, dtype=float), (len(t), 1))
    return np.column_stack([rows, t]) if system.is_forced else rows
