"""Solutions as plain data and back, digit by digit: numbers, arrays, formulas, compiled models, parts of problems.

    1.5, "x", true, null    themselves              {"list": [..]}, {"map": [[key, value], ..]}
    [..]                    a tuple                 {"number": "nan"}, {"complex": [re, im]}
    {"array": base64 of its bytes, "kind": "<f8", "shape": [..]}
    {"formulas": ..}        a formula or a part of a model (`contin.model.graph_text`)
    {"model": number}, {"system": number}           of the file's table of models and systems
    {"part": NAME, "fields": {..}}                  of the table `contin.store.parts`

Reading makes these and nothing else: nothing is executed or imported that the file names.
"""

from __future__ import annotations

import base64
import binascii
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.lowering.system import CompiledSystem, compile_in_time, compile_system
from contin.model.expression import Expression, symbols_in
from contin.model.graph_text import PARTS as MODEL_PARTS
from contin.model.graph_text import from_graph, model_graph, model_of_graph, to_graph
from contin.model.model import Model
from contin.model.parts import Condition
from contin.model.yaml_loader import load_model_text
from contin.records import Fields, Json, Record
from contin.store.parts import PARTS, made_of, name_of

KINDS: Final = frozenset({"<f8", "<c16", "<i8", "|b1", "<i4"})


class NotKeptError(InputError):
    """Something that a file cannot hold, such as a Python function."""


@dataclass
class Table:
    """The models and compiled models that solutions refer to by number, in the order in which they were met."""

    models: list[Model] = field(default_factory=list)
    systems: list[CompiledSystem] = field(default_factory=list)
    _places: dict[int, int] = field(default_factory=dict)

    def model(self, model: object) -> int:
        if not isinstance(model, Model):
            raise NotKeptError("its equations are Python functions, which no file can hold")
        return self._place(model, self.models)

    def system(self, system: CompiledSystem) -> int:
        self.model(system.written)
        return self._place(system, self.systems)

    def _place(self, thing: Json, things: list[Json]) -> int:
        if id(thing) not in self._places:
            self._places[id(thing)] = len(things)
            things.append(thing)
        return self._places[id(thing)]

    def document(self) -> Fields:
        """As plain data."""
        return {
            "models": [model_graph(model) for model in self.models],
            "systems": [
                {"model": self.model(s.written), "regular": bool(s.regular), "timed": bool(s.timed)}
                for s in self.systems
            ],
        }

    @classmethod
    def of(cls, document: Record) -> Table:
        """From plain data; ValueError where the models are none.

        What is read without checks is written as a model file, and read again by the reader that checks it. Names with
        a colon, of equations that contin makes (connections with cycles), are no user's: others stand for them there;
        and so are conditions on constants alone (the equilibrium that an orbit leaves).
        """
        models = [model_of_graph(data) for data in document["models"]]
        for data in document["models"]:
            model = model_of_graph(_without_colons(data))
            load_model_text(_with_ends(model).text(), model.name, check=False)
        systems = []
        for entry in document["systems"]:
            model = models[_count(entry["model"])]
            systems.append(compile_in_time(model) if entry["timed"] else compile_system(model, bool(entry["regular"])))
        return cls(models, systems)


def _with_ends(model: Model) -> Model:
    """The model with a value at an end added to conditions that have none: a model file asks for one."""
    known = model.functionals
    end = next((name for name, part in known.items() if part.kind in ("start", "end")), None)
    if end is None:
        return model
    said = [any(name in known for name in symbols_in([c.residual])) for c in model.conditions]
    conditions = tuple(
        c if full else Condition(f"{end} + {c.text}", c.residual)
        for c, full in zip(model.conditions, said, strict=True)
    )
    return Model.from_parts(**{f.name: getattr(model, f.name) for f in fields(model)} | {"conditions": conditions})


