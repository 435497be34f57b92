"""Results read back from the files that contin writes: branches with columns, points and orbits.

A `.contin` file holds the equations too, and the points as they were computed: runs start from them as in the session
that wrote them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from contin import lazy
from contin.api.read_branches import branch_of
from contin.api.read_regions import phase_of
from contin.api.read_runs import StoredSimulation, lyapunov_of, simulation_of, survey_of, sweep_of
from contin.api.surveys import Survey
from contin.continuation.branch import Branch, BranchesByName
from contin.diagram.diagram import Diagram
from contin.diagram.phase.diagram import PhaseDiagram
from contin.errors import InputError
from contin.exponents.spectrum import LyapunovSpectrum
from contin.notebook import html
from contin.plot.figure import draw
from contin.plot.look import Look
from contin.plot.scan import drawn as drawn_scan
from contin.records import Fields, Record
from contin.simulate.sweep import Sweep
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import read_results
from contin.store.run_files import checked, kind_of
from contin.store.scan_store import read_scan
from contin.store.solution_tables import load_solutions

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Drawable(Protocol):
    """What draws itself with the options of a picture."""

    def plot(self, *, ax: Axes | None = None, **options: Any) -> Figure: ...


@dataclass(frozen=True, eq=False, repr=False)
class Results(BranchesByName):
    """The branches of a result file in their order, by name; `notes` in words; `document`, all that the file says.

    diagram, phase : of a run that has them beside other branches.  simulations : trajectories by name.  sweep : if any.
    """

    branches: tuple[Branch, ...]
    notes: tuple[str, ...]
    document: Record
    diagram: Diagram | None = None
    phase: PhaseDiagram | None = None
    simulations: Mapping[str, StoredSimulation] = field(default_factory=dict)
    sweep: Sweep | None = None

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure, as that of what was saved; options: `contin.plot.look.Look`."""
        if not self.branches:
            alone: list[Drawable] = [*self.simulations.values(), *([self.sweep] if self.sweep is not None else [])]
            if len(alone) == 1:
                return alone[0].plot(ax=ax, **options)
            known = ", ".join(f"simulations[{name!r}]" for name in self.simulations) or "nothing"
            raise InputError(f"there is no branch to draw; the file holds {known}{', sweep' if self.sweep else ''}")
        return draw(self.branches, ax=ax, look=Look.of(options))

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self}>"

    def __str__(self) -> str:
        parts = [*map(repr, self.branches), *map(str, self.simulations.values())]
        parts += [f"sweep in {self.sweep.parameter}, {len(self.sweep.values)} runs"] if self.sweep is not None else []
        return "\n".join([*parts, *self.notes])

    def _repr_html_(self) -> str:
        pages = [part._repr_html_() for part in self.branches]
        pages += [part._repr_html_() for part in self.simulations.values()]
        return "".join([*pages, *([self.sweep._repr_html_()] if self.sweep is not None else [])])


@dataclass(frozen=True, eq=False, repr=False)
class ScanResults(Results):
    """The runs of a scan, finished or not, as they were stored: a table, a row a run; it has no branches."""

    @property
    def columns(self) -> Mapping[str, Sequence[Any]]:
        """Axes, start, class, outcome, time, statistics of the runs."""
        found: Mapping[str, Sequence[Any]] = self.document["columns"]
        return found

    @property
    def counts(self) -> dict[str, int]:
        """How many runs of each class, the most frequent first."""
        return dict(Counter(self.columns["class"]).most_common())

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """Classes over one or two axes, a panel a start.

        options : x, y, limits, log, size, legend, title, style; `start`, to draw this one alone (into `ax`).
        """
        return drawn_scan(dict(self.document), ax, options)

    def __str__(self) -> str:
        return "\n".join([f"{len(self.columns['class'])} runs", *(f"  {k}: {n}" for k, n in self.counts.items())])

    def _repr_html_(self) -> str:
        drawn = html.image(self.plot(), "scan") if self.columns["class"] else ""
        return drawn + html.table(("class", "runs"), self.counts.items()) + html.notes(self.notes)


Read = Results | Diagram | PhaseDiagram | StoredSimulation | Sweep | LyapunovSpectrum | Survey


