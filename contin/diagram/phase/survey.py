"""The regions that curves cut the box into, each with the states at a point inside it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.diagram.orbits import known_orbit
from contin.diagram.phase.attractors import reached, within_basins
from contin.diagram.phase.line import Line
from contin.diagram.phase.lines import polylines
from contin.diagram.phase.plane import SMALLEST, Arrangement, Face, arrangement
from contin.diagram.phase.rest import rest_state
from contin.diagram.phase.rows import common_rows
from contin.diagram.phase.search import LociSearch
from contin.diagram.phase.starts import brought
from contin.diagram.phase.states import State, states_on
from contin.linalg.polygons import inside

ROUNDS: Final = 3  # the box is cut anew when the regions' own branches show a curve that was missed
BEARING: Final = ("LP", "BP")  # curves on which equilibria are born
PASSES: Final = 3  # over the borders of all regions
SMALLEST_WITH_ORBITS: Final = 2e-4  # of the box: curves of orbits cross in swarms of small regions


@dataclass(eq=False)
class Visit:
    """A point of the unit square, its coordinates, and the line in the first parameter through it."""

    point: Array
    at: tuple[float, float]
    line: Line
    width: float  # of the parameter's range
    rests: tuple[State, ...] = ()  # where trajectories come to rest and the equations have no derivatives
    aperiodic: int = 0  # 1 where trajectories settle on something without a period
    wild: tuple[tuple[Array, Array], ...] = ()  # boxes of states that hold such trajectories
    offered: dict[int, int] = field(default_factory=dict)  # by other visit: how many of its states were looked for here
    _states: tuple[int, tuple[State, ...]] = (-1, ())

    @property
    def states(self) -> tuple[State, ...]:
        """Those of the line's branches where they pass the point; other visits may add branches to the line."""
        branches = self.line.branches
        if self._states[0] != len(branches):
            self._states = len(branches), states_on(branches, self.at[0], self.width)
        return (*self._states[1], *self.rests)

    def add(self, seeds: Sequence[Seed]) -> None:
        """Follow states at this point that are new."""
        known = [state.orbit for state in self.states if state.orbit is not None]
        new = [s for s in seeds if s.problem.kind != "orbit" or known_orbit(s.problem, s.z, known) is None]
        self.line.add(new)


