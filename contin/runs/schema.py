"""The shape of a run file (FORMATS, section 2) as pydantic models: its keys, and what kind of value each has.

What the names mean (parameters, states, starts) is decided in `plan`; here a number may also be a formula.
"""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    model_validator,
)

from contin.limits import LARGEST_TABLE, MOST_INTERVALS, MOST_POINTS
from contin.model.schema import FORMAT_VERSION, Formula, Range, Text, shown
from contin.records import Fields
from contin.runs.entry_types import (
    Count,
    File,
    Formulas,
    Interval,
    Positive,
    Ranges,
    Reference,
    RunName,
    Section,
    Texts,
    listed,
    mapping_or_not,
    not_negative,
    wrong,
)
from contin.runs.picture_entry import Picture


class StartMapping(BaseModel):
    """A starting point written in place: values of some states, and `parameters` that belong to it."""

    model_config = ConfigDict(extra="allow", arbitrary_types_allowed=True, defer_build=True)
    __pydantic_extra__: dict[str, Formula]
    parameters: dict[str, Formula] = {}


Start = Annotated[
    Annotated[Text, Tag("(short)")] | Annotated[StartMapping, Tag("(long)")], Discriminator(mapping_or_not)
]
Starts = Annotated[
    list[Start], BeforeValidator(listed, json_schema_input_type=Start | list[Start]), Field(min_length=1)
]
Pass = Annotated[Annotated[Text, Tag("(short)")] | Annotated[Fields, Tag("(long)")], Discriminator(mapping_or_not)]
ModelReference = Annotated[
    Annotated[Text, Tag("(short)")] | Annotated[Fields, Tag("(long)")], Discriminator(mapping_or_not)
]


class SettingsEntry(Section):
    """`settings` of a run; lengths are arclengths in the problem's metric."""

    step: Positive | None = None
    min_step: Positive | None = None
    max_step: Positive | None = None
    steps: Count | None = None
    max_angle: Annotated[Positive, Field(lt=90)] | None = None
    tolerance: Positive | None = None
    intervals: Annotated[Count, Field(ge=3, le=MOST_INTERVALS)] | None = None
    points: Annotated[Count, Field(ge=2, le=MOST_POINTS)] | None = None
    method: Literal["collocation", "shooting"] | None = None
    stop_at: Texts | None = None

    def chosen(self) -> Fields:
        """What was written, by name."""
        return self.model_dump(exclude_none=True)


MANY: Final = Field(max_length=6)
ORIGINS: Final = {"start": "start", "from": "from_", "samples": "samples"}  # where a run may begin, and its field


OF_CONNECTIONS: Final = {
    "to": "the saddle that a connecting orbit leads to",
    "truncation": "how near to its saddles a connecting orbit is cut",
    "reversor": "the reflection under which a connecting orbit is symmetric",
    "pulses": "how many turns a homoclinic orbit makes",
}
Kind = Literal["equilibrium", "orbit", "locus", "connection", "manifold", "torus"]


