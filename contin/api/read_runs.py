"""Trajectories, sweeps and surveys from files, as they were: with columns, in words, drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.api.survey_side import Side
from contin.api.surveys import Row, Survey
from contin.errors import InputError
from contin.exponents.spectrum import LyapunovSpectrum
from contin.notebook import html
from contin.plot.trajectory import drawn
from contin.records import Record
from contin.simulate.steady import STATISTICS
from contin.simulate.sweep import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class StoredSimulation:
    """A trajectory from a file: `columns` (t, states, observables), `section` and `events` where there are any.

    outcome, why, end_time : how it ended, as those of `contin.simulate`.  notes : of the file.
    """

    model: str
    columns: dict[str, Array]
    outcome: str
    why: str
    end_time: float
    section: dict[str, Array] | None = None
    events: dict[str, Array] | None = None
    name: str = "simulation"
    notes: tuple[str, ...] = ()

    @property
    def t(self) -> Array:
        return self.columns["t"]

    @property
    def complete(self) -> bool:
        return self.outcome in ("done", "event")

    def plot(self, x: str | None = None, y: str | None = None, *, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: time series beside column y over column x, as that of the simulation that was saved."""
        names = [name for name in self.columns if name != "t"]
        return drawn(self._with_jumps(), names, ax, {"x": x, "y": y, **options}, section=self.section)

    def _with_jumps(self) -> dict[str, Array]:
        """The columns with both states at each event and a gap between them, where the file has events."""
        if self.events is None or not len(self.events["t"]):
            return self.columns
        times, first = np.unique(self.events["t"], return_index=True)
        last = np.append(first[1:], len(self.events["t"])) - 1  # of several at once: before all, after all
        places = np.repeat(np.searchsorted(self.t, times, "right"), 3)
        found = {}
        for name, column in self.columns.items():
            gap = np.full(len(self.events["t"]), np.nan)  # of observables, which the table of events does not have
            before, after = (self.events.get(f"{name}.{side}", gap) for side in ("before", "after"))
            beside = (times, times, times) if name == "t" else (before[first], gap[first], after[last])
            found[name] = np.insert(column, places, np.column_stack(beside).ravel())
        return found

    def __repr__(self) -> str:
        return f"<{self}>"

    def __str__(self) -> str:
        why = "" if self.outcome == "done" else f": {self.outcome}, {self.why}"
        return f"{self.name} of {self.model} to t = {self.end_time:.6g}{why}"

    def _repr_html_(self) -> str:
        picture = html.image(self.plot(), "trajectory") if len(self.columns) > 1 else ""
        return picture + html.paragraph(str(self))


def simulation_of(stored: Record, notes: Sequence[str] = ()) -> StoredSimulation:
    """From the JSON of `contin simulate`, or an entry of `simulations`."""
    tables = {name: _table(stored[name]) if name in stored else None for name in ("section", "events")}
    return StoredSimulation(
        stored["model"], _table(stored["columns"]), stored["outcome"], stored.get("why", ""),
        _number(stored["end_time"]), tables["section"], tables["events"], stored.get("name", "simulation"),
        tuple(notes),
    )  # fmt: skip


def sweep_of(stored: Record, parameter: str, model: str) -> Sweep:
    """The sweep of a table; its `model` is a name."""
    columns = stored["columns"]
    if parameter not in columns:
        raise InputError(f"not the results of a sweep, or damaged: columns has no {parameter!r}")
    last = f".{STATISTICS[0]}"
    names = tuple(stored.get("quantities") or (name.removesuffix(last) for name in columns if name.endswith(last)))
    missing = [f"{name}.{what}" for name in names for what in STATISTICS if f"{name}.{what}" not in columns]
    if missing:
        raise InputError(f"not the results of a sweep, or damaged: columns has no {missing[0]!r}")
    statistics = [[_column(columns[f"{name}.{what}"]) for name in names] for what in STATISTICS]
    return Sweep(
        model, parameter, names, _column(columns[parameter]), _column(columns["direction"]).astype(int),
        tuple(columns["outcome"]), np.array(statistics).transpose(2, 0, 1),
    )  # fmt: skip


def lyapunov_of(stored: Record) -> LyapunovSpectrum:
    """The exponents of a table; their `model` is a name."""
    columns, parameter = stored["columns"], stored["lyapunov"]
    if parameter and parameter not in columns:
        raise InputError(f"not the results of contin lyapunov, or damaged: columns has no {parameter!r}")
    count = sum(name.startswith("exponent.") for name in columns)
    missing = [f"{what}.{k + 1}" for k in range(count) for what in ("exponent", "error")]
    missing = [name for name in missing if name not in columns]
    if missing:
        raise InputError(f"not the results of contin lyapunov, or damaged: columns has no {missing[0]!r}")
    rows, errors = (
        np.column_stack([_column(columns[f"{what}.{k + 1}"]) for k in range(count)]) for what in ("exponent", "error")
    )
    values = _column(columns[parameter]) if parameter else np.array([])
    return LyapunovSpectrum(
        stored["model"], parameter, values, rows, errors, _column(columns["time"]), tuple(columns["outcome"]),
        stored["complete"], tuple(stored["notes"]),
    )  # fmt: skip


@dataclass(frozen=True)
class StoredAttractor:
    """A solution that a survey started from, in words."""

    solution: str
    how: str
    words: str

    def __str__(self) -> str:
        return f"{self.solution} ({self.words})"


def survey_of(document: Record) -> Survey:
    """The survey of a file; its attractors are words."""
    columns = document["survey"]

    def side(name: str, k: int) -> Side:
        kind, detail, end = (columns[f"{name}.{part}"][k] for part in ("type", "detail", "end"))
        return Side(_number(columns[name][k]), kind, detail, end)

    rows = tuple(
        Row(attractor, parameter, _number(value), side("below", k), side("above", k))
        for k, (attractor, parameter, value) in enumerate(
            zip(columns["attractor"], columns["parameter"], columns["value"], strict=True)
        )
    )
    attractors = {name: StoredAttractor(**dict(one)) for name, one in document["attractors"].items()}
    notes, seconds = tuple(document["notes"]), document["seconds"]
    return Survey(document["model"], attractors, rows, document["factor"], notes, seconds)


def _table(columns: Mapping[str, Sequence[float | None]]) -> dict[str, Array]:
    return {name: _column(column) for name, column in columns.items()}


def _column(column: Sequence[float | None]) -> Array:
    return np.array(column, dtype=float)  # null becomes NaN


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
