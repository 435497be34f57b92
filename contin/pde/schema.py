"""The shape of a model file of kind: pde."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema

from contin.limits import brief
from contin.model.schema import FORMAT_VERSION, ExpectEntry, Formula, Name, Parameter, StartEntry, Text, _fail
from contin.records import Fields

LARGEST_GRID = 1_000_000  # nodes


def _count(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int) or not 3 <= value <= LARGEST_GRID:
        raise _fail(f"expected a whole number of nodes from 3 to {LARGEST_GRID}, got {brief(value)}")
    return value


def _texts(value: object) -> object:
    return [value] if isinstance(value, str) else value


_TEXTS = {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}


class _Entry(BaseModel):
    model_config = ConfigDict(
        extra="forbid", arbitrary_types_allowed=True, strict=True, defer_build=True, populate_by_name=True
    )


class AxisEntry(_Entry):
    """A coordinate of the domain: its ends, its nodes, and how derivatives are made."""

    start: Formula = Field(default=0, alias="from")
    end: Formula = Field(default=1, alias="to")
    points: Annotated[int, BeforeValidator(_count)]
    method: Literal["differences", "chebyshev", "fourier"] = "differences"
    periodic: bool = False


class TravellingEntry(_Entry):
    """The frame that moves with waves: along which axis, the velocity's name, a wave for the phase."""

    axis: Name
    velocity: Name = "c"
    like: Annotated[dict[str, Formula], Field(min_length=1)]


class PdeEntry(_Entry):
    """A whole model file of kind: pde."""

    contin: int = FORMAT_VERSION
    name: Text
    kind: Literal["pde"]
    title: Text | None = None
    source: Text | None = None
    description: Text | None = None
    domain: Annotated[dict[Name, AxisEntry], Field(min_length=1, max_length=2)]
    fields: Annotated[dict[str, Formula], Field(min_length=1)]
    parameters: dict[str, Parameter] = {}
    functions: dict[str, Formula] = {}
    definitions: dict[str, Formula] = {}
    equations: dict[str, Formula]
    boundary: dict[str, Annotated[list[Text], BeforeValidator(_texts), WithJsonSchema(_TEXTS)]] = {}
    observables: dict[str, Formula] = {}
    conserved: dict[str, Formula] = {}
    travelling: TravellingEntry | None = None
    starts: dict[str, StartEntry] = {}
    expect: list[ExpectEntry] = []


def pde_schema() -> Fields:
    """JSON Schema (draft 2020-12) of a model file of kind: pde; names and formulas are checked only on loading."""
    schema = PdeEntry.model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": f"contin model file of kind: pde, format {FORMAT_VERSION}",
        "required": ["contin", *schema["required"]],
    }
