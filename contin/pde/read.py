"""Plain data of the shape of a model file of kind: pde -> `PdeProblem`, or one error with everything that is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from pydantic import ValidationError

from contin.errors import InputError
from contin.model.advice import closest
from contin.model.evaluate import evaluate
from contin.model.expression import Expression, number
from contin.model.inline import Formulas
from contin.model.lexer import canonical_name
from contin.model.misshapen import note
from contin.model.naming import check_label, check_name
from contin.model.parts import Parameter, Start
from contin.model.schema import ParameterEntry
from contin.model.scope import Calls, Scope
from contin.model.shape import check_version, plain
from contin.model.source import CallSource, Path, Problems, Source
from contin.model.values import parameter_values
from contin.pde.axes import Axis
from contin.pde.conditions import ConditionReader
from contin.pde.conserved import Conserving
from contin.pde.equations import Discretised
from contin.pde.frame import Travelling
from contin.pde.grid import Grid
from contin.pde.measures import MeasureReader, Observer
from contin.pde.problem import PdeProblem, sampled
from contin.pde.protocol import Equations
from contin.pde.schema import LARGEST_GRID, AxisEntry, PdeEntry
from contin.pde.slots import Slots
from contin.pde.unknowns import Unknowns
from contin.records import Json, Record

_EXAMPLES: Final = {
    "name": "add `name: my-model`",
    "domain": "add `domain: {x: {from: 0, to: 1, points: 100}}`",
    "fields": "add `fields: {u: 0}`",
    "equations": "add `equations: {u: dxx(u) + ...}`",
    "points": "say how many nodes: `points: 100`",
}


def problem_from_mapping(mapping: Record, source: Source, version_required: bool = False) -> PdeProblem:
    """The problem in plain data; `source` finds places for messages."""
    problems = Problems(source)
    check_version(mapping, problems, version_required)
    entry = _validated(plain(mapping), problems)
    return _Builder(entry, problems).build()


def _validated(data: Json, problems: Problems) -> PdeEntry:
    data = {key: value for key, value in data.items() if value is not None}
    try:
        return PdeEntry.model_validate(data)
    except ValidationError as error:
        for item in error.errors(include_url=False, include_context=False):
            note(item, problems, _allowed, _EXAMPLES, {"too_long": "a domain has one axis or two"})
        problems.raise_if_any()
        raise InputError(str(error)) from None


def _allowed(path: Path) -> list[str]:
    entry = PdeEntry if not path else AxisEntry if path[0] == "domain" else ParameterEntry
    return [field.alias or name for name, field in entry.model_fields.items()]


class _PdeFormulas(Formulas):
    """Formulas that may contain derivatives of fields."""

    calls: Mapping[str, Calls] = {}

    @property
    def scope(self) -> Scope:
        return Scope(self.names, self.functions, self.conditions, self.unavailable, self.budget, self.calls)


class _Builder:
    def __init__(self, entry: PdeEntry, problems: Problems) -> None:
        self.entry, self.problems = entry, problems
        self.fields = [canonical_name(n) for n in entry.fields]
        self.names = [canonical_name(n) for n in entry.parameters]
        self._check_names()
        self.axes = [canonical_name(n) for n in entry.domain]
        observed = {
            canonical_name(n): f"{n} is an observable; put it under definitions to use it in formulas"
            for n in entry.observables
        }
        self.formulas = _PdeFormulas(problems, [*self.fields, *self.axes, *self.names], observed)
        self.grid = self._grid()
        self.slots = Slots(self.grid, self.fields)
        self.formulas.calls = self.slots.calls()
        self.formulas.declare(entry.functions, entry.definitions)
        varying = {n: f"{n} is a field; values here are formulas in the parameters" for n in self.fields}
        fixed = {n: f"{n} is a coordinate; values here are formulas in the parameters" for n in self.axes}
        self.constants = self.formulas.scope_of(self.names, {**varying, **fixed})
        self.guesses = self.formulas.scope_of([*self.names, *self.axes], varying)

    def build(self) -> PdeProblem:
        entry = self.entry
        parameters = [self._parameter(n) for n in entry.parameters]
        guess = Start("", {canonical_name(n): self.formulas.read(v, ("fields", n), self.guesses)
                           for n, v in entry.fields.items()})  # fmt: skip
        equations = self._equations()
        conditions = ConditionReader(self.formulas, self.slots, self.grid).read(entry.boundary)
        measures = MeasureReader(self.formulas, self.slots, self.grid)
        observables = {canonical_name(n): measures.read(v, ("observables", n)) for n, v in entry.observables.items()}
        starts = [
            self._start(n, {**(s.model_extra or {}), "parameters": s.parameters}, ("starts", n))
            for n, s in entry.starts.items()
        ]
        for name in entry.starts:
            check_label(name, ("starts", name), self.problems)
        if not self.problems:
            self._check_values(parameters)
        self.problems.raise_if_any()
        system = Discretised(equations, self.slots, Unknowns(self.grid, self.fields, conditions))
        described = {"name": entry.name, "title": entry.title, "source": entry.source, "expect": self._expected(),
                     "mass": system.mass}  # fmt: skip
        observer = Observer(system, observables, measures.found)
        held = self._conserving(system, parameters)
        moving = self._travelling(held, parameters)
        velocity = None if entry.travelling is None else canonical_name(entry.travelling.velocity)
        return PdeProblem(
            moving or held, observer, parameters, starts, guess, self._read_start, described, velocity
        )

    def _conserving(self, system: Discretised, parameters: list[Parameter]) -> Equations:
        """The equations with the means held that the file gives."""
        given, path = dict(self.entry.conserved), ("conserved",)
        means = self.formulas.by_name(given, self.fields, "field", path, self.constants)
        self.problems.raise_if_any()
        if not means:
            return system
        try:
            return Conserving(system, means, parameter_values(parameters, []))
        except InputError as error:
            self.problems.add(path, str(error), key=True)
            self.problems.raise_if_any()
            raise

    def _travelling(self, system: Equations, parameters: list[Parameter]) -> Travelling | None:
        """The equations in the frame that moves with a wave, where the file asks for it."""
        item = self.entry.travelling
        if item is None:
            return None
        path: Path = ("travelling",)
        circles = [axis.name for axis in self.grid.axes if axis.periodic]
        name = canonical_name(item.axis)
        if name not in circles:
            known = f"periodic are {', '.join(circles)}" if circles else "no axis is periodic"
            self.problems.add((*path, "axis"), f"waves travel along a periodic axis: {name} is none; {known}")
        wave = self.formulas.by_name(item.like, self.fields, "field", (*path, "like"), self.guesses)
        taken = {*self.fields, *self.axes, *self.names, *map(canonical_name, self.entry.observables)}
        if canonical_name(item.velocity) in taken:
            self.problems.add((*path, "velocity"), f"{item.velocity} is declared already; choose another name")
        self.problems.raise_if_any()
        formulas = {field: wave.get(field, number(0)) for field in self.fields}
        like = sampled(system, formulas, parameter_values(parameters, []))
        try:
            return Travelling(system, self.axes.index(name), like)
        except InputError as error:
            self.problems.add((*path, "like"), str(error), key=True)
            self.problems.raise_if_any()
            raise

    def _read_start(self, mapping: Record) -> Start:
        """A start given where a run or a call needs one."""
        problems = self.formulas.problems = Problems(CallSource(f"start of {self.entry.name}"))
        start = self._start("", plain(mapping), (), problems)
        problems.raise_if_any()
        return start

    # parts ------------------------------------------------------------------------------------------------------------

    def _check_names(self) -> None:
        seen: dict[str, str] = {}
        for section in ("domain", "fields", "parameters", "definitions", "observables"):
            for key in getattr(self.entry, section):
                name = canonical_name(key)
                if not check_name(name, (section, key), self.problems):
                    continue
                if name in seen:
                    self.problems.add((section, key), f"{name} is already declared under {seen[name]}", key=True)
                seen.setdefault(name, section)
        self.problems.raise_if_any()

    def _grid(self) -> Grid:
        axes = [self._axis(key, item) for key, item in self.entry.domain.items()]
        self.problems.raise_if_any()
        grid = Grid(tuple(axes))
        if grid.size > LARGEST_GRID:
            self.problems.add(("domain",), f"{grid.size} nodes; at most {LARGEST_GRID} are taken", key=True)
        self.problems.raise_if_any()
        return grid

    def _axis(self, key: str, item: AxisEntry) -> Axis:
        path: Path = ("domain", key)
        advice = "the ends of a domain are numbers; scale the equations instead"
        numbers = self.formulas.scope_of([], dict.fromkeys(self.names, advice))
        low, high = (
            float(evaluate(self.formulas.read(v, (*path, word), numbers), {}))
            for word, v in (("from", item.start), ("to", item.end))
        )
        if not low < high or abs(low) == float("inf") or high == float("inf"):
            self.problems.add(path, f"expected from < to, got {low:g} and {high:g}", key=True)
        periodic = item.periodic or item.method == "fourier"
        if item.method == "chebyshev" and item.periodic:
            self.problems.add((*path, "method"), "chebyshev is for an axis with two ends; a circle takes fourier")
        least = 5 if periodic else 4
        if item.points < least:
            self.problems.add((*path, "points"), f"expected {least} nodes or more, got {item.points}")
        return Axis(canonical_name(key), low, high, item.points, item.method, periodic)

    def _parameter(self, key: str) -> Parameter:
        item, path, name = self.entry.parameters[key], ("parameters", key), canonical_name(key)
        read = self.formulas.read
        if not isinstance(item, ParameterEntry):
            return Parameter(name, read(item, path, self.constants))
        bounds = None
        if item.range is not None:
            low, high = (read(v, (*path, "range", i), self.constants) for i, v in enumerate(item.range))
            bounds = (low, high)
        return Parameter(
            name, read(item.value, (*path, "value"), self.constants), bounds, item.unit, item.description
        )

    def _check_values(self, parameters: list[Parameter]) -> None:
        try:
            parameter_values(parameters, [])
        except (InputError, ArithmeticError) as error:
            self.problems.add(("parameters",), str(error), key=True)

    def _equations(self) -> dict[str, Expression]:
        found: dict[str, Expression] = {}
        for key, text in self.entry.equations.items():
            name = canonical_name(key)
            if name not in self.fields:
                advice = closest(name, self.fields) or f"fields are {', '.join(self.fields)}"
                self.problems.add(("equations", key), f"{name} is not a field: {advice}", key=True)
                continue
            found[name] = self.formulas.read(text, ("equations", key), self.formulas.scope)
        for name in self.fields:
            if name not in found:
                self.problems.add(("equations",), f"no equation for {name}; add `{name}: ...`", key=True)
                found[name] = number(0)
        return found

    def _start(self, name: str, data: Record, path: Path, problems: Problems | None = None) -> Start:
        values = dict(data)
        overrides = values.pop("parameters", None) or {}
        given, held = self.formulas.by_name, (*path, "parameters")
        fields = given(values, self.fields, "field", path, self.guesses, problems)
        return Start(name, fields, given(overrides, self.names, "parameter", held, self.constants, problems))


    def _expected(self) -> list[dict[str, Any]]:
        """Expectations with their numbers worked out."""
        found = []
        for i, item in enumerate(self.entry.expect):
            points = item.at if isinstance(item.at, list) else [item.at]
            at = []
            for k, point in enumerate(points):
                path: Path = ("expect", i, "at", k) if isinstance(item.at, list) else ("expect", i, "at")
                values = {n: self.formulas.read(v, (*path, n), self.constants) for n, v in point.items()}
                at.append({n: float(evaluate(e, {})) for n, e in values.items()})
            found.append({"label": item.label, "at": at, "run": item.run or (), "tolerance": item.tolerance})
        self.problems.raise_if_any()
        return found

