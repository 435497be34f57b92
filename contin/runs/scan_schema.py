"""The shape of a scan file: which simulations to make, when each has settled, and how to name what it settled on."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Discriminator, Field, PlainValidator, Tag, WithJsonSchema

from contin.limits import MOST_RUNS
from contin.model.schema import FORMAT_VERSION, Formula, Text
from contin.runs.entry_types import Count, File, Positive, Section, listed
from contin.runs.picture_entry import Picture
from contin.runs.schema import ModelReference, Pass, Start, Starts, _version


class AxisEntry(Section):
    """Equally spaced values, both ends included."""

    from_: Formula = Field(alias="from")
    to: Formula
    points: Annotated[Count, Field(le=MOST_RUNS)]


def _list_or_not(value: object) -> str:
    return "(short)" if isinstance(value, list) else "(long)"


Axis = Annotated[
    Annotated[list[Formula], Tag("(short)")] | Annotated[AxisEntry, Tag("(long)")], Discriminator(_list_or_not)
]


def _named_or_not(value: object) -> str:
    """One start written as a mapping, or several as {name: start}; `parameters: {..}` belongs to a start."""
    if not isinstance(value, dict) or not value or set(value) == {"parameters"}:
        return "(short)"
    return "(long)" if all(isinstance(part, dict) for part in value.values()) else "(short)"


NamedStarts = Annotated[
    Annotated[Starts, Tag("(short)")] | Annotated[dict[str, Start], Tag("(long)")], Discriminator(_named_or_not)
]


class SettleEntry(Section):
    """When a run has settled: see `contin.simulate.steady.Criterion`."""

    window: Positive | None = None
    tolerance: Positive | None = None
    longest: Positive | None = None
    samples: Count | None = None
    rtol: Positive | None = None
    box: Positive | None = None


class ScanEntry(Section):
    """`axes` are parameters (a scan) or states (basins of attraction), or both; each start is run at each point."""

    axes: Annotated[dict[str, Axis], Field(min_length=1, max_length=4)]
    starts: NamedStarts | None = None
    measures: dict[str, Text] = Field(default_factory=dict)
    classes: dict[str, Text] = Field(default_factory=dict)
    settle: SettleEntry = SettleEntry()


class ScanOutputsEntry(Section):
    """Files to write, in or below the scan file's folder; `save` is the store that a killed scan resumes from."""

    plot: Picture | None = None
    csv: File | None = None
    json_: File | None = Field(default=None, alias="json")
    save: File | None = None


class ScanFileEntry(Section):
    """A whole scan file."""

    contin: Annotated[int, PlainValidator(_version), WithJsonSchema({"const": FORMAT_VERSION})] = FORMAT_VERSION
    model: ModelReference
    title: Text | None = None
    description: Text | None = None
    transform: Annotated[list[Pass], BeforeValidator(listed, json_schema_input_type=Pass | list[Pass])] = Field(
        default_factory=list
    )
    parameters: dict[str, Formula] = Field(default_factory=dict)
    scan: ScanEntry
    outputs: ScanOutputsEntry = ScanOutputsEntry()
