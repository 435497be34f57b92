"""Kinds of value in run files: names, files, intervals, counts; and the base of every part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, PlainValidator, Tag, WithJsonSchema
from pydantic_core import PydanticCustomError

from contin.limits import LARGEST_COUNT, as_double, is_finite
from contin.model.schema import Formula, Range, Text, shown


def wrong(message: str) -> PydanticCustomError:
    """A mistake in words."""
    return PydanticCustomError("contin", "{text}", {"text": message})  # braces in the text itself stay as they are


def _run_name(value: object) -> object:
    if not isinstance(value, str) or not value.strip():
        raise wrong(f"expected a name, got {shown(value)}")
    if not value.isprintable():
        raise wrong(f"a run's name may not contain control characters, got {shown(value)}")
    if "." in value:
        raise wrong(f"a run's name may not contain a dot (`from: NAME.LABEL` is split there), got {shown(value)}")
    return value


def _reference(value: object) -> object:
    name, dot, label = value.rpartition(".") if isinstance(value, str) else ("", "", "")
    if not (name and dot and label):
        raise wrong(f"expected NAME.LABEL, such as line.BP1, got {shown(value)}")
    return value


def _interval(value: object) -> object:
    if isinstance(value, list) and any(isinstance(one, list) for one in value):
        several = "{NAME: [low, high], OTHER: [low, high]}"
        raise wrong(f"expected [low, high]; the ranges of several parameters are {several}")
    numbers = [as_double(v) for v in value if isinstance(v, int | float)] if isinstance(value, list) else []
    if len(numbers) == 2 and not numbers[0] < numbers[1]:
        raise wrong(f"expected [low, high] with low < high, got [{numbers[0]:g}, {numbers[1]:g}]")
    return value


def _positive(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | float) or not (value > 0 and is_finite(value)):
        raise wrong(f"expected a positive number, got {shown(value)}")
    return float(value)


def not_negative(value: object) -> object:
    """A number, 0 or more."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not (value >= 0 and is_finite(value)):
        raise wrong(f"expected 0 or a positive number, got {shown(value)}")
    return float(value)


def _count(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise wrong(f"expected a whole number, 1 or more, got {shown(value)}")
    if value > LARGEST_COUNT:
        raise wrong(f"expected a whole number, {LARGEST_COUNT} at most, got {shown(value)}")
    return value


def listed(value: object) -> object:
    """One value as a list of it."""
    return value if isinstance(value, list) else [value]


def _file(value: object) -> object:
    if not isinstance(value, str) or not value.strip():
        raise wrong(f"expected a file name, got {shown(value)}")
    return value


def mapping_or_not(value: object) -> str:
    """The tag of the short or the long form."""
    return "(long)" if isinstance(value, Mapping) else "(short)"


Positive = Annotated[float, PlainValidator(_positive), WithJsonSchema({"type": "number", "exclusiveMinimum": 0})]
Count = Annotated[
    int, PlainValidator(_count), WithJsonSchema({"type": "integer", "minimum": 1, "maximum": LARGEST_COUNT})
]
RunName = Annotated[str, PlainValidator(_run_name), WithJsonSchema({"type": "string", "pattern": r"^[^.]+$"})]
Reference = Annotated[str, PlainValidator(_reference), WithJsonSchema({"type": "string", "pattern": r"^.+\..+$"})]
File = Annotated[str, PlainValidator(_file), WithJsonSchema({"type": "string"})]
Interval = Annotated[Range, BeforeValidator(_interval)]
Ranges = Annotated[
    Annotated[Interval, Tag("(short)")] | Annotated[dict[str, Interval], Tag("(long)")], Discriminator(mapping_or_not)
]
Formulas = Annotated[list[Formula], BeforeValidator(listed, json_schema_input_type=Formula | list[Formula])]
Texts = Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text]), Field(min_length=1)]


class Section(BaseModel):
    """Base of every part: unknown keys are mistakes, not ignored.

    `defer_build`: a validator is made for what is read, not for each of its parts once more (50 ms of every start).
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, arbitrary_types_allowed=True, defer_build=True)