class ContinuationEntry(Section):
    """One run: from a start of the model, or from a point of an earlier branch."""

    name: RunName | None = None
    start: Start | None = None
    from_: Reference | None = Field(default=None, alias="from")
    samples: File | None = None  # a CSV file with one period of an orbit, or with a connecting orbit
    as_: Kind | None = Field(default=None, alias="as")
    to: Start | None = None  # of a connection: the saddle that the orbit from `start` leads to
    truncation: Annotated[Positive, Field(ge=1e-8, le=0.1)] | None = None  # distance of its ends from them, relative
    reversor: dict[str, Formula] | None = None  # ... images of states under a reflection that reverses time
    pulses: Annotated[Count, Field(ge=2, le=5)] | None = None  # turns, of orbits beside a homoclinic one (`from`)
    of: Start | None = None  # of a manifold: the equilibrium that it belongs to, or NAME.LABEL
    side: Literal["stable", "unstable"] | None = None
    dimension: Annotated[Count, Field(le=2)] | None = None
    length: Positive | None = None  # arclength of the orbits on it
    spacing: Positive | None = None  # of a surface: between neighbouring orbits
    parameter: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text]), MANY] = []
    range: Ranges | None = None
    direction: Literal["both", "up", "down"] = "both"
    values: dict[str, Formulas] = {}
    free: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text])] = []
    conditions: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text])] = []
    extrema: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text])] = []
    columns: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text])] = []
    settings: SettingsEntry = SettingsEntry()

    @model_validator(mode="after")
    def _one_origin(self) -> ContinuationEntry:
        self._check_manifold()
        self._check_torus()
        origins = [name for name, place in ORIGINS.items() if getattr(self, place) is not None]
        connects = self.as_ == "connection"
        if connects and "start" in origins:
            origins.remove("start")  # names the saddle that the orbit, whatever it comes from, leaves
        if len(origins) > 1:
            raise wrong(f"has both `{origins[0]}` and `{origins[1]}`; keep one of them")
        if self.samples is not None and self.as_ not in (None, "orbit", "connection"):
            raise wrong("has `samples` of an orbit; write `as: orbit`, `as: connection`, or nothing")
        if len(set(self.parameter)) < len(self.parameter):
            raise wrong(f"names {self.parameter[0]!r} twice in `parameter`")
        a_cycle = isinstance(self.start, str) and "." in self.start
        persists = len(self.parameter) == 1 and (self.to is not None or self.reversor is not None or a_cycle)
        enough = len(self.parameter) == 2 or persists
        turns = self.pulses is not None and self.from_ is not None  # the saddle is that of the orbit
        if connects and ((self.start is None and not turns) or not enough):
            one = " (one is enough where connections to a second saddle, `to`, or symmetric ones, `reversor`, persist)"
            raise wrong(f"is a connection: give `start`, the saddle that it leaves, and two parameters{one}")
        if self.pulses is not None and self.from_ is None:
            raise wrong("has `pulses`: give `from`, a label of a curve of homoclinic orbits")
        own = [(key, what) for key, what in OF_CONNECTIONS.items() if getattr(self, key) is not None]
        if not connects and own:
            raise wrong(f"has `{own[0][0]}`, {own[0][1]}; write `as: connection`")
        if len(self.parameter) > 1 and self.from_ is None and not connects:
            many = {2: "two", 3: "three"}.get(len(self.parameter), str(len(self.parameter)))
            raise wrong(f"{many} parameters need a point to start from; write `from: NAME.LABEL`")
        return self

    def _check_torus(self) -> None:
        """A torus starts at a label NS or from a simulation, and is followed in one parameter."""
        if self.as_ != "torus":
            return
        if (self.from_ is None and self.start is None) or len(self.parameter) != 1:
            origin = "`from: NAME.NS1`, where it is born (or `start`, from where a simulation settles on it)"
            raise wrong(f"is a torus: give {origin}, and one `parameter`")
        others = {"values": self.values, "free": self.free, "conditions": self.conditions, "extrema": self.extrema}
        others |= {"columns": self.columns}
        given = [key for key, value in others.items() if value]
        if given:
            raise wrong(f"is a torus, which has none of `{given[0]}`: leave it out")

    def _check_manifold(self) -> None:
        """A manifold has keys of its own, and everything else varies a parameter."""
        own = {"of": self.of, "side": self.side, "dimension": self.dimension, "length": self.length}
        own["spacing"] = self.spacing
        if self.as_ != "manifold":
            given = [key for key, value in own.items() if value is not None]
            if given:
                raise wrong(f"has `{given[0]}`, which belongs to a manifold; write `as: manifold`")
            if not self.parameter:
                raise wrong("needs `parameter`, the name of the parameter that varies")
            return
        if self.of is None or self.length is None:
            raise wrong("is a manifold: give `of`, its equilibrium (or NAME.LABEL), and `length`, an arclength")
        others = {"start": self.start, "from": self.from_, "samples": self.samples, "range": self.range}
        lists = ("parameter", "values", "free", "conditions", "extrema", "columns")
        others |= {name: getattr(self, name) or None for name in lists} | {"settings": self.settings.chosen() or None}
        given = [key for key, value in others.items() if value is not None]
        if given:
            raise wrong(f"is a manifold, at fixed parameters: leave out `{given[0]}`")


class BudgetEntry(Section):
    """Where the explorer stops."""

    branches: Count | None = None
    steps: Count | None = None
    work: Positive | None = None
    seconds: Positive | None = None


class DiagramEntry(Section):
    """The automatic explorer."""

    parameter: Text
    range: Ranges | None = None
    start: Starts | None = None
    box: dict[str, Range] | None = None
    orbits: bool = True
    columns: Annotated[list[Text], BeforeValidator(listed, json_schema_input_type=Text | list[Text])] = []
    values: dict[str, Formulas] = {}
    settings: SettingsEntry = SettingsEntry()
    budget: BudgetEntry = BudgetEntry()


