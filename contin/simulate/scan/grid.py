"""What a scan runs: a grid over parameters or initial states, several starts, and the names of what may be found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import ExpressionError, InputError
from contin.limits import MOST_RUNS
from contin.model.advice import closest
from contin.model.expression import symbol
from contin.records import Fields, Record
from contin.simulate.condition import condition
from contin.simulate.measures import with_measures
from contin.simulate.steady import STATISTICS, Criterion

if TYPE_CHECKING:
    from contin.model.model import Model

OTHER: Final = "other"
NO_START: Final = "no start"
RESERVED: Final = (OTHER, NO_START, "escaped", "sliding", "stopped")  # names of what is no class of the user's


@dataclass(frozen=True, eq=False)
class ScanSpec:
    """What to run. Run number k stands for a point of the grid (axes in order, the last one fastest) and a start.

    axes : (name, values) of parameters or states.  starts : named starts, mappings of states, or None.
    measures : {name: formula} of the quantities measured.  classes : {name: condition} in the names QUANTITY_min,
    QUANTITY_mean, QUANTITY_max and the parameters; the first that holds names a run, `other` where none does.
    settle : fields of `contin.simulate.steady.Criterion`; without a window, 30 turns of the fastest rate at the start.
    names : of the starts.
    """

    model: Any
    axes: tuple[tuple[str, Array], ...]
    starts: tuple[Any, ...] = (None,)
    parameters: Record = field(default_factory=dict)
    measures: Mapping[str, str] = field(default_factory=dict)
    classes: Mapping[str, str] = field(default_factory=dict)
    settle: Record = field(default_factory=dict)
    names: tuple[str, ...] = ()

    def __getstate__(self) -> Fields:
        """The fields that were given; everything else is made from them again in the other process."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def __len__(self) -> int:
        return math.prod(len(values) for _, values in self.axes) * len(self.starts)

    def check(self) -> None:
        """Raises InputError or ExpressionError for formulas and names that cannot be carried out."""
        for name, values in self.axes:
            if name not in (*self.model.parameter_names, *self.model.state_names):
                known = [*self.model.parameter_names, *self.model.state_names]
                advice = closest(name, known) or f"there are {', '.join(known)}"
                raise InputError(f"{self.model.name} has neither a parameter nor a state {name!r}: {advice}")
            if not len(values) or not np.all(np.isfinite(values)):
                raise InputError(f"the axis {name} needs finite values, one or more")
        if len(self) > MOST_RUNS:
            raise InputError(f"{len(self)} runs are more than {MOST_RUNS}")
        for name in self.classes:
            if name in RESERVED:
                raise InputError(f"the class {name!r} has a meaning of its own; give this class another name")
        clash = next((name for name, _ in self.axes if name in ("start", "class", "outcome", "time")), None)
        if clash is not None:
            raise InputError(f"an axis may not be named {clash}, which is another column of the table")
        _ = self.conditions
        Criterion(**{"window": 1.0, **self.settle})

    @cached_property
    def measured(self) -> Model:
        """The model with the measures as observables."""
        return with_measures(self.model, self.measures)

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        return tuple(self.measured.observables)

    @cached_property
    def conditions(self) -> Fields:
        """The classes' conditions, parsed."""
        statistics = [f"{name}_{what}" for name in self.quantities for what in STATISTICS]
        names = {name: symbol(name) for name in (*self.model.parameter_names, *statistics)}
        parsed = {}
        for label, text in self.classes.items():
            try:
                parsed[label] = condition(text, names, self.model.functions, f"class {label!r}")
            except ExpressionError as error:
                raise ExpressionError(f"{error} (known: {', '.join(names)})") from None
        return parsed

    def place(self, job: int) -> tuple[tuple[float, ...], int]:
        """The values on the axes, and the number of the start, of run `job`."""
        return place(job, [values for _, values in self.axes], len(self.starts))

    @cached_property
    def start_names(self) -> tuple[str, ...]:
        """As given in `names`, as the model names them, or start1, start2, .. by number."""
        if self.names:
            return tuple(self.names)
        return tuple(
            start if isinstance(start, str) else "default" if start is None else f"start{k + 1}"
            for k, start in enumerate(self.starts)
        )

    def head(self) -> Fields:
        """All that the numbers of the runs refer to, as data for JSON."""
        return {
            "axes": {name: [float(v) for v in values] for name, values in self.axes},
            "starts": list(self.start_names),
            "quantities": list(self.quantities),
            "classes": dict(self.classes),
            "settle": dict(self.settle),
        }


def place(job: int, axes: Sequence[Any], starts: int) -> tuple[tuple[float, ...], int]:
    """The values on the axes (the last one runs fastest), and the number of the start, of run `job`."""
    rest, start = divmod(job, starts)
    values = []
    for axis in reversed(axes):
        rest, k = divmod(rest, len(axis))
        values.append(float(axis[k]))
    return tuple(reversed(values)), start


@dataclass(frozen=True)
class Outcome:
    """What one run came to: its class, how it ended and when, the statistics of the last window."""

    label: str
    outcome: str
    time: float
    statistics: Mapping[str, float]


def table(head: Record, rows: Mapping[int, Outcome]) -> dict[str, list[Any]]:
    """The finished runs in order, a row each: axes, start, class, outcome, time, statistics."""
    axes = head["axes"]
    names = [f"{q}_{what}" for q in head["quantities"] for what in STATISTICS]
    columns: dict[str, list[Any]] = {key: [] for key in (*axes, "start", "class", "outcome", "time", *names)}
    for job in sorted(rows):
        values, start = place(job, list(axes.values()), len(head["starts"]))
        outcome = rows[job]
        for name, value in zip(axes, values, strict=True):
            columns[name].append(value)
        columns["start"].append(head["starts"][start])
        columns["class"].append(outcome.label)
        columns["outcome"].append(outcome.outcome)
        columns["time"].append(outcome.time)
        for name in names:
            columns[name].append(outcome.statistics.get(name, math.nan))
    return columns
