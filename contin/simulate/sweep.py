"""Hysteresis sweeps: a parameter stepped up and down, each run started from the last state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from contin import lazy
from contin.abi import Array
from contin.errors import InputError
from contin.model.advice import place_of_parameter
from contin.model.kinds import need_model, need_time
from contin.records import Fields, Record
from contin.simulate.consistent import consistent_start
from contin.simulate.measures import with_measures
from contin.simulate.natural import Metric, natural_metric
from contin.simulate.steady import STATISTICS, Criterion, settle
from contin.simulate.systems import autonomous
from contin.symbolic.passes.conserved import with_named_totals

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.lowering.system import CompiledSystem
    from contin.model.model import Model

STEPS = 60
LARGEST = 100_000
LEAST = 1e-3  # natural sizes: what a smaller state is pushed by is a part of this


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """One row a run: the parameter's value, direction (+1 up, -1 down), outcome, and statistics (N, 3, k)."""

    model: Any
    parameter: str
    names: tuple[str, ...]
    values: Array
    directions: Array
    outcomes: tuple[str, ...]
    statistics: Array

    @property
    def columns(self) -> Fields:
        """parameter, direction, outcome, and {quantity}.{min|mean|max}."""
        columns: Fields = {
            self.parameter: self.values, "direction": self.directions, "outcome": list(self.outcomes)
        }  # fmt: skip
        for k, name in enumerate(self.names):
            for row, what in enumerate(STATISTICS):
                columns[f"{name}.{what}"] = self.statistics[:, row, k]
        return columns

    def plot(self, y: str | Sequence[str] | None = None, *, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: extrema of quantity y (default: the first) over the parameter, up and down.

        ax : draw into these axes instead.  options : limits, log, size, legend, title, style (`contin.draw`).
        """
        module = lazy.module("drawn sweeps")
        drawn: Figure = module.drawn(self.columns, self.parameter, self.names, ax, {"y": y, **options})
        return drawn

    def __repr__(self) -> str:
        settled = sum(outcome == "settled" for outcome in self.outcomes)
        return f"<Sweep in {self.parameter}: {len(self.values)} runs, {settled} settled>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook trajectories").sweep_page(self))

    def jumps(self, quantity: str, factor: float = 10.0) -> list[tuple[int, float, float]]:
        """(direction, before, after): steps at which the largest value changes `factor` times more than usual."""
        column = self.columns[f"{quantity}.max"]
        found = []
        for direction in (1, -1):
            rows = np.flatnonzero(self.directions == direction)
            change = np.abs(np.diff(column[rows]))
            usual = float(np.median(change)) if change.size else 0.0
            for k in np.flatnonzero(change > factor * usual + 1e-6 * float(np.abs(column).max())):
                found.append((direction, float(self.values[rows[k]]), float(self.values[rows[k + 1]])))
        return found


def sweep(
    model: Any, parameter: str, range: tuple[float, float], *, start: Any = None,
    parameters: Record | None = None, steps: int = STEPS, down: bool = True,
    measures: Mapping[str, str] | None = None, criterion: Criterion | None = None, disturb: float = 1e-6,
    watch: Callable[[int, int], None] | None = None,
) -> Sweep:  # fmt: skip
    """Step a parameter from the lower to the upper end of `range` in `steps` steps, and back down.

    Each run starts from the last state, disturbed by `disturb` (relative, alternating signs: an unstable state is
    otherwise never left), and lasts until `measures` (formulas; by default amplitudes and phase differences of declared
    oscillators, or states and observables) have settled by the `criterion`.
    watch : called with (runs done, runs in all).

    Raises InputError. A run that escapes or slides is recorded, and the next starts from the sweep's start.
    """
    need_model(model)
    ends = [float(v) for v in range]
    if len(ends) != 2:
        raise InputError(f"range: a lower and an upper end; got {len(ends)} values (`steps` says how many are between)")
    low, high = ends
    model = with_named_totals(model, [parameter, *(parameters or ())])
    place_of_parameter(parameter, model.parameter_names)
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise InputError(f"range: the lower end must be below the upper one; got [{low:g}, {high:g}]")
    if isinstance(steps, bool) or not isinstance(steps, int) or not 1 <= steps <= LARGEST:
        raise InputError(f"steps must be a whole number from 1 to {LARGEST}; got {steps!r}")

    need_time(model, "steady states in time to sweep")
    system = autonomous(with_measures(model, measures))
    u0, p = model.start_point(start, {**(parameters or {}), parameter: low})
    u0 = consistent_start(system, u0, p)
    metric = natural_metric(system, u0, p)
    chosen = criterion or default_criterion(system, metric)
    upwards = np.linspace(low, high, steps + 1)
    values = np.concatenate([upwards, upwards[::-1]]) if down else upwards
    directions = np.concatenate([np.ones(steps + 1), -np.ones(steps + 1)]) if down else np.ones(steps + 1)
    fixed = {**parameters_of(model, start), **(parameters or {})}
    signs = np.where(np.arange(system.n) % 2 == 0, 1.0, -1.0) * (1.0 + 0.1 * np.arange(system.n))
    u, outcomes, statistics = u0, [], []
    for k, value in enumerate(values):
        p = np.array(list(model.default_parameters({**fixed, parameter: value}).values()), dtype=float)
        pushed = u + disturb * signs * np.maximum(np.abs(u), LEAST * metric.states)
        found = settle(system, pushed, p, chosen, metric)
        outcomes.append(found.outcome)
        statistics.append(found.statistics)
        u = found.u if found.outcome in ("settled", "unsettled") else u0
        if watch is not None:
            watch(k + 1, len(values))
    return Sweep(
        model, parameter, tuple(system.observable_names), values, directions.astype(int), tuple(outcomes),
        np.array(statistics),
    )  # fmt: skip


def parameters_of(model: Model, start: Any) -> Fields:
    """The parameter values that belong to a start."""
    if start is None or not isinstance(start, str | Mapping):
        return {}
    return dict(model.start(start).parameters if isinstance(start, str) else start.get("parameters", {}))


def default_criterion(system: CompiledSystem, metric: Metric) -> Criterion:
    """Windows of 30 turns or more of the fastest linear rate at the start (a map: of 200 iterates)."""
    return Criterion(200.0 if system.kind == "map" else 30.0 * 2.0 * np.pi * metric.time)
