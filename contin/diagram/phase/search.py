"""All curves of special points in a box of two parameters that can be reached.

They are found on branches of equilibria, and on families of periodic orbits, along a few lines across the box, and
from curve to curve through points of codimension two.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.continuation.targets import Target
from contin.continuation.trace import Watcher, trace
from contin.diagram.explore import Budget, Explorer
from contin.diagram.phase.known import is_known_locus, repeats
from contin.diagram.phase.line import Line
from contin.diagram.phase.lines import Box, is_orbital
from contin.diagram.phase.orbit_curves import ORBITAL, families_across, is_known_curve, repeats_curve
from contin.errors import ContinError
from contin.problems.equilibrium import EquilibriumProblem
from contin.problems.loci.problem import LocusProblem

LINES: Final = (0.5, 0.12, 0.88)  # where lines across the box are explored, as parts of the other parameter's range
MOST: Final = 60  # curves
MOST_ORBITAL: Final = 24  # curves of orbits: there are infinitely many beside a homoclinic orbit to a saddle-focus
MOST_STEPS, SHORTEST = 500, 1e-5  # of curves of orbits, which get stuck where orbits pass near other special ones
COARSE, FEW, LEAST = 0.1, 120, 1e-5  # largest step, steps and smallest step of connecting orbits, which take long
BUDGET: Final = Budget(branches=40, seconds=60.0)  # of one line
FOLLOWED: Final = {"equilibrium": ("LP", "HB", "BP"), "fixed-point": ("LP", "BP", "PD", "NS"), "orbit": ORBITAL}
CROSSING: Final = ("BT", "ZH", "HH", "DP", "GH", "R1", "R2", "LPPD", "LPNS", "PDNS", "NSNS")


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
    loci: list[Branch] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    refused: list[tuple[str, Array]] = field(default_factory=list)  # points whose curves could not be followed

    def run(self) -> None:
        """Explore lines in both directions, then follow every curve and what crosses it."""
        for axis in (0, 1):
            for part in LINES:
                low, high = self.box[1 - axis]
                line = self.line(axis, low + part * (high - low))
                self.branches.extend(line.branches)
                self.absorb(line.branches)

    def absorb(self, branches: Sequence[Branch]) -> bool:
        """Follow the curves through the special points of branches that are new; True where there was one."""
        before = len(self.loci)
        queue: deque[SpecialPoint] = deque(
            p for b in branches if b.image_of is None for p in b.points if p.type in FOLLOWED[b.kind]
        )
        while queue and len(self.loci) < MOST:
            queue.extend(self._follow(queue.popleft()))
        return len(self.loci) > before

    def line(self, axis: int, value: float, target: float | None = None) -> Line:
        """Branches of equilibria and of orbits in parameter `axis` over its range, the other one at `value`.

        From the starts and from curves that cross that line; `target` marks a value of the parameter as UZ.
        """
        name = self.parameters[axis]
        targets = [] if target is None else [Target(name, target)]
        explorer = Explorer(
            name, self.box[axis], self.settings, BUDGET, targets, orbits=self.orbits, watch=self.watch
        )
        seeds = [(f"start{k + 1}", seed) for k, seed in enumerate(self.seeds(axis, value))]
        line = Line(axis, value, explorer, explorer.explore(seeds))
        if self.orbits:
            for locus in self.loci:
                line.add(families_across(locus, axis, value, line.orbits))
        return line

    def held(self, axis: int, value: float) -> Array:
        """All parameters, with the one that a line along `axis` holds at its value."""
        base: Array = self.problem.base.copy()
        base[list(self.problem.system.parameter_names).index(self.parameters[1 - axis])] = value
        return base

    def seeds(self, axis: int, value: float) -> list[Seed]:
        """Equilibria with the other parameter at `value`: the starts brought there, and points of known curves."""
        found: list[Seed] = []
        for u, p in self.starts:
            found.extend(self._brought(u, p, axis, value))
        for locus in self.loci:
            if not is_orbital(locus):
                found.extend(_crossings(locus, self.problem, axis, value))
        for branch in self.branches:
            across = branch.parameters[0] == self.parameters[1 - axis]
            if across and branch.image_of is None and branch.kind != "orbit":
                found.extend(self._crossings_of_branch(branch, axis, value))
        return found

    def _brought(self, u: Array, p: Array, axis: int, value: float) -> list[Seed]:
        """A start with the other parameter brought to `value`, then the parameter itself into its range."""
        names = list(self.problem.system.parameter_names)
        k, j = (names.index(self.parameters[i]) for i in (axis, 1 - axis))
        inside = float(np.clip(p[k], *self.box[axis]))
        for order in ((k, inside), (j, value)), ((j, value), (k, inside)):
            state, at = u, p.copy()
            for active, wanted in order:
                problem = replace(self.problem, base=at.copy(), active=active)
                reached = _bring(problem, state, wanted, self.settings)
                if reached is None:
                    break
                state, at[active] = reached, wanted
            else:
                return [Seed(replace(self.problem, base=at, active=k), np.append(state, at[k]))]
        return []

    def _crossings_of_branch(self, branch: Branch, axis: int, value: float) -> list[Seed]:
        """Equilibria of a branch in the other parameter where that has this value, as starts of branches."""
        problem: Any = branch.problem
        column = branch.z[:, -1] - value
        k = list(problem.system.parameter_names).index(self.parameters[axis])
        seeds = []
        for row in np.flatnonzero(column[:-1] * column[1:] < 0.0):
            t = column[row] / (column[row] - column[row + 1])
            guess = (1.0 - t) * branch.z[row] + t * branch.z[row + 1]
            z = problem.at_parameter(guess, value, problem.initial_scale(guess, self.box[1 - axis]))
            if z is not None:
                p = problem.full_parameters(z)
                seeds.append(Seed(replace(problem, base=p, active=k), np.append(z[:-1], p[k])))
        return seeds

    def _follow(self, point: SpecialPoint) -> list[SpecialPoint]:
        """Follow the curves through a point that are new; the codimension-two points on them."""
        if not self._within(point) or self._was_refused(point):
            return []
        try:
            seeds = point.locus(self.parameters)
        except ContinError as error:
            self._refuse(point, str(error))
            return []
        found: list[SpecialPoint] = []
        for seed in seeds:
            orbital = is_orbital(seed)
            if not (orbital or isinstance(seed.problem, LocusProblem)) or not self._wanted(seed, orbital):
                continue
            seed = replace(seed, problem=seed.problem.within(*self.box))
            number = 1 + sum(b.locus == seed.problem.locus for b in self.loci)
            name = f"phase/{seed.problem.locus}-{number}"
            try:
                branch = trace(seed, self.box[0], name=name, settings=self._settings_of(seed), watch=self.watch)
            except ContinError as error:
                self._refuse(point, f"{point.type} at {self._where(point)}: {error}")
                continue
            if "unfolding" in branch.columns:  # an isolated branch point: no curve of this model
                self._refuse(point, f"the branch point at {self._where(point)} is isolated in this plane")
                continue
            if len(branch) < 2 or (repeats_curve if orbital else repeats)(branch, self.loci, self.box):
                continue
            self.loci.append(branch)
            self.notes.extend(f"{branch.name}: {note}" for note in branch.notes)
            found.extend(p for p in branch.points if p.type in CROSSING)
        return found

    def _wanted(self, seed: Seed, orbital: bool) -> bool:
        """True where the curve through this seed is new, and of a kind that is looked for."""
        if not orbital:
            return not is_known_locus([b for b in self.loci if not is_orbital(b)], seed, self.box)
        if not self.orbits or is_known_curve(self.loci, seed, self.box):
            return False
        if sum(is_orbital(b) for b in self.loci) < MOST_ORBITAL:
            return True
        note = f"{MOST_ORBITAL} curves of orbits were followed; there are more"
        self.notes.extend([note] if note not in self.notes else [])
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
        if note not in self.notes:
            self.notes.append(note)

    def _was_refused(self, point: SpecialPoint) -> bool:
        here = self._place(point)
        return any(type_ == point.type and float(np.abs(at - here).max()) < 1e-3 for type_, at in self.refused)

    def _place(self, point: SpecialPoint) -> Array:
        """Where a point is in the box, as parts of its sides."""
        low = np.array([b[0] for b in self.box])
        width = np.array([b[1] - b[0] for b in self.box])
        return np.asarray((np.array([point.values[n] for n in self.parameters]) - low) / width)

    def _where(self, point: SpecialPoint) -> str:
        return ", ".join(f"{name} = {point.values[name]:.6g}" for name in self.parameters)


def _bring(problem: EquilibriumProblem, u: Array, value: float, settings: Settings) -> Array | None:
    """The equilibrium u followed until the active parameter has this value; through folds, if need be."""
    here = float(problem.base[problem.active])
    if here == value:
        return u
    width = abs(value - here)
    bounds = (min(here, value), max(here, value))
    sense = 1 if value > here else -1
    for room in (0.0, 1.0):  # a branch that folds back may come round outside
        limits = (bounds[0] - (room * width if sense > 0 else 0.0), bounds[1] + (room * width if sense < 0 else 0.0))
        try:
            branch = trace(Seed(problem, np.append(u, here), arms=(sense,)), limits, settings=settings)
        except ContinError:
            return None
        row = -1 if sense > 0 else 0
        if abs(float(branch.z[row, -1]) - value) < 1e-9 * max(1.0, abs(value)):
            return np.asarray(branch.z[row, :-1])
    return None


def _crossings(locus: Branch, problem: EquilibriumProblem, axis: int, value: float) -> list[Seed]:
    """Points of a curve on the line where the parameter across `axis` has this value, as starts of branches."""
    planar: Any = locus.problem
    curve = planar.curve
    index = len(locus.z[0]) - (1 if axis == 1 else 2)  # where the other parameter stands
    column = locus.z[:, index] - value
    seeds = []
    for row in np.flatnonzero(column[:-1] * column[1:] < 0.0):
        t = column[row] / (column[row] - column[row + 1])
        guess = (1.0 - t) * locus.z[row] + t * locus.z[row + 1]
        z = planar.at_unknown(index, guess, value, planar.initial_scale(guess, planar.first_bounds))
        if z is None:
            continue
        p = curve.full_parameters(z)
        k = curve.first if axis == 0 else curve.second
        seeds.append(Seed(replace(problem, base=p, active=k), np.append(z[: curve.n], p[k])))
    return seeds
