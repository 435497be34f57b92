"""`Diagram`: branches joined at special points, as a graph, a report and a picture."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contin import lazy
from contin.continuation.branch import Branch, BranchesByName
from contin.continuation.dataframes import dataframes
from contin.diagram.graph import build_graph
from contin.diagram.report import report
from contin.plot.figure import draw
from contin.plot.html import write_html
from contin.plot.look import Look
from contin.records import Fields
from contin.store.results import save_branches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from networkx import MultiGraph
    from pandas import DataFrame


@dataclass(eq=False, repr=False)
class Diagram(BranchesByName):
    """What the explorer found: `branches` in the order in which they were followed, `notes` in words.

    `explorer` holds what is needed to go on: `extend` continues an end with another range, `follow` a labelled point.
    """

    parameter: str
    bounds: tuple[float, float]
    branches: list[Branch] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    explorer: Any = None
    stopped: bool = False  # by the user
    unfinished: list[str] = field(default_factory=list)  # those of the notes that say what a budget left
    failed: list[str] = field(default_factory=list)  # starts from which no branch could be followed; a note says why

    @property
    def graph(self) -> MultiGraph:
        """Special points and ends as nodes, the pieces of branches between them as edges (a networkx.MultiGraph)."""
        return build_graph(self.parameter, self.branches)

    def __str__(self) -> str:
        return report(self.parameter, self.bounds, self.branches, self.notes)

    def extend(self, branch: str, end: str = "last", bounds: tuple[float, float] | None = None) -> Branch:
        """Follow a branch beyond its `first` or `last` row, within other bounds; the new piece joins the diagram."""
        return self.explorer.extend(self, branch, end, bounds)  # type: ignore[no-any-return]

    def follow(self, branch: str, label: str) -> list[Branch]:
        """Follow what starts at a labelled point and is not in the diagram yet; the new branches join it."""
        return self.explorer.follow(self, branch, label)  # type: ignore[no-any-return]

    def plot(self, ax: Axes | None = None, **options: object) -> Figure:
        """A matplotlib figure: solid stable, dashed unstable, special points marked; options: `contin.plot.look.Look`.

        ax : draw into these axes instead.
        """
        return draw(self.branches, ax=ax, look=Look.of({"x": self.parameter, **options}))

    def __repr__(self) -> str:
        low, high = self.bounds
        return f"<Diagram in {self.parameter} from {low:g} to {high:g}: {len(self.branches)} branches>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook branches").diagram_page(self))

    def to_html(self, path: str | Path, x: str | None = None, y: str | None = None) -> None:
        """An interactive page in one file."""
        write_html(self.branches, path, x=x or self.parameter, y=y)

    def to_dataframe(self) -> DataFrame:
        """One pandas.DataFrame of all branches, indexed by `branch` and `row`; needs pandas."""
        return dataframes(self.branches)

    def to_xarray(self) -> Fields:
        """An xarray.Dataset for each branch, by name (`xarray.DataTree.from_dict` joins them); needs xarray."""
        return {branch.name: branch.to_xarray() for branch in self.branches}

    def save(self, path: str | Path) -> None:
        """Write a `.contin` (or `.json`) file, which `contin.read`, `contin plot` and `contin export` read."""
        save_branches(self.branches, path, self.notes, diagram=self.as_data())

    def as_data(self) -> Fields:
        """What the diagram is besides its branches, for files."""
        return {
            "parameter": self.parameter, "range": list(self.bounds), "branches": [b.name for b in self.branches],
            "stopped": self.stopped, "unfinished": list(self.unfinished), "notes": list(self.notes),
        }  # fmt: skip
