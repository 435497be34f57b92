"""`PhaseDiagram`: curves, regions and their neighbourhood; as a graph, in words, as data and as a picture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contin import lazy
from contin.abi import Array
from contin.continuation.branch import Branch
from contin.diagram.phase.checks import Check
from contin.diagram.phase.lines import Box
from contin.diagram.phase.plane import inside
from contin.diagram.phase.report import as_data, report
from contin.diagram.phase.states import State
from contin.plot.html import write_html
from contin.plot.look import Look
from contin.plot.phase import draw
from contin.records import Fields
from contin.store.json_format import result_document
from contin.store.results import save_branches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from networkx import Graph


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the box in which the same states exist with the same stability.

    `point` maps the two parameters to a representative point, where `states` are all states that were found.
    Regions of one `name` have the same numbers of equilibria of every stability, and of stable periodic orbits, and
    their stable equilibria are each other's continuation along the straight way between their points.
    """

    name: str
    number: int
    point: Mapping[str, float]
    states: tuple[State, ...]
    area: float  # as a part of the box
    outline: Array  # (k, 2), in the parameters' units
    holes: tuple[Array, ...] = ()
    aperiodic: int = 0  # 1 where trajectories settle on something without a period: chaos, or a torus
    kind: str = "flow"  # or map

    @property
    def total(self) -> int:
        """How many equilibria there are, images under symmetries counted."""
        return sum(state.copies for state in self.states if not state.is_orbit)

    @property
    def stable(self) -> int:
        """How many of them are stable."""
        return sum(state.copies for state in self.states if not state.is_orbit and state.unstable == 0)

    @property
    def orbits(self) -> int:
        """How many periodic orbits were found, images under symmetries counted."""
        return sum(state.copies for state in self.states if state.is_orbit)

    @property
    def stable_orbits(self) -> int:
        """How many of them are stable."""
        return sum(state.copies for state in self.states if state.is_orbit and state.unstable == 0)

    @property
    def words(self) -> str:
        """Such as '2 of 3 equilibria stable, 1 stable orbit'.

        All stable states are meant; the second number counts the unstable equilibria that were found, too.
        """
        cycles = self.stable_orbits
        noun = "orbit" if self.kind == "flow" else "cycle"
        parts = [self._equilibria]
        parts += [f"{cycles} stable {noun}{'s' if cycles > 1 else ''}"] if cycles else []
        parts += ["an aperiodic attractor"] if self.aperiodic else []
        return ", ".join(parts)

    @property
    def _equilibria(self) -> str:
        one, many = ("equilibrium", "equilibria") if self.kind == "flow" else ("fixed point", "fixed points")
        if self.total == 0:
            return f"no {one} found"
        if self.total == 1:
            return f"1 {one}, {'stable' if self.stable else 'unstable'}"
        return f"{self.stable or 'none'} of {self.total} {many} stable"


@dataclass(frozen=True, eq=False, repr=False)
class PhaseDiagram:
    """Curves, regions and their neighbourhood; `branches` are the one-parameter branches that led to the curves."""

    parameters: tuple[str, str]
    box: Box
    loci: tuple[Branch, ...]
    regions: tuple[Region, ...]
    borders: Mapping[tuple[int, int], frozenset[str]]
    branches: tuple[Branch, ...] = ()
    notes: tuple[str, ...] = field(default_factory=tuple)
    stopped: bool = False  # by the user: curves and regions may be missing
    check: Check = field(default_factory=Check)  # of the regions by a second method

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
