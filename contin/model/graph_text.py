"""A model as JSON that keeps its formulas node by node: what is read back is built exactly alike.

A model file (`contin.model.writer`) shows formulas as people write them; a formula read from it means the same and may
be built otherwise, so that its last digits differ. Here every node is a row, operands before their users:

    ["number", "2/3"]  ["number", 0.1e-20]  ["symbol", "x"]  ["add", 0, 1]

Reading makes nodes of the known operations and parts of a model, from plain data, and nothing else.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields
from fractions import Fraction
from typing import Any, Final

from contin.model.expression import COMPARISONS, Expression, exactly, postorder
from contin.model.model import Model
from contin.model.parts import (
    Averaging,
    Condition,
    Constraints,
    Event,
    Expectation,
    Forcing,
    Functional,
    Interval,
    Limit,
    Oscillator,
    Parameter,
    Rotator,
    Start,
    State,
    Symmetry,
    Total,
    VanishingMass,
)
from contin.model.relations import Relation
from contin.model.scope import Function
from contin.model.vocabulary import FUNCTIONS, LOGICAL
from contin.records import Fields, Json, Record

PARTS: Final = {
    kind.__name__: kind
    for kind in (
        Averaging, Condition, Constraints, Event, Expectation, Forcing, Function, Functional, Interval, Limit,
        Oscillator, Parameter, Relation, Rotator, Start, State, Symmetry, Total,
        VanishingMass,
    )
}  # fmt: skip
OPERATIONS: Final = frozenset({"number", "symbol", "pi", "add", "mul", "pow", "if"}) | COMPARISONS | LOGICAL | FUNCTIONS
_PLAIN: Final = (str, bool, int, float, type(None))


def to_graph_text(model: Model) -> str:
    """The text; TypeError for a model that holds anything but formulas and plain data."""
    return json.dumps(to_graph(_parts_of(model)), separators=(",", ":"))


def from_graph_text(text: str) -> Model:
    """The model of such a text; ValueError where it is no such text."""
    try:
        return model_of_graph(json.loads(text))
    except RecursionError:
        raise ValueError("this is no model: nested too deeply") from None


def model_of_graph(data: Json) -> Model:
    """The model of such data; ValueError where it is none."""
    try:
        return Model.from_parts(**from_graph(data))
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"this is no model: {error}") from None


def model_graph(model: Model) -> Fields:
    """A model as such data."""
    return to_graph(_parts_of(model))


def to_graph(value: Record) -> Fields:
    """Formulas, parts of models and plain data by name; TypeError for anything else."""
    roots: list[Expression] = []
    _collect(value, roots)
    places: dict[Expression, int] = {}
    rows: list[list[object]] = []
    for node in postorder(roots):
        places[node] = len(rows)
        rows.append(_row(node, places))
    return {"nodes": rows, "parts": {str(name): _plain(item, places) for name, item in value.items()}}


def from_graph(data: Json) -> Fields:
    """What `to_graph` was given; ValueError where this is no such data."""
    try:
        nodes: list[Expression] = []
        for row in data["nodes"]:
            nodes.append(_node(row, nodes))
        return {name: _value(value, nodes) for name, value in data["parts"].items()}
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        raise ValueError(f"these are no formulas: {error}") from None


def _parts_of(model: Model) -> Fields:
    return {f.name: getattr(model, f.name) for f in fields(model)}


def _collect(value: Json, roots: list[Expression]) -> None:
    if isinstance(value, Expression):
        roots.append(value)
    elif isinstance(value, Mapping):
        _collect(list(value.values()), roots)
    elif isinstance(value, tuple | list):
        for item in value:
            _collect(item, roots)
    elif type(value).__name__ in PARTS:
        _collect([getattr(value, f.name) for f in fields(value)], roots)


def _row(node: Expression, places: Mapping[Expression, int]) -> list[Any]:
    if node.op == "number":
        return ["number", str(node.value) if isinstance(node.value, Fraction) else node.value]
    if node.op == "symbol":
        return ["symbol", node.value]
    return [node.op, *(places[a] for a in node.args)]


def _node(row: list[Any], nodes: list[Expression]) -> Expression:
    op, *rest = row
    if op not in OPERATIONS:
        raise ValueError(f"no operation {op!r}")
    if op == "number":
        (value,) = rest
        if isinstance(value, float):
            return exactly(op, (), math.nan if math.isnan(value) else value)  # there is one NaN node
        return exactly(op, (), Fraction(str(value)))
    if op == "symbol":
        (name,) = rest
        return exactly(op, (), str(name))
    if any(type(k) is not int or not 0 <= k < len(nodes) for k in rest):
        raise ValueError(f"no operands {rest}")
    return exactly(op, tuple([nodes[k] for k in rest]))


def _plain(value: object, places: Mapping[Expression, int]) -> Json:
    """Plain data as they are; anything else as a list that begins with its kind."""
    if isinstance(value, Expression):
        return ["formula", places[value]]
    if type(value) in _PLAIN:
        return value
    if isinstance(value, Mapping):
        return ["mapping", *([str(key), _plain(item, places)] for key, item in value.items())]
    if isinstance(value, tuple):
        return ["tuple", *(_plain(item, places) for item in value)]
    if isinstance(value, list):
        return ["list", *(_plain(item, places) for item in value)]
    if PARTS.get(type(value).__name__) is type(value):
        return ["part", type(value).__name__, *(_plain(getattr(value, f.name), places) for f in fields(value))]
    raise TypeError(f"a model with {type(value).__name__} has no such text")


def _value(data: object, nodes: list[Expression]) -> Json:
    if not isinstance(data, list):
        return data
    kind, *rest = data
    if kind == "formula":
        return nodes[rest[0]]
    if kind == "mapping":
        return {key: _value(item, nodes) for key, item in rest}
    if kind == "part":
        return PARTS[rest[0]](*[_value(item, nodes) for item in rest[1:]])
    items = [_value(item, nodes) for item in rest]
    if kind == "tuple":
        return tuple(items)
    if kind == "list":
        return items
    raise ValueError(f"no kind {kind!r}")