def _without_colons(data: Json) -> Json:
    """The same data with names that a model file may have."""
    if isinstance(data, str):
        return data.replace(":", "_of_")
    if isinstance(data, list):
        return [_without_colons(item) for item in data]
    if isinstance(data, dict):
        return {_without_colons(key): _without_colons(value) for key, value in data.items()}
    return data


def encode(value: object, table: Table) -> Json:
    """A value as plain data; NotKeptError for what has no such form."""
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, np.ndarray | np.generic):
        return _encoded_array(np.asarray(value))
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"number": repr(value)}
    if isinstance(value, complex):
        return {"complex": [encode(value.real, table), encode(value.imag, table)]}
    if isinstance(value, tuple):
        if hasattr(value, "_fields"):
            raise NotKeptError(f"it holds a {type(value).__name__}, which has no form in a file")
        return [encode(item, table) for item in value]
    if isinstance(value, list):
        return {"list": [encode(item, table) for item in value]}
    if isinstance(value, Mapping):
        return {"map": [[encode(k, table), encode(v, table)] for k, v in value.items()]}
    return _encoded_object(value, table)


def _encoded_object(value: object, table: Table) -> Fields:
    if isinstance(value, Model):
        return {"model": table.model(value)}
    if isinstance(value, CompiledSystem):
        return {"system": table.system(value)}
    kind = type(value)
    if isinstance(value, Expression) or MODEL_PARTS.get(kind.__name__) is kind:
        return {"formulas": to_graph({"": value})}
    name = name_of(kind)
    if name is None:
        raise NotKeptError(
            "files keep models of formulas, not Python functions, large sparse systems, or this kind of solution "
            f"({kind.__name__}): compute its branch again"
        )
    part = PARTS[name]
    kept = part.of or tuple(f.name for f in fields(value) if f.name not in part.made)  # type: ignore[arg-type]
    return {"part": name, "fields": {key: encode(getattr(value, key), table) for key in kept}}


def _encoded_array(value: np.ndarray[tuple[int, ...], np.dtype[np.generic]]) -> Fields:
    kind = value.dtype.newbyteorder("<").str
    if kind not in KINDS:
        raise NotKeptError(f"it holds an array of {value.dtype}, which has no form in a file")
    data = np.ascontiguousarray(value).astype(kind).tobytes()
    return {"array": base64.b64encode(data).decode("ascii"), "kind": kind, "shape": list(value.shape)}


def decode(data: Json, table: Table) -> Json:
    """The value; ValueError, KeyError, TypeError or IndexError where the data are none."""
    if isinstance(data, list):
        return tuple(decode(item, table) for item in data)
    if not isinstance(data, dict):
        return data
    if "array" in data:
        return _decoded_array(data)
    if "number" in data:
        return float(str(data["number"]))
    if "complex" in data:
        real, imaginary = (decode(item, table) for item in data["complex"])
        return complex(real, imaginary)
    if "list" in data:
        return [decode(item, table) for item in data["list"]]
    if "map" in data:
        return {decode(key, table): decode(value, table) for key, value in data["map"]}
    if "formulas" in data:
        return from_graph(data["formulas"])[""]
    if "model" in data:
        return table.models[_count(data["model"])]
    if "system" in data:
        return table.systems[_count(data["system"])]
    return made_of(data["part"], {key: decode(value, table) for key, value in data["fields"].items()})


def _decoded_array(data: Record) -> Json:
    if data["kind"] not in KINDS:
        raise ValueError(f"no kind of array {data['kind']!r}")
    try:
        raw = base64.b64decode(data["array"], validate=True)
    except binascii.Error as error:
        raise ValueError(str(error)) from None
    shape = tuple(_count(k) for k in data["shape"])
    found: Array = np.frombuffer(raw, data["kind"]).reshape(shape).copy()
    return found if shape else found[()]


def _count(value: Json) -> int:
    if type(value) is not int or value < 0:
        raise ValueError(f"expected a count, got {value!r}")
    return value