class PhaseEntry(Section):
    """A phase diagram: curves of special points in two parameters, and the regions between them."""

    parameter: Annotated[Texts, Field(min_length=2, max_length=2)]
    range: Ranges | None = None
    start: Starts | None = None
    orbits: bool = True
    settings: SettingsEntry = SettingsEntry()

    @model_validator(mode="after")
    def _two_parameters(self) -> PhaseEntry:
        if len(set(self.parameter)) < 2:
            raise wrong(f"names {self.parameter[0]!r} twice in `parameter`; a phase diagram has two parameters")
        return self


class CrossingEntry(Section):
    """A Poincare section: where an expression crosses zero, upwards unless it says otherwise."""

    when: Text
    direction: Literal["up", "down", "both"] = "up"


WrittenSection = Annotated[
    Annotated[Text, Tag("(short)")] | Annotated[CrossingEntry, Tag("(long)")], Discriminator(mapping_or_not)
]


class SimulateEntry(Section):
    """A trajectory of the model as it is written (`transformed: true`: after the passes), and its files."""

    name: RunName | None = None
    transformed: bool = False
    start: Start | None = None
    parameters: dict[str, Formula] = {}
    time: Positive = 100.0
    transient: Annotated[float, PlainValidator(not_negative), WithJsonSchema({"type": "number", "minimum": 0})] = 0.0
    samples: Annotated[Count, Field(ge=2, le=LARGEST_TABLE)] | None = None
    method: Literal["DOP853", "Radau", "LSODA", "BDF"] | None = None
    exponents: Count | None = None  # Lyapunov exponents of the trajectory, the largest ones
    rtol: Positive | None = None
    box: Positive | None = None
    section: WrittenSection | None = None
    plot: Picture | None = None
    csv: File | None = None
    x: Text | None = None
    y: Text | None = None

    def chosen(self) -> Fields:
        """The options of the integration that were written."""
        options: Fields = {"samples": self.samples, "method": self.method, "rtol": self.rtol, "box": self.box}
        if self.section is not None:
            options["section"] = self.section if isinstance(self.section, str) else self.section.model_dump()
        return {key: value for key, value in options.items() if value is not None}


class SweepSettleEntry(Section):
    """When a run of a sweep has settled: see `contin.simulate.steady.Criterion`."""

    window: Positive
    tolerance: Positive | None = None
    longest: Positive | None = None
    samples: Count | None = None


class SweepEntry(Section):
    """A parameter stepped up and down in the model as it is written, drawn over the bifurcation diagram of the file."""

    transformed: bool = False
    parameter: Text
    range: Interval | None = None
    start: Start | None = None
    parameters: dict[str, Formula] = {}
    steps: Annotated[Count, Field(le=100_000)] = 60
    down: bool = True
    measures: dict[str, Text] = {}
    settle: SweepSettleEntry | None = None
    csv: File | None = None


class OutputsEntry(Section):
    """Files to write, in or below the run file's folder, and the axes of the picture."""

    plot: Picture | None = None
    html: File | None = None
    save: File | None = None
    json_: File | None = Field(default=None, alias="json")
    x: Text | None = None
    y: Texts | None = None


def _version(value: object) -> object:
    if value != FORMAT_VERSION or isinstance(value, bool):
        raise wrong(f"expected the format version {FORMAT_VERSION}, got {shown(value)}")
    return value


class RunEntry(Section):
    """A whole run file."""

    contin: Annotated[int, PlainValidator(_version), WithJsonSchema({"const": FORMAT_VERSION})] = FORMAT_VERSION
    model: ModelReference
    title: Text | None = None
    description: Text | None = None
    transform: Annotated[list[Pass], BeforeValidator(listed, json_schema_input_type=Pass | list[Pass])] = []
    parameters: dict[str, Formula] = {}
    diagram: DiagramEntry | None = None
    phase: PhaseEntry | None = None
    continuations: list[ContinuationEntry] = []
    simulate: list[SimulateEntry] = []
    sweep: SweepEntry | None = None
    outputs: OutputsEntry = OutputsEntry()

    @model_validator(mode="after")
    def _something_to_do(self) -> RunEntry:
        asked = (self.diagram, self.phase, self.sweep, *self.continuations, *self.simulate)
        if all(part is None for part in asked):
            kinds = "`continuations:`, `diagram:`, `phase:`, `simulate:`, `sweep:` or `scan:`"
            raise wrong(f"there is nothing to run; write {kinds}")
        return self