def read(file: str | Path) -> Any:
    """What contin wrote, as it was, from a `.contin`, `.json` or `.scan` file.

    A saved diagram or phase diagram is a `Diagram` or `PhaseDiagram` again; a run of several things `Results`, with its
    branches, `contin.read(file)[branch][label]`; a scan its table; the JSON of `contin simulate`, `sweep`, `survey` and
    `plane` a trajectory, a `Sweep`, a `Survey` and a `PhasePlane` (a list of these along a parameter). Columns, points,
    values, eigenvalues, normal forms and ends are those that were saved; `point.orbit` and `branch.orbit(row)` where
    the file keeps them. From the points of a `.contin` file branches are followed: `point.switch()`, `point.locus()`.
    InputError for any other file.
    """
    path = Path(file)
    if ending_of(path) == ".scan":
        runs = read_scan(path)
        return ScanResults((), tuple(runs.get("notes", ())), runs)
    if ending_of(path) == ".json":
        written = read_mapping(path)
        kind = kind_of(written)
        if kind in ("plane", "planes"):
            return _planes(written, path)
        if kind is not None:
            return _of_command(checked(written, kind, path), kind)
    document = read_results(path)
    solutions = load_solutions(path) if ending_of(path) == ".contin" else None
    branches = tuple(branch_of(branch, document, solutions) for branch in document["branches"])
    return _whole(document, branches)


def _planes(written: Record, path: Path) -> object:
    """A phase plane, or those along a parameter."""
    stored = lazy.module("stored planes")
    shape = stored.SHAPE
    if written["kind"] == "plane":
        return stored.plane_of(checked(written, "plane", path, shape))
    every = {"type": "object", "required": ["planes"], "properties": {"planes": {"type": "array", "items": shape}}}
    return [stored.plane_of(one) for one in checked(written, "planes", path, every)["planes"]]


def _of_command(document: Fields, kind: str) -> Read:
    """What a command wrote alone."""
    notes = tuple(document.get("notes", ()))
    if kind == "simulation":
        return simulation_of(document, notes)
    if kind == "sweep":
        return sweep_of(document, document["sweep"], document["model"])
    if kind == "lyapunov":
        return lyapunov_of(document)
    return survey_of(document) if kind == "survey" else ScanResults((), notes, document)


def _whole(document: Record, branches: tuple[Branch, ...]) -> Read:
    """A diagram or a phase diagram, where the file holds nothing else; all that it holds."""
    notes = list(document.get("notes", ()))
    diagram = _diagram(document, branches, _own(document, "diagram")) if "diagram" in document else None
    phase = phase_of(document, branches, _own(document, "phase")) if "phase" in document else None
    simulations = {one["name"]: simulation_of(one) for one in document.get("simulations", ())}
    swept = document.get("sweep")
    model = document["model"]["name"]
    sweep = None if swept is None else sweep_of(swept, swept["parameter"], swept.get("model", model))
    if not simulations and sweep is None:
        if diagram is not None and phase is None and len(diagram.branches) == len(branches):
            return diagram
        if phase is not None and diagram is None:
            return phase
    return Results(branches, tuple(notes), document, diagram, phase, simulations, sweep)


def _own(document: Record, part: str) -> list[str]:
    """The notes of a diagram as it had them, and those of the file; without those that are its branches' alone."""
    every, own = list(document.get("notes", ())), document[part].get("notes")
    if own is None:
        return every
    heads = tuple(f"{branch['name']}: " for branch in document["branches"])
    return [*own, *(note for note in every if note not in own and not note.startswith(heads))]


def _diagram(document: Record, branches: Sequence[Branch], notes: list[str]) -> Diagram:
    """Those of the branches that an explorer found."""
    data = document["diagram"]
    low, high = (float(end) for end in data["range"])
    mine = [branch for branch in branches if branch.name in data["branches"]]
    stopped, unfinished = bool(data.get("stopped")), list(data.get("unfinished", ()))
    return Diagram(data["parameter"], (low, high), mine, notes, FromFile(), stopped, unfinished)


class FromFile:
    """In place of the explorer of a diagram from a file: says how to go on."""

    def extend(self, diagram: Diagram, branch: str, end: str, bounds: object) -> Branch:
        """InputError."""
        raise InputError(
            f"{branch}: a diagram from a file is not extended; compute it again with another range, or follow a point: "
            f"contin.continuation(diagram[{branch!r}][LABEL].switch(), {diagram.parameter!r}, (LOW, HIGH))"
        )

    def follow(self, diagram: Diagram, branch: str, label: str) -> list[Branch]:
        """InputError."""
        low, high = diagram.bounds
        raise InputError(
            f"{branch}.{label}: what starts at a point from a file is followed by contin.continuation("
            f"diagram[{branch!r}][{label!r}].switch(), {diagram.parameter!r}, ({low:g}, {high:g}))"
        )
