"""All curves of special points in a box of two parameters that can be reached.

They are found on branches of equilibria, and on families of periodic orbits, along a few lines across the box, and
from curve to curve through points of codimension two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.journal import Journal, OfSearch
from contin.continuation.location.user_value import Target
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher
from contin.diagram.explore import Budget, Explorer
from contin.diagram.phase.agenda import Agenda
from contin.diagram.phase.attractors import reached
from contin.diagram.phase.curves import Curves
from contin.diagram.phase.cycles import is_shorter
from contin.diagram.phase.line import Line
from contin.diagram.phase.lines import Box, is_orbital
from contin.diagram.phase.notes import Notes
from contin.diagram.phase.orbit_curves import families_across
from contin.diagram.phase.places import Places
from contin.diagram.phase.starts import brought, on_branch, on_curve
from contin.diagram.phase.states import State, states_on
from contin.problems.equilibria.equilibrium import EquilibriumProblem

LINES: Final = (0.5, 0.12, 0.88)  # where lines across the box are explored, as parts of the other parameter's range
AGAIN: Final = 4  # places that a check finds wrong, through which lines are explored once more
BUDGET: Final = Budget(branches=40, steps=5000)  # of one line
OF_MAP: Final = Budget(branches=12, steps=4000)  # ... of a map: cascades of doublings have cycles of any length
DOUBLINGS: Final = 2  # in a row, on one line; trajectories find the stable cycles beyond
GENERATIONS: Final = 2  # ... and other families born on families, which there may be infinitely many of
SHORT: Final = ("corrector", "surface")  # ends of families beyond which there may be orbits that are not followed
STEPS: Final = "branches end for want of steps"
INCOMPLETE: Final = "families of orbits could not be followed to their ends"


@dataclass(eq=False)
class LociSearch:
    """Explores lines; `branches` are those in one parameter on which the curves `loci` were found."""

    problem: EquilibriumProblem
    starts: Sequence[tuple[Array, Array]]  # (states, all parameters)
    parameters: tuple[str, str]
    box: Box
    settings: Settings
    watch: Watcher | None = None
    orbits: bool = True  # curves of periodic and of connecting orbits, too
    settle: bool = True  # stable states that no branch leads to are looked for with trajectories
    journal: Journal | None = None
    branches: list[Branch] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)
    settled: list[tuple[float, float, State]] = field(default_factory=list)  # states at crossings of two lines

    def __post_init__(self) -> None:
        self.places = Places(self.parameters, self.box)
        self._steps = None if self.journal is None else OfSearch(self.journal, "phase")
        curves = Curves(
            self.problem, self.places, self.settings, self.watch, self.orbits, self.notes,
            journal=self.journal, steps=self._steps,
        )  # fmt: skip
        self.loci = curves.loci
        self.agenda = Agenda(curves)

    def run(self) -> None:
        """Explore lines in both directions, then follow every curve and what crosses it.

        Ctrl-C raises KeyboardInterrupt; what was found until then is kept.
        """
        for axis in (0, 1):
            for part in LINES:
                low, high = self.box[1 - axis]
                value = low + part * (high - low)
                with self.notes.surviving(f"the line at {self.parameters[1 - axis]} = {value:.6g}"):
                    line = self._settled(axis, value)
                    self.branches.extend(line.branches)
                    self.tell_defects(line.branches)
                    self.agenda.absorb(line.branches)
        self.agenda.finish()
        self._unconnected()

    def _unconnected(self) -> None:
        """Homoclinic orbits lead away from a Bogdanov-Takens point of a flow; a note where there is none."""
        births = [p for b in self.loci for p in b.points if p.type == "BT" and self.places.holds(p)]
        if births and self.orbits and not self.problem.is_map and not any(b.locus == "HOM" for b in self.loci):
            self.notes.add(f"no curve of homoclinic orbits was found at the BT point at {self.places.words(births[0])}")

    def absorb(self, branches: Sequence[Branch]) -> bool:
        """Follow the curves through the special points of branches that are new; True where there was one."""
        before = len(self.loci)
        self.agenda.absorb(branches)
        self.agenda.finish()
        return len(self.loci) > before

    def look_again(self, places: Sequence[tuple[float, float]], known: Sequence[Branch]) -> bool:
        """Explore lines through places at which states were not as a region says; True where a new curve was found.

        known : branches along lines in the first parameter, from which states are taken onto lines in the other one.
        """
        before, own = len(self.loci), list(self.branches)
        self.branches.extend(known)
        try:
            for place in places[:AGAIN]:
                for axis in (1, 0):
                    with self.notes.surviving(f"the line at {self.parameters[1 - axis]} = {place[1 - axis]:.6g}"):
                        line = self.line(axis, place[1 - axis])
                        own.extend(line.branches)
                        self.agenda.absorb(line.branches)
            self.agenda.finish()
        finally:
            self.branches[:] = own
        return len(self.loci) > before

    def tell_defects(self, branches: Sequence[Branch]) -> None:
        """Branches that an error cut short lack states: regions may have more than are counted."""
        for branch in branches:
            for note in branch.defects:
                self.notes.defect(f"a branch of states is cut short, {note}")

    def _settled(self, axis: int, value: float) -> Line:
        """A line with the families of the orbits on which trajectories settle at some of its points."""
        low, high = self.box[axis]
        places = [low + part * (high - low) for part in LINES] if self.settle and axis == 0 else []
        line = self.line(axis, value, places)
        problem = replace(self.problem, base=self.held(axis, value))
        for place in places:
            with self.notes.surviving(f"trajectories at {self.places.pair(axis, place, value)}"):
                states = states_on(line.branches, place, high - low)
                line.add(reached(problem, states, place, lasting=False).seeds)
        if axis == 0:
            self.settled += [(place, value, s) for place in places for s in states_on(line.branches, place, high - low)]
        elif self.orbits:
            line.add(self._crossing(value))
        return line

    def _crossing(self, value: float) -> list[Seed]:
        """Stable orbits on lines along the first parameter, where it has this value, as starts in the other one."""
        seeds = []
        for place, other, state in self.settled:
            if state.orbit is not None and state.unstable == 0 and place == value:
                problem, z = state.orbit
                z = z[~np.isnan(z)]
                seeds.append(Seed(problem.with_active(self.parameters[1], z), np.append(z[:-1], other)))
        return seeds

    def line(self, axis: int, value: float, marked: Sequence[float] = ()) -> Line:
        """Branches of equilibria and of orbits in parameter `axis` over its range, the other one at `value`.

        From the starts and from curves that cross that line; values `marked` of the parameter are labelled UZ.
        """
        name = self.parameters[axis]
        targets = [Target(name, target) for target in marked]
        budget = OF_MAP if self.problem.system.kind == "map" else BUDGET
        explorer = Explorer(
            name, self.box[axis], self.settings, budget, targets, self.orbits, watch=self.watch,
            journal=self._steps, doublings=DOUBLINGS, generations=GENERATIONS, unstable_births=False,
        )  # fmt: skip
        seeds = [(f"start{k + 1}", seed) for k, seed in enumerate(self.seeds(axis, value))]
        line = Line(axis, value, explorer, explorer.explore(seeds))
        line.raise_if_stopped()
        if self.orbits:
            for locus in self.loci:
                with self.notes.surviving(f"families of orbits across {locus.name}"):
                    line.add(families_across(locus, axis, value, line.orbits))
        self._incomplete(line)
        for text in line.diagram.unfinished:
            self.notes.add(f"at {self.parameters[1 - axis]} = {value:.6g}, {text}")
        return line

    def _incomplete(self, line: Line) -> None:
        """Say once that branches end for want of steps, and that families of a piecewise-smooth flow stop short."""
        short = [b for b in line.branches if any(end.reason == "steps" for end in b.ends)]
        if short:
            self.notes.add_first(
                STEPS,
                f" (settings.steps = {self.settings.steps}): at {self.parameters[1 - line.axis]} = "
                f"{line.value:.6g}, {len(short)} of them; states and curves beyond are not known",
            )
        piecewise = [b for b in line.orbits if b.problem.system.n_switches]
        lost = [end for b in piecewise for end in b.ends if end.reason in SHORT]
        if lost:
            where = f"{self.parameters[1 - line.axis]} = {line.value:.6g}"
            self.notes.add_first(INCOMPLETE, f", and orbits beyond are not counted: at {where}, {lost[0].text}")

    def held(self, axis: int, value: float) -> Array:
        """All parameters, with the one that a line along `axis` holds at its value."""
        base: Array = self.problem.base.copy()
        base[list(self.problem.system.parameter_names).index(self.parameters[1 - axis])] = value
        return base

    def seeds(self, axis: int, value: float) -> list[Seed]:
        """Equilibria with the other parameter at `value`: the starts brought there, and points of known curves."""
        found: list[Seed] = []
        for number, start in enumerate(self.starts):
            with self.notes.surviving(f"start {number + 1}"):
                found.extend(brought(self.problem, start, self.parameters, self.box, axis, value, self.settings))
        for locus in self.loci:
            if not is_orbital(locus):
                with self.notes.surviving(f"branches across {locus.name}"):
                    found.extend(on_curve(locus, self.problem, axis, value))
        for branch in self.branches:
            across = branch.parameters[0] == self.parameters[1 - axis]
            if across and branch.image_of is None and branch.kind != "orbit":
                with self.notes.surviving(f"branches across {branch.name}"):
                    found.extend(on_branch(branch, self.parameters[axis], self.box[1 - axis], value))
        return [seed for seed in found if not is_shorter(seed.problem, seed.z)]
