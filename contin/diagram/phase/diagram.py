"""`PhaseDiagram`: curves, regions and their neighbourhood; as a graph, in words, as data and as a picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contin import lazy
from contin.continuation.branch import Branch
from contin.diagram.phase.phase_data import PhaseData, Region
from contin.diagram.phase.report import as_data, report
from contin.linalg.polygons import inside
from contin.plot.html import write_html
from contin.plot.look import Look
from contin.plot.phase import draw
from contin.records import Fields
from contin.store.json_format import result_document
from contin.store.results import save_branches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from networkx import Graph


@dataclass(frozen=True, eq=False, repr=False)
class PhaseDiagram(PhaseData):
    """Curves, regions and their neighbourhood; `branches` are the one-parameter branches that led to the curves."""

    @property
    def graph(self) -> Graph:
        """Regions as nodes, joined where they share a border; edges carry the names of the `curves` between them."""
        import networkx as nx

        graph = nx.Graph(parameters=self.parameters)
        for region in self.regions:
            counts = {"stable": region.stable, "states": region.total, "stable_orbits": region.stable_orbits}
            graph.add_node(region.number, name=region.name, **counts)
        for (i, j), curves in self.borders.items():
            graph.add_edge(i, j, curves=sorted(curves))
        return graph

    def __iter__(self) -> Iterator[Branch]:
        return iter((*self.loci, *self.branches))

    def __len__(self) -> int:
        return len(self.loci) + len(self.branches)

    def __getitem__(self, name: str) -> Branch:
        for branch in self:
            if branch.name == name:
                return branch
        raise KeyError(f"no branch {name!r}; branches: {', '.join(branch.name for branch in self) or 'none'}")

    def region_at(self, values: Mapping[str, float]) -> Region | None:
        """The region that contains a point of the box."""
        point = np.array([[values[name] for name in self.parameters]])
        for region in self.regions:
            if inside(point, [region.outline, *region.holes])[0]:
                return region
        return None

    def __str__(self) -> str:
        return report(self)

    def as_data(self) -> Fields:
        """Parameters, box, regions (representative point, states, outline) and borders, for JSON."""
        return as_data(self)

    def __repr__(self) -> str:
        names = " and ".join(self.parameters)
        return f"<PhaseDiagram in {names}: {len(self.loci)} curves, {len(self.regions)} regions>"

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook branches").phase_page(self))

    def to_html(self, path: str | Path) -> None:
        """An interactive page in one file: regions, curves, special points."""
        write_html(self.loci, path, phase=self.as_data())

    def save(self, path: str | Path) -> None:
        """Write a `.contin` (or `.json`) file, from which `contin.read` gives the diagram again."""
        branches = [*self.loci, *(b for b in self.branches if all(b.name != locus.name for locus in self.loci))]
        save_branches(branches, path, self.notes, phase={**self.as_data(), "notes": list(self.notes)})

    def plot(self, scan: object = None, *, ax: Axes | None = None, **options: object) -> Any:
        """A matplotlib figure: curves by type, points of codimension two marked, regions labelled.

        `scan` : ((k, 2) points, (k,) values) of a brute-force scan, drawn beneath.
        ax : draw into these axes instead.  options : labels, limits, log, size, legend, title, style (`contin.draw`).
        """
        document = result_document({}, self.loci, timing={})
        return draw(self.as_data(), document["branches"], scan=scan, look=Look.of(options), ax=ax)
