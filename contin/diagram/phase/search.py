"""All curves of special points in a box of two parameters that can be reached.

They are found on branches of equilibria, and on families of periodic orbits, along a few lines across the box, and
from curve to curve through points of codimension two.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.defects import DEFECT, noted
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.continuation.targets import Target
from contin.continuation.trace import Watcher, trace
from contin.diagram.explore import Budget, Explorer
from contin.diagram.orbits import generation
from contin.diagram.phase.attractors import reached
from contin.diagram.phase.cycles import is_shorter
from contin.diagram.phase.deferred import Deferred
from contin.diagram.phase.known import is_known_locus, repeats
from contin.diagram.phase.line import Line
from contin.diagram.phase.lines import Box, is_orbital
from contin.diagram.phase.orbit_curves import (
    ORBITAL,
    families_across,
    is_known_curve,
    is_known_point,
    passes_near,
    repeats_curve,
)  # fmt: skip
from contin.diagram.phase.starts import brought, on_branch, on_curve, was_stopped
from contin.diagram.phase.states import State, states_on
from contin.problems.equilibrium import EquilibriumProblem
from contin.problems.loci.problem import LocusProblem

LINES: Final = (0.5, 0.12, 0.88)  # where lines across the box are explored, as parts of the other parameter's range
MOST: Final = 60  # curves
MOST_ORBITAL: Final = 24  # curves of orbits: there are infinitely many beside a homoclinic orbit to a saddle-focus
MOST_STEPS, SHORTEST = 500, 1e-5  # of curves of orbits, which get stuck where orbits pass near other special ones
COARSE, FEW, LEAST = 0.1, 60, 1e-5  # largest step, steps and smallest step of connecting orbits, which take long
BUDGET: Final = Budget(branches=40, steps=5000)  # of one line
OF_MAP: Final = Budget(branches=12, steps=4000)  # ... of a map: cascades of doublings have cycles of any length
LONGEST: Final = 4  # period of cycles of a map whose curves are followed
DOUBLINGS: Final = 2  # in a row, on one line; trajectories find the stable cycles beyond
GENERATIONS: Final = 2  # ... and other families born on families, which there may be infinitely many of
UNSTABLE: Final = 600  # points of curves of unstable orbits, which do not bound the region of a stable state
CASCADES: Final = 2000  # ... of families born on other families: there may be infinitely many, on ever smaller regions
TOTAL: Final = 12000  # ... of all curves of orbits
RESONANCES: Final = 3  # points R1, R2 beside which curves of tori are searched for, which takes long
FOLLOWED: Final = {"equilibrium": ("LP", "HB", "BP"), "fixed-point": ("LP", "BP", "PD", "NS"), "orbit": ORBITAL}
RESONANT: Final = frozenset({"R1", "R2"})
INCOMPLETE: Final = "families of orbits could not be followed to their ends"
ON_ORBITS: Final = frozenset({"R1", "R2", "GPD", "LPPD", "LPNS", "PDNS", "NSNS"})
CROSSING: Final = ("BT", "ZH", "HH", "DP", "GH", "R1", "R2", "GPD", "LPPD", "LPNS", "PDNS", "NSNS")


@dataclass(eq=False)
class LociSearch:
    """Collects curves; `loci` are in the order found, `branches` the one-parameter branches they were found on."""

    problem: EquilibriumProblem
    starts: Sequence[tuple[Array, Array]]  # (states, all parameters)
    parameters: tuple[str, str]
    box: Box
    settings: Settings
    watch: Watcher | None = None
    orbits: bool = True  # curves of periodic and of connecting orbits, too
    settle: bool = True  # stable states that no branch leads to are looked for with trajectories
    loci: list[Branch] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    refused: list[tuple[str, Array]] = field(default_factory=list)  # points whose curves could not be followed
    settled: list[tuple[float, float, State]] = field(default_factory=list)  # states at crossings of two lines
    cascades: Deferred = field(default_factory=lambda: Deferred(CASCADES))  # families born on others
    unstable: Deferred = field(default_factory=lambda: Deferred(UNSTABLE))  # special points of unstable orbits
    generations: dict[str, int] = field(default_factory=dict)  # of curves, by name
    resonances: deque[SpecialPoint] = field(default_factory=deque)  # R1 and R2 that wait for the other curves
    searched: int = 0  # of these
    absorbed: dict[int, Branch] = field(default_factory=dict)  # by id: branches whose points were looked at
    spent: int = 0  # points of curves of orbits

    def run(self) -> None:
        """Explore lines in both directions, then follow every curve and what crosses it.

        Ctrl-C raises KeyboardInterrupt; what was found until then is kept.
        """
        for axis in (0, 1):
            for part in LINES:
                low, high = self.box[1 - axis]
                value = low + part * (high - low)
                with self.surviving(f"the line at {self.parameters[1 - axis]} = {value:.6g}"):
                    line = self._settled(axis, value)
                    self.branches.extend(line.branches)
                    self._absorb(line.branches)
        self._deferred()

    def _settled(self, axis: int, value: float) -> Line:
        """A line with the families of the orbits on which trajectories settle at some of its points."""
        low, high = self.box[axis]
        places = [low + part * (high - low) for part in LINES] if self.settle and axis == 0 else []
        line = self.line(axis, value, places)
        problem = replace(self.problem, base=self.held(axis, value))
        for place in places:
            with self.surviving(f"trajectories at {self._pair(axis, place, value)}"):
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

    def absorb(self, branches: Sequence[Branch]) -> bool:
        """Follow the curves through the special points of branches that are new; True where there was one."""
        before = len(self.loci)
        self._absorb(branches)
        self._deferred()
        return len(self.loci) > before

    def _pair(self, axis: int, place: float, value: float) -> str:
        return f"{self.parameters[axis]} = {place:.6g}, {self.parameters[1 - axis]} = {value:.6g}"

    def _absorb(self, branches: Sequence[Branch]) -> None:
        new = [b for b in branches if b.image_of is None and id(b) not in self.absorbed]
        self.absorbed |= {id(b): b for b in new}
        self._work(deque(p for b in new for p in b.points if p.type in FOLLOWED[b.kind]))

    def _work(self, queue: deque[SpecialPoint]) -> None:
        while queue:
            if len(self.loci) >= MOST:
                self.note(f"{MOST} curves were followed; there are more")
                return
            point = queue.popleft()
            age = self._generation(point)
            if self._bounds_nothing_stable(point):
                if point.type not in RESONANT:  # unstable tori take long to find and bound nothing
                    self.unstable.add(age, point)
            elif age > 0:
                self.cascades.add(age, point)
            elif point.type in RESONANT:
                self.resonances.append(point)
            else:
                queue.extend(self._follow(point))

    def _tori(self) -> None:
        """Curves of tori beside R1 and R2, unless they are known by now."""
        while self.resonances:
            point = self.resonances.popleft()
            if not self._within(point) or passes_near(self.loci, "NS", self._place(point), self.box):
                continue
            if self.searched >= RESONANCES:
                self.note(f"curves of NS were searched for beside {RESONANCES} points R1 and R2; there are more")
                self.resonances.clear()
                return
            self.searched += 1
            self._work(deque(self._follow(point)))

    def _bounds_nothing_stable(self, point: SpecialPoint) -> bool:
        """True for special orbits with unstable multipliers besides the critical ones."""
        of_orbits = point.type in ORBITAL or point.type in ON_ORBITS
        return of_orbits and not self._is_map and "period" in point.values and point.values.get("unstable", 0) >= 1

    def _generation(self, point: SpecialPoint) -> int:
        """Of the family, or of the curve, that a special orbit is on."""
        return self.generations.get(point.branch, generation(point.branch))

    def _deferred(self) -> None:
        """Curves of tori, of families that were born on others, and of unstable orbits, as far as the budgets go."""
        self._tori()
        for kind, points in (("orbits born on other families", self.cascades), ("unstable orbits", self.unstable)):
            while (point := points.next()) is not None:
                before = self.spent
                self._work(deque(self._follow(point)))
                self._tori()
                points.used += self.spent - before
            if points.waiting:
                self.note(f"curves of {kind} were followed for {points.most} points; there may be more")
                points.waiting.clear()

    def surviving(self, what: str) -> AbstractContextManager[None]:
        """An error inside costs only what is inside, and is noted."""
        return noted(lambda text: self.note(f"{what}: {text}"))

    def note(self, text: str) -> None:
        """Something that the user should know, once."""
        if text not in self.notes:
            self.notes.append(text)

    def line(self, axis: int, value: float, marked: Sequence[float] = ()) -> Line:
        """Branches of equilibria and of orbits in parameter `axis` over its range, the other one at `value`.

        From the starts and from curves that cross that line; values `marked` of the parameter are labelled UZ.
        """
        name = self.parameters[axis]
        targets = [Target(name, target) for target in marked]
        budget = OF_MAP if self._is_map else BUDGET
        explorer = Explorer(
            name, self.box[axis], self.settings, budget, targets, self.orbits, watch=self.watch, doublings=DOUBLINGS,
            generations=GENERATIONS,
        )  # fmt: skip
        seeds = [(f"start{k + 1}", seed) for k, seed in enumerate(self.seeds(axis, value))]
        line = Line(axis, value, explorer, explorer.explore(seeds))
        line.raise_if_stopped()
        if self.orbits:
            for locus in self.loci:
                with self.surviving(f"families of orbits across {locus.name}"):
                    line.add(families_across(locus, axis, value, line.orbits))
        self._incomplete(line)
        for text in line.diagram.notes:
            if text.startswith("budget of"):
                self.note(f"at {self.parameters[1 - axis]} = {value:.6g}, {text}")
        return line

    def _incomplete(self, line: Line) -> None:
        """Say once that families of a piecewise-smooth flow stop short."""
        lost = [e for b in line.orbits if b.problem.system.n_switches for e in b.ends if e.reason == "corrector"]
        if lost and not any(INCOMPLETE in text for text in self.notes):
            where = f"{self.parameters[1 - line.axis]} = {line.value:.6g}"
            self.note(f"{INCOMPLETE}, and orbits beyond are not counted: at {where}, {lost[0].text}")

    def held(self, axis: int, value: float) -> Array:
        """All parameters, with the one that a line along `axis` holds at its value."""
        base: Array = self.problem.base.copy()
        base[list(self.problem.system.parameter_names).index(self.parameters[1 - axis])] = value
        return base

    def seeds(self, axis: int, value: float) -> list[Seed]:
        """Equilibria with the other parameter at `value`: the starts brought there, and points of known curves."""
        found: list[Seed] = []
        for number, start in enumerate(self.starts):
            with self.surviving(f"start {number + 1}"):
                found.extend(brought(self.problem, start, self.parameters, self.box, axis, value, self.settings))
        for locus in self.loci:
            if not is_orbital(locus):
                with self.surviving(f"branches across {locus.name}"):
                    found.extend(on_curve(locus, self.problem, axis, value))
        for branch in self.branches:
            across = branch.parameters[0] == self.parameters[1 - axis]
            if across and branch.image_of is None and branch.kind != "orbit":
                with self.surviving(f"branches across {branch.name}"):
                    found.extend(on_branch(branch, self.parameters[axis], self.box[1 - axis], value))
        return [seed for seed in found if not is_shorter(seed.problem, seed.z)]

    def _follow(self, point: SpecialPoint) -> list[SpecialPoint]:
        """Follow the curves through a point that are new; the codimension-two points on them."""
        if not self._within(point) or self._was_refused(point):
            return []
        if self._is_map and point.values.get("period", 1) > LONGEST:
            self.note(f"curves of cycles of more than {LONGEST} steps are not followed")
            return []
        if self._is_map and is_shorter(point.problem, point.z):  # where a cycle is born, on the curve of another type
            return []
        if (
            point.type in ORBITAL
            and "period" in point.values
            and not self._is_map
            and is_known_point(self.loci, point, self.problem.system.state_names, self._place(point), self.box)
        ):
            return []
        seeds: Sequence[Seed] = ()
        place = f"{point.type} at {self._where(point)}: "
        with noted(lambda text: self._refuse(point, place + text if DEFECT in text else text)):
            seeds = point.locus(self.parameters)
        found: list[SpecialPoint] = []
        for seed in seeds:
            with noted(lambda text: self._refuse(point, place + text)):
                found.extend(self._curve(point, seed))
        return found

    def _curve(self, point: SpecialPoint, seed: Seed) -> list[SpecialPoint]:
        """Follow one curve through a point, if it is new; the codimension-two points on it."""
        orbital = is_orbital(seed)
        if not (orbital or isinstance(seed.problem, LocusProblem)) or not self._wanted(seed, orbital):
            return []
        problem: Any = seed.problem
        branch = self._traced(replace(seed, problem=problem.within(*self.box)), orbital)
        if was_stopped(branch):
            self.loci.extend([branch] if len(branch) > 1 else [])
            raise KeyboardInterrupt
        if "unfolding" in branch.columns:  # an isolated branch point: no curve of this model
            self._refuse(point, f"the branch point at {self._where(point)} is isolated in this plane")
            return []
        if len(branch) < 2:
            self.notes.extend(f"{branch.name}: {note}" for note in branch.notes if DEFECT in note)
            return []
        if (repeats_curve if orbital else repeats)(branch, self.loci, self.box):
            return []
        self.loci.append(branch)
        self.generations[branch.name] = self._generation(point)
        self.notes.extend(f"{branch.name}: {note}" for note in branch.notes)
        for end in branch.ends:
            if end.reason == "steps":
                self.note(f"{branch.name} was cut short: {end.text}")
        return [p for p in branch.points if p.type in CROSSING]

    def _traced(self, seed: Seed, orbital: bool) -> Branch:
        """The curve through a seed, named."""
        number = 1 + sum(b.locus == seed.problem.locus for b in self.loci)
        name = f"phase/{seed.problem.locus}-{number}"
        branch = trace(seed, self.box[0], name=name, settings=self._settings_of(seed), watch=self.watch)
        self.spent += len(branch) if orbital else 0
        return branch

    def _wanted(self, seed: Seed, orbital: bool) -> bool:
        """True where the curve through this seed is new, and of a kind that is looked for."""
        if not orbital:
            return not is_known_locus([b for b in self.loci if not is_orbital(b)], seed, self.box)
        problem: Any = seed.problem
        if problem.locus == "HOM" and problem.curve.node:  # a part of a curve of folds
            return False
        if problem.locus == "HOM" and problem.curve.unstable_count > 1:
            self.note(
                "curves of orbits homoclinic to saddles with several unstable directions are not followed: "
                "no stable orbit is born there"
            )
            return False
        if not self.orbits or is_known_curve(self.loci, seed, self.box):
            return False
        if self.spent > TOTAL:
            self.note(f"curves of orbits were followed for {self.spent} points; there are more")
        elif sum(is_orbital(b) for b in self.loci) >= MOST_ORBITAL:
            self.note(f"{MOST_ORBITAL} curves of orbits were followed; there are more")
        else:
            return True
        return False

    def _settings_of(self, seed: Seed) -> Settings:
        if not is_orbital(seed):
            return self.settings
        if seed.problem.locus == "HOM":
            return replace(self.settings, steps=FEW, min_step=LEAST, max_step=max(COARSE, self.settings.max_step))
        return replace(self.settings, steps=min(MOST_STEPS, self.settings.steps), min_step=SHORTEST)

    def _within(self, point: SpecialPoint) -> bool:
        return all(low <= point.values[n] <= high for n, (low, high) in zip(self.parameters, self.box, strict=True))

    def _refuse(self, point: SpecialPoint, note: str) -> None:
        self.refused.append((point.type, self._place(point)))
        self.note(note)

    def _was_refused(self, point: SpecialPoint) -> bool:
        here = self._place(point)
        return any(type_ == point.type and float(np.abs(at - here).max()) < 1e-3 for type_, at in self.refused)

    @property
    def _is_map(self) -> bool:
        return bool(self.problem.system.kind == "map")

    def _place(self, point: SpecialPoint) -> Array:
        """Where a point is in the box, as parts of its sides."""
        low = np.array([b[0] for b in self.box])
        width = np.array([b[1] - b[0] for b in self.box])
        return np.asarray((np.array([point.values[n] for n in self.parameters]) - low) / width)

    def _where(self, point: SpecialPoint) -> str:
        return ", ".join(f"{name} = {point.values[name]:.6g}" for name in self.parameters)
