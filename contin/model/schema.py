"""The shape of a model file (FORMATS, section 1) as pydantic models: its keys, and what kind of value each has.

What the values mean (names, formulas, dependencies) is decided in `build`; here a formula is any text or number.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, PlainValidator, Tag, WithJsonSchema
from pydantic_core import PydanticCustomError

from contin.limits import brief, is_finite
from contin.model.expression import Expression
from contin.records import Fields

FORMAT_VERSION: Final = 1
TAGS: Final = frozenset({"(short)", "(long)", "(one)", "(several)"})  # parts of pydantic's paths that are not keys


def _fail(message: str) -> PydanticCustomError:
    # braces in the text would be read as fields of a template
    return PydanticCustomError("contin", "{text}", {"text": message})


def shown(value: object) -> str:
    """A value as it stands in YAML, for messages."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    return brief(value)


def _formula(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (int, float, str, Expression)):
        raise _fail(f"expected a number or a formula, got {shown(value)}")
    if isinstance(value, (int, float)) and not is_finite(value):
        raise _fail(f"expected a finite number, not above 1.8e308, got {shown(value)}")
    return value


def _text(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise _fail(f"expected a text, got {shown(value)}")
    text = value if isinstance(value, str) else str(value)
    bad = next((c for c in text if unicodedata.category(c) == "Cc" and c not in "\n\t"), None)
    if bad is not None:
        raise _fail(f"a text may not contain control characters (here U+{ord(bad):04X}), which could steer a terminal")
    return text


def _name(value: object) -> object:
    if not isinstance(value, str) or not value.isprintable():
        raise _fail(f"expected a name, got {shown(value)}")
    return value


def _tolerance(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not (value > 0 and is_finite(value)):
        raise _fail(f"expected a positive number, got {shown(value)}")
    return float(value)


def _version(value: object) -> object:
    if value != FORMAT_VERSION or isinstance(value, bool):
        raise _fail(f"expected the format version {FORMAT_VERSION}, got {shown(value)}")
    return value


def _pair(value: object) -> object:
    if not isinstance(value, list) or len(value) != 2:
        raise _fail(f"expected two values [low, high], got {shown(value)}")
    return value


def _long_or_short(value: object) -> str:
    return "(long)" if isinstance(value, (Mapping, BaseModel)) else "(short)"


def _one_or_several(value: object) -> str:
    return "(several)" if isinstance(value, list) else "(one)"


def _one_or_row(value: object) -> str:
    return "(several)" if isinstance(value, Mapping) else "(one)"


Formula = Annotated[Any, PlainValidator(_formula), WithJsonSchema({"type": ["number", "string"]})]
Text = Annotated[str, PlainValidator(_text), WithJsonSchema({"type": ["string", "number"]})]
Name = Annotated[str, PlainValidator(_name), WithJsonSchema({"type": "string", "pattern": r"^[^\W\d]\w*$"})]
Tolerance = Annotated[float, PlainValidator(_tolerance), WithJsonSchema({"type": "number", "exclusiveMinimum": 0})]
Range = Annotated[list[Formula], BeforeValidator(_pair), Field(min_length=2, max_length=2)]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True, strict=True, defer_build=True)


class StateEntry(_Entry):
    """A state: its default guess, and the period if it is an angle."""

    value: Formula
    unit: Text | None = None
    description: Text | None = None
    period: Formula | None = None
    minimum: Formula | None = None
    beyond: Text | None = None
    scale: Formula | None = None


class ParameterEntry(_Entry):
    """A parameter: its default value and the default range of runs."""

    value: Formula
    range: Range | None = None
    unit: Text | None = None
    description: Text | None = None
    scale: Formula | None = None


State = Annotated[
    Annotated[Formula, Tag("(short)")] | Annotated[StateEntry, Tag("(long)")], Discriminator(_long_or_short)
]
Parameter = Annotated[
    Annotated[Formula, Tag("(short)")] | Annotated[ParameterEntry, Tag("(long)")], Discriminator(_long_or_short)
]


Harmonic = Annotated[int, Field(ge=1, le=16)]
Mass = Annotated[
    Annotated[Formula, Tag("(one)")] | Annotated[dict[str, Formula], Tag("(several)")], Discriminator(_one_or_row)
]


class OscillatorEntry(_Entry):
    """One weakly nonlinear oscillator: the names of its two states; its frequency in units of the base frequency."""

    position: Name
    velocity: Name
    harmonic: Harmonic = 1


class RotatorEntry(_Entry):
    """A phase that turns with a frequency near `harmonic` times the base frequency."""

    phase: Name
    harmonic: Harmonic = 1


class AveragingEntry(_Entry):
    """The small parameter and the oscillators for the averaging pass, and what moves beside them."""

    small: Name
    oscillators: Annotated[list[OscillatorEntry], Field(min_length=1)]
    forcing: Harmonic = 1
    rotators: list[RotatorEntry] = []
    slow: list[Name] = []
    slaved: list[Name] = []


class ForcingEntry(_Entry):
    """Period in the time t of a forced flow."""

    period: Formula


class IntervalEntry(BaseModel):
    """The independent variable of a boundary-value problem and its ends."""

    model_config = ConfigDict(
        extra="forbid", arbitrary_types_allowed=True, strict=True, defer_build=True, populate_by_name=True
    )

    name: Name = "t"
    start: Formula = Field(default=0, alias="from")
    end: Formula = Field(default=1, alias="to")


class LimitEntry(_Entry):
    """Where the equations, an approximation, hold: margin >= 0; and what to say beyond."""

    margin: Formula
    beyond: Text
    accuracy: float = Field(default=0.0, ge=0.0, lt=1.0)


class EventEntry(_Entry):
    """Where `when` crosses zero in this direction, states jump to the values of `set`."""

    when: Formula
    direction: Literal["up", "down", "both"] = "both"
    set: dict[str, Formula]


class TotalEntry(_Entry):
    """A conserved total of a model that was reduced by it: the eliminated state with its default value, and the law."""

    state: Name
    value: Formula
    law: dict[str, Formula]
    unit: Text | None = None
    description: Text | None = None
    note: Text | None = None


Run = Fields
Points = Annotated[
    Annotated[dict[str, Formula], Tag("(one)")] | Annotated[list[dict[str, Formula]], Tag("(several)")],
    Discriminator(_one_or_several),
]
Runs = Annotated[Annotated[Run, Tag("(one)")] | Annotated[list[Run], Tag("(several)")], Discriminator(_one_or_several)]


class StartEntry(BaseModel):
    """A starting point: values of some states, and `parameters` that belong to it."""

    model_config = ConfigDict(extra="allow", arbitrary_types_allowed=True, defer_build=True)
    __pydantic_extra__: dict[str, Formula]
    parameters: dict[str, Formula] = {}


class ExpectEntry(_Entry):
    """The exact set of points of one type in one run, or in the last of several that start from each other."""

    label: Name
    at: Points
    tolerance: Tolerance = 1e-8
    run: Runs | None = None
    transform: list[Any] | None = None


class ModelEntry(_Entry):
    """A whole model file."""

    contin: Annotated[int, PlainValidator(_version), WithJsonSchema({"const": FORMAT_VERSION})] = FORMAT_VERSION
    name: Text
    title: Text | None = None
    source: Text | None = None
    description: Text | None = None
    kind: Literal["flow", "map", "bvp", "algebraic"] = "flow"
    time: IntervalEntry | None = None
    states: dict[str, State]
    parameters: dict[str, Parameter] = {}
    functions: dict[str, Formula] = {}
    definitions: dict[str, Formula] = {}
    equations: dict[str, Formula]
    mass: dict[str, Mass] = {}
    conditions: list[Text] = []
    observables: dict[str, Formula] = {}
    labels: dict[str, Text] = {}
    symmetries: dict[str, dict[str, Formula]] = {}
    rotation: dict[str, Formula] = {}
    starts: dict[str, StartEntry] = {}
    averaging: AveragingEntry | None = None
    forcing: ForcingEntry | None = None
    limits: list[LimitEntry] = []
    events: list[EventEntry] = []
    expect: list[ExpectEntry] = []
    conserved: bool | dict[str, TotalEntry] = True
