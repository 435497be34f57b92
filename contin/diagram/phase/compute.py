"""From equilibria to the phase diagram of a box: search for curves, cut the box, name its regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import NO_FUNCTION, Array
from contin.continuation.branch import Branch
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher
from contin.diagram.orbits import known_orbit
from contin.diagram.phase.attractors import carried, orbits_reached
from contin.diagram.phase.diagram import PhaseDiagram, Region
from contin.diagram.phase.line import Line
from contin.diagram.phase.lines import Box, polylines
from contin.diagram.phase.plane import SMALLEST, Arrangement, Face, arrangement, inside
from contin.diagram.phase.search import LociSearch
from contin.diagram.phase.states import State, states_on
from contin.errors import InputError

if TYPE_CHECKING:
    from contin.problems.start import Equilibrium

ROUNDS: Final = 3  # the box is cut anew when the regions' own branches show a curve that was missed
SMALLEST_WITH_ORBITS: Final = 2e-4  # of the box: curves of orbits cross in swarms of small regions
DEFAULTS: Final = {"steps": 3000, "max_step": 0.03}


def phase(
    starts: Equilibrium | Sequence[Equilibrium],
    parameters: Sequence[str],
    box: Mapping[str, Sequence[float]] | Box,
    settings: Settings | Mapping[str, Any] | None = None,
    watch: Watcher | None = None,
    orbits: bool = True,
) -> PhaseDiagram:
    """The phase diagram of the states connected with `starts` in a box of two parameters.

    Curves of folds, Hopf points and branch points, and with `orbits` those of LPC, PD, NS, BPC and of homoclinic
    orbits, are found on lines across the box and followed to its edges. The states of each region are those on all
    branches through its representative point that are connected with a start or with one of the curves, and the stable
    orbits on which trajectories settle that leave unstable equilibria there. Special points on those branches that lie
    on no known curve start new ones, and the box is cut again. Cost: about ten branches a line, and one line a region.
    """
    listed: list[Any] = list(starts) if isinstance(starts, list | tuple) else [starts]
    first, second = _pair(parameters)
    bounds = _bounds(box, (first, second))
    chosen = Settings.of(DEFAULTS | dict(settings or {}) if not isinstance(settings, Settings) else settings)
    points = [(np.asarray(s.u), np.asarray(s.p)) for s in listed]
    system = listed[0].system
    followed = orbits and system.kind != "map" and system.jacobian_address != NO_FUNCTION
    search = LociSearch(listed[0].problem(first), points, (first, second), bounds, chosen, watch, followed)
    search.run()
    visited: list[_Visit] = []
    for _ in range(ROUNDS):
        lines, owners = polylines(search.loci, bounds)
        plane = arrangement(lines, SMALLEST_WITH_ORBITS if search.orbits else SMALLEST)
        plane, visited = _visited(search, plane, visited)
        _share(search, visited)
        found = [(visit.states, visit.branches) for visit in visited]
        more = [search.absorb(branches) for _, branches in found]
        if not any(more):
            break
    names = [search.loci[k].name for k in owners]
    borders = {pair: frozenset(names[c] for c in curves) for pair, curves in plane.borders.items()}
    loci = tuple(_without_parent(b, search.loci) for b in search.loci)
    regions = _regions(plane, [states for states, _ in found], search)
    notes = tuple(dict.fromkeys(search.notes))
    return PhaseDiagram((first, second), bounds, loci, regions, borders, tuple(search.branches), notes)


def _without_parent(branch: Branch, loci: Sequence[Branch]) -> Branch:
    """A curve; where it begins at a point of a branch that is not part of the diagram, as one with no parent."""
    named = branch.parent is not None and any(b.name == branch.parent.branch for b in loci)
    return branch if named else replace(branch, parent=None)


def _pair(parameters: Sequence[str]) -> tuple[str, str]:
    if isinstance(parameters, str) or len(parameters) != 2 or parameters[0] == parameters[1]:
        raise InputError(f"a phase diagram has two parameters; got {parameters!r}")
    return parameters[0], parameters[1]


def _bounds(box: Any, names: tuple[str, str]) -> Box:
    pairs = [box[name] for name in names] if isinstance(box, Mapping) else list(box)
    (a, b), (c, d) = ((float(lo), float(hi)) for lo, hi in pairs)
    if not (a < b and c < d):
        raise InputError(f"each range needs its lower bound below the upper one; got {pairs}")
    return (a, b), (c, d)


@dataclass(eq=False)
class _Visit:
    """A point of the unit square, its coordinates, and the line in the first parameter through it."""

    point: Array
    at: tuple[float, float]
    line: Line
    states: tuple[State, ...]
    offered: set[int] = field(default_factory=set)  # families of other visits that were looked for here

    @property
    def branches(self) -> list[Branch]:
        return self.line.branches

    def add(self, seeds: Sequence[Seed]) -> None:
        """Follow orbits at this point that are new."""
        known = [state.orbit for state in self.states if state.orbit is not None]
        self.line.add([seed for seed in seeds if known_orbit(seed.problem, seed.z, known) is None])
        self.states = states_on(self.branches)


def _visited(search: LociSearch, plane: Arrangement, known: Sequence[_Visit]) -> tuple[Arrangement, list[_Visit]]:
    """Every face with the states at its point; a point of an earlier visit inside it serves as well."""
    faces, visits = [], []
    for face in plane.faces:
        visit = next((v for v in known if _contains(face, v.point)), None) or _visit(search, face.point)
        faces.append(replace(face, point=visit.point))
        visits.append(visit)
    return replace(plane, faces=tuple(faces)), visits


def _contains(face: Face, point: Array) -> bool:
    return bool(inside(point[None], [face.outline, *face.holes])[0])


def _visit(search: LociSearch, point: Array) -> _Visit:
    low = np.array([b[0] for b in search.box])
    width = np.array([b[1] - b[0] for b in search.box])
    at = low + width * point
    line = search.line(0, float(at[1]), target=float(at[0]))
    visit = _Visit(point, (float(at[0]), float(at[1])), line, states_on(line.branches))
    if search.orbits:
        problem = replace(search.problem, base=search.held(0, float(at[1])))
        visit.add(orbits_reached(problem, visit.states, float(at[0])))
    return visit


def _share(search: LociSearch, visits: Sequence[_Visit]) -> None:
    """Stable orbits that trajectories led to in one region are looked for in the others."""
    if not search.orbits:
        return
    families = [b for visit in visits for b in visit.line.orbits if b.parent is None]
    for visit in visits:
        for family in families:
            if family not in visit.branches and id(family) not in visit.offered:
                visit.offered.add(id(family))
                visit.add(carried(family, search.parameters, visit.at, search))


def _regions(plane: Arrangement, found: Sequence[tuple[State, ...]], search: LociSearch) -> tuple[Region, ...]:
    low = np.array([b[0] for b in search.box])
    width = np.array([b[1] - b[0] for b in search.box])
    names: dict[Any, str] = {}
    regions = []
    for number, (face, states) in enumerate(zip(plane.faces, found, strict=True)):
        rests = tuple(sorted((state.unstable, state.copies) for state in states if state.orbit is None))
        cycles = tuple(sorted(state.copies for state in states if state.orbit is not None and state.unstable == 0))
        kind = rests, cycles
        name = names.setdefault(kind, _letter(len(names)))
        values = dict(zip(search.parameters, (low + width * face.point).tolist(), strict=True))
        outline, *holes = (low + width * ring for ring in (face.outline, *face.holes))
        regions.append(Region(name, number, values, states, face.area, outline, tuple(holes)))
    return tuple(regions)


def _letter(k: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    letter = chr(ord("A") + k % 26)
    return letter if k < 26 else _letter(k // 26 - 1) + letter
