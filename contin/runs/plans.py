"""What a run file asks for, as data: every name and number in it is known to be right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from contin.records import Fields, Record
from contin.runs.samples import Samples

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.runs.stored_starts import StoredStart

Number = float | int | str | Any  # a number, or a formula in the parameters
StartPoint = str | Record | None

AUTO = "auto"  # the start that is found
EVERYWHERE = "all"  # the start of a diagram that stands for all equilibria in its box


@dataclass(frozen=True)
class RunPlan:
    """One continuation: where it starts, what varies and how far."""

    name: str
    parameters: tuple[str, ...]
    range: Mapping[str, tuple[float, float]]
    start: StartPoint = None
    reference: tuple[str, str] | None = None  # (branch, label)
    stored: StoredStart | None = None  # a label of a stored result
    as_: str | None = None
    direction: str = "both"
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    settings: Record = field(default_factory=dict)
    to: StartPoint = None  # of a connecting orbit: the saddle that it leads to
    samples: Samples | None = None  # of an orbit to begin with
    free: tuple[str, ...] = ()  # parameters that are solved for beside those that vary
    extrema: tuple[str, ...] = ()  # columns to be labelled where they turn
    conditions: tuple[str, ...] = ()  # equations that the solutions meet
    columns: tuple[str, ...] = ()  # formulas that families of orbits record
    recorded: tuple[str, ...] = ()  # the same, for the picture's axes, where the run follows orbits
    manifold: Record = field(default_factory=dict)  # side, dimension, length, spacing
    ends: Mapping[str, tuple[str, str]] = field(default_factory=dict)  # `start`, `to`: cycles, (branch, label)
    connecting: Record = field(default_factory=dict)  # of a connecting orbit: truncation, reversor
    spectra: bool = False  # eigenvalues are columns


@dataclass(frozen=True)
class DiagramPlan:
    """What the explorer is asked for."""

    parameter: str
    range: tuple[float, float]
    starts: Sequence[StartPoint] = (None,)
    orbits: bool = True
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    settings: Record = field(default_factory=dict)
    budget: Record = field(default_factory=dict)
    box: Mapping[str, Sequence[float]] | None = None  # where `start: all` looks for equilibria
    columns: tuple[str, ...] = ()  # formulas that families of orbits record
    spectra: bool = False  # eigenvalues are columns


@dataclass(frozen=True)
class PhasePlan:
    """The phase diagram that is asked for."""

    parameters: tuple[str, str]
    range: Mapping[str, tuple[float, float]]
    starts: Sequence[StartPoint] = (None,)
    settings: Record = field(default_factory=dict)
    orbits: bool = True


@dataclass(frozen=True)
class SimulationPlan:
    """One trajectory."""

    name: str
    model: Any
    start: StartPoint
    parameters: Record
    time: float
    transient: float
    exponents: int | None = None
    options: Record = field(default_factory=dict)
    outputs: Mapping[str, FilePath] = field(default_factory=dict)  # plot, csv
    look: Record = field(default_factory=dict)  # of the picture, as `contin.plot.look.Look.of` takes it


@dataclass(frozen=True)
class SweepPlan:
    """A parameter stepped up and down."""

    model: Any
    parameter: str
    range: tuple[float, float]
    start: StartPoint
    parameters: Record
    steps: int
    down: bool
    measures: Mapping[str, str]
    settle: Record = field(default_factory=dict)
    outputs: Mapping[str, FilePath] = field(default_factory=dict)  # csv


@dataclass(frozen=True)
class Plan:
    """All that a run file asks for. `parameters` are the overrides of the file and the command line together."""

    model: Model
    parameters: Mapping[str, Number]
    runs: Sequence[RunPlan] = ()
    diagram: DiagramPlan | None = None
    phase: PhasePlan | None = None
    outputs: Mapping[str, FilePath] = field(default_factory=dict)
    look: Fields = field(default_factory=dict)  # of the picture, as `contin.plot.look.Look.of` takes it
    title: str | None = None
    simulations: Sequence[SimulationPlan] = ()
    sweep: SweepPlan | None = None

    def simulated_files(self) -> list[Mapping[str, FilePath]]:
        """What the simulations and the sweep write."""
        return [*(s.outputs for s in self.simulations), *([self.sweep.outputs] if self.sweep else [])]