@dataclass(eq=False)
class Survey:
    """`plane` is the box cut by the curves known so far, `visits` has the states of its faces, or None before that."""

    search: LociSearch
    plane: Arrangement | None = None
    owners: Sequence[int] = ()
    visits: list[Visit | None] = field(default_factory=list)
    shared: bool = False  # stable orbits of one region were looked for in all others

    def run(self) -> None:
        """Cut the box, visit every region, and cut again while that shows curves that were missed."""
        self._run()
        for visit in self.visits:
            if visit is not None:
                self.search.tell_defects(visit.line.branches)

    def _run(self) -> None:
        for _ in range(ROUNDS):
            self.cut()
            self._visit_all()
            self._share()
            self._agree()
            more = [self.search.absorb(visit.line.branches) for visit in self.visits if visit is not None]
            if not any(more):
                return
        self.cut()  # with the curves that the last round found
        self._visit_all()
        self._agree()

    def cut(self) -> None:
        """The faces between the curves known by now; a point of an earlier visit inside one serves as its point."""
        lines, self.owners = polylines(self.search.loci, self.search.box)
        plane = arrangement(lines, SMALLEST_WITH_ORBITS if self.search.orbits else SMALLEST)
        known = [visit for visit in self.visits if visit is not None]
        self.visits = [next((v for v in known if _contains(face, v.point)), None) for face in plane.faces]
        self.plane = plane

    def _visit_all(self) -> None:
        assert self.plane is not None
        left = [k for k, visit in enumerate(self.visits) if visit is None]
        for row in common_rows([self.plane.faces[k] for k in left]):
            with self.search.notes.surviving("a line across several regions, which were not looked at"):
                self._visit_row([(left[k], point) for k, point in row])

    def _visit_row(self, row: Sequence[tuple[int, Array]]) -> None:
        """Visit several faces with one line; `row` has their numbers and points."""
        low = np.array([b[0] for b in self.search.box])
        width = np.array([b[1] - b[0] for b in self.search.box])
        places = [low + width * point for _, point in row]
        height = float(places[0][1])
        line = self.search.line(0, height, [float(place[0]) for place in places])
        for (face, point), place in zip(row, places, strict=True):
            visit = self.visits[face] = Visit(point, (float(place[0]), height), line, float(width[0]))
            with self._surviving(visit):
                self._rest(visit)
            with self._surviving(visit):
                self._look(visit)

    def _rest(self, visit: Visit) -> None:
        """Add total rest, where it is a state that no branch leads to."""
        problem = replace(self.search.problem, base=self.search.held(0, visit.at[1]))
        seed, state = rest_state(problem, visit.states, visit.at[0])
        if seed is not None:
            visit.add([seed])
        if state is not None:
            visit.rests += (state,)

    def _look(self, visit: Visit, starts: Sequence[Array] | None = None) -> None:
        """Add the stable states that trajectories from here, or from these `starts`, settle on."""
        if self.search.settle:
            problem = replace(self.search.problem, base=self.search.held(0, visit.at[1]))
            found = reached(problem, visit.states, visit.at[0], starts, wild=visit.wild)
            visit.add(found.seeds)
            visit.rests += found.rests
            visit.aperiodic, visit.wild = max(visit.aperiodic, found.aperiodic), found.wild
            if found.failed:
                self.search.notes.add(
                    f"{len(found.failed)} trajectories at {self._where(visit)} could not be followed to the end "
                    f"({found.failed[0]}); what they settle on is not counted"
                )

    def _surviving(self, visit: Visit) -> AbstractContextManager[None]:
        return self.search.notes.surviving(f"states at {self._where(visit)}")

    def _where(self, visit: Visit) -> str:
        return ", ".join(f"{n} = {value:.6g}" for n, value in zip(self.search.parameters, visit.at, strict=True))

    def _share(self) -> None:
        """Stable states of one region are looked for in the others: trajectories start beside them there."""
        visits = [visit for visit in self.visits if visit is not None]
        for visit in visits:
            for other in visits:
                if other is not visit and len(other.states) > visit.offered.get(id(other), 0):
                    visit.offered[id(other)] = len(other.states)
                    with self._surviving(visit):
                        problem = replace(self.search.problem, base=self.search.held(0, other.at[1]))
                        self._look(visit, within_basins(problem, other.states, other.at[0]))
        self.shared = True

    def _agree(self) -> None:
        """Equilibria of one region are brought to a neighbour that has fewer, where none is born on their border."""
        assert self.plane is not None
        quiet = [
            pair
            for pair, curves in self.plane.borders.items()
            if not any(self.search.loci[self.owners[c]].locus in BEARING for c in curves)
        ]
        for _ in range(PASSES):
            changed = False
            for pair in quiet:
                sides = [visit for visit in (self.visits[k] for k in pair) if visit is not None]
                few, many = sorted(sides, key=_equilibria) if len(sides) == 2 else (None, None)
                if few is None or many is None or _equilibria(few) == _equilibria(many):
                    continue
                before = _equilibria(few)
                for state in many.states:
                    has_branch = not state.is_orbit and state not in many.rests
                    if has_branch and _equilibria(few) < _equilibria(many):
                        with self._surviving(few):
                            few.add(self._brought(many, state, few.at[1]))
                changed |= _equilibria(few) > before
            if not changed:
                return

    def _brought(self, visit: Visit, state: State, height: float) -> list[Seed]:
        """An equilibrium of a region on the line at another height."""
        search = self.search
        p = search.held(0, visit.at[1])
        p[list(search.problem.system.parameter_names).index(search.parameters[0])] = visit.at[0]
        start = state.vector, p
        return brought(search.problem, start, search.parameters, search.box, 0, height, search.settings)


def _equilibria(visit: Visit) -> int:
    return sum(state.copies for state in visit.states if not state.is_orbit)


def _contains(face: Face, point: Array) -> bool:
    return bool(inside(point[None], [face.outline, *face.holes])[0])
