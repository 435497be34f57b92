"""Starts as they are written: states, and `parameters`, to values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.model import schema
from contin.model.expression import is_condition
from contin.model.inline import Formulas
from contin.model.parts import Start
from contin.model.scope import Scope
from contin.model.shape import plain
from contin.model.source import CallSource, Path, Problems
from contin.records import Record

if TYPE_CHECKING:
    from contin.model.model_parts import ModelParts


def start_from_mapping(model: ModelParts, mapping: Record) -> Start:
    """A start written as a mapping of states, and `parameters`, to values."""
    problems = Problems(CallSource(f"start of model {model.name}"))
    data = plain(mapping)
    for name, value in list(data.items()):
        if (name != "parameters" and isinstance(value, (bool, dict, list))) or value is None:
            problems.add((name,), f"expected a number or a formula, got {schema.shown(value)}")
    if not isinstance(data.get("parameters", {}), dict):
        problems.add(("parameters",), "expected a mapping {name: value}")
    problems.raise_if_any()
    formulas = Formulas(problems, [*model.state_names, *model.parameter_names], {})
    formulas.functions = dict(model.functions)
    formulas.definitions = dict(model.definitions)
    formulas.conditions = {n for n, e in model.definitions.items() if is_condition(e)}
    time = None if model.interval is None else model.interval.name
    reader = StartReader(formulas, list(model.starting_names), list(model.parameter_names), problems, time)
    start = reader.read("", data, ())
    problems.raise_if_any()
    return start


class StartReader:
    """Reads starts: the states' values may use the parameters, and `time` where they are functions of it."""

    def __init__(
        self, formulas: Formulas, states: list[str], parameters: list[str], problems: Problems, time: str | None = None
    ) -> None:
        self.formulas, self.states, self.parameters, self.problems = formulas, states, parameters, problems
        hidden = {s: f"{s} is a state; values here are formulas in the parameters" for s in states}
        self.constants: Scope = formulas.scope_of(parameters, hidden)
        self.scope = self.constants if time is None else formulas.scope_of([*parameters, time], hidden)

    def read(self, name: str, data: Record, path: Path) -> Start:
        values = dict(data)
        overrides = values.pop("parameters", None) or {}
        given, held = self.formulas.by_name, (*path, "parameters")
        states = given(values, self.states, "state", path, self.scope)
        parameters = given(overrides, self.parameters, "parameter", held, self.constants)
        return Start(name, states, parameters)
