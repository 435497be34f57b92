"""The parts of a run file's entries, checked against the model: names, formulas, starts, ranges, user values."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from contin.errors import ExpressionError, InputError, NotFiniteError
from contin.limits import as_double
from contin.model.advice import closest
from contin.model.evaluate import evaluate
from contin.model.parser import parse
from contin.model.source import Path, Problems, Span
from contin.records import Record
from contin.runs.columns import STANDARD, column_mistake, formulas
from contin.runs.plans import AUTO, Number, StartPoint
from contin.runs.schema import StartMapping
from contin.symbolic.passes.conserved import starting_names

if TYPE_CHECKING:
    from contin.model.expression import Expression
    from contin.model.model import Model


class EntryParts:
    """Names and numbers of a run file's entries, checked against a model; mistakes go to `problems`, with places."""

    def __init__(self, model: Model, problems: Problems, overrides: Mapping[str, Number]) -> None:
        self.model, self.problems, self.overrides = model, problems, dict(overrides)
        self.names = list(model.parameter_names)
        self.values: dict[str, float] = {}

    def known(self, name: str, path: Path, *, key: bool = False) -> bool:
        if name in self.names:
            return True
        self.problems.add(path, f"{self.model.name} has no parameter {name!r}: {self.advice(name)}", key=key)
        return False

    def advice(self, name: str) -> str:
        return closest(name, self.names) or f"there are {', '.join(self.names) or 'none'}"

    def formula(self, value: Number, path: Path) -> float | None:
        """The value of a number or a formula in the parameters; a mistake is noted at its place."""
        if not isinstance(value, str):
            return as_double(value)
        expression = self._parsed(value, self.names, path)
        if expression is None or (not self.values and self.names):
            return None
        number = float(evaluate(expression, self.values))
        if not math.isfinite(number):
            self.problems.add(path, f"{value!r} is {number}; a finite number is needed")
            return None
        return number

    def _parsed(self, value: str, names: Sequence[str], path: Path) -> Expression | None:
        try:
            return parse(value, names, self.model.functions)
        except ExpressionError as error:
            span = Span(error.position, error.position + 1)
            self.problems.add(path, str(error), value=value, span=span)
            return None

    def has_start(self, name: str) -> bool:
        return any(start.name == name for start in self.model.starts)

    def _is_state(self, name: str, known: Sequence[str], path: Path) -> bool:
        if name not in known:
            advice = closest(name, list(known)) or f"there are {', '.join(known)}"
            self.problems.add(path, f"{self.model.name} has no state {name!r}: {advice}", key=True)
        return name in known

    def box(self, written: Mapping[str, Sequence[Any]] | None, path: Path) -> dict[str, tuple[float, float]] | None:
        """Bounds of states, in numbers."""
        if written is None:
            return None
        box: dict[str, tuple[float, float]] = {}
        for name, (low, high) in written.items():
            if not self._is_state(name, self.model.state_names, (*path, name)):
                continue
            bounds = self.formula(low, (*path, name, 0)), self.formula(high, (*path, name, 1))
            if bounds[0] is not None and bounds[1] is not None:
                box[name] = (bounds[0], bounds[1])
                if not box[name][0] < box[name][1]:
                    self.problems.add((*path, name), f"the lower bound must be below the upper one; got {list(bounds)}")
        return box

    def start(self, written: str | StartMapping, path: Path) -> StartPoint:
        """A start as the model takes it, its names checked."""
        if isinstance(written, str):
            names = [start.name for start in self.model.starts]
            if written not in (*names, AUTO):
                advice = closest(written, names) or (
                    f"there are {', '.join(names)}" if names else "it declares no starts"
                )
                self.problems.add(path, f"{self.model.name} has no start {written!r}: {advice}")
            return written
        states = dict(written.model_extra or {})
        for name in states:
            known = self._is_state(name, starting_names(self.model), (*path, name))
            if known and not getattr(self.model, "axes", ()):  # in coordinates: read where the start is made
                self._state(states[name], (*path, name))
        for name, value in written.parameters.items():
            if self.known(name, (*path, "parameters", name), key=True):
                self.formula(value, (*path, "parameters", name))
        return {**states, "parameters": dict(written.parameters)} if written.parameters else states

    def _state(self, value: Number, path: Path) -> None:
        """A state's value at a start: of a boundary-value problem a function of the independent variable."""
        interval = getattr(self.model, "interval", None)
        if interval is not None and isinstance(value, str):
            self._parsed(value, [*self.names, interval.name], path)
        else:
            self.formula(value, path)

    def bounds(self, written: object, parameters: Iterable[str], path: Path) -> dict[str, tuple[float, float]]:
        """The range of every parameter that varies: as written, or the model's own."""
        parameters = list(parameters)
        path = (*path, "range")
        given: Record = {}
        if isinstance(written, Mapping):
            given = written
            for name in written:
                if name not in parameters:
                    self.problems.add(
                        (*path, name),
                        f"{name!r} does not vary in this run; it varies {', '.join(parameters)}",
                        key=True,
                    )
        elif written is not None and len(parameters) == 1:
            given = {parameters[0]: written}
        elif written is not None:
            one = ", ".join(f"{name}: [low, high]" for name in parameters)
            self.problems.add(path, f"two parameters need a range each: write {{{one}}}")
            return {}
        found = {}
        for name in parameters:
            place = (*path, name) if isinstance(written, Mapping) and name in written else path
            bounds = self.interval(given[name], place) if name in given else self.default_range(name, place)
            if bounds is not None:
                found[name] = bounds
        return found

    def interval(self, written: Sequence[Number], path: Path) -> tuple[float, float] | None:
        low, high = (self.formula(value, (*path, k)) for k, value in enumerate(written))
        if low is None or high is None:
            return None
        if not low < high:
            self.problems.add(path, f"expected [low, high] with low < high, got [{low:g}, {high:g}]")
            return None
        return low, high

    def default_range(self, name: str, path: Path) -> tuple[float, float] | None:
        if self.names and not self.values:
            return None  # the values of the parameters are wrong, which is noted
        bounds = self.model.parameter_range(name, self.overrides)
        if bounds is None:
            self.problems.add(
                path[:-1] if path[-1] == "range" else path, f"the range of {name} is missing; add `range: [low, high]`"
            )
        return bounds

    def targets(self, written: Mapping[str, Sequence[Number]], path: Path) -> dict[str, list[float]]:
        """User values by column."""
        columns = [*self.names, *self.model.state_names, *self.model.observables, "period", *STANDARD]
        found: dict[str, list[float]] = {}
        for name, entries in written.items():
            known = name in columns or name.rpartition(".")[0] in columns
            if not known and not formulas([name], self.model):
                advice = closest(name, columns) or column_mistake(name, self.model)
                advice = advice or f"there are {', '.join(columns)}"
                self.problems.add((*path, "values", name), f"there is no column {name!r}: {advice}", key=True)
                continue
            numbers = [self.formula(value, (*path, "values", name)) for value in entries]
            found[name] = [number for number in numbers if number is not None]
        return found

    def inside(self, start: StartPoint, parameter: str, bounds: tuple[float, float], path: Path) -> None:
        """The start must lie in the range."""
        if self.problems:
            return
        start = None if start == AUTO and not self.has_start(AUTO) else start
        try:
            _, p = self.model.start_point(start, self.overrides)
        except (InputError, NotFiniteError) as error:
            self.problems.add((*path[:-1], "start"), str(error))
            return
        value = float(p[self.names.index(parameter)])
        if not bounds[0] <= value <= bounds[1]:
            self.problems.add(
                path,
                f"the start has {parameter} = {value:.10g}, outside the range [{bounds[0]:g}, {bounds[1]:g}]; "
                f"widen the range, or set {parameter} under `parameters`",
            )
