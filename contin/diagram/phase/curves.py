"""The curves of special points that were followed, each once, and what is not followed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.defects import contained, noted
from contin.continuation.journal import Journal
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher, trace
from contin.diagram.phase.cycles import is_shorter
from contin.diagram.phase.known import is_known_locus, repeats
from contin.diagram.phase.lines import is_orbital
from contin.diagram.phase.notes import Notes
from contin.diagram.phase.orbit_curves import is_known_curve, is_known_point, repeats_curve
from contin.diagram.phase.places import Places
from contin.diagram.phase.starts import was_stopped
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.special.table import codes, crossings
from contin.transitions import births

MOST_ORBITAL: Final = 24  # curves of orbits: there are infinitely many beside a homoclinic orbit to a saddle-focus
MOST_STEPS, SHORTEST = 500, 1e-5  # of curves of orbits, which get stuck where orbits pass near other special ones
COARSE, FEW, LEAST = 0.1, 60, 1e-5  # largest step, steps and smallest step of connecting orbits, which take long
LONGEST: Final = 4  # period of cycles of a map whose curves are followed
TOTAL: Final = 12000  # points of curves of orbits
UNCUT: Final = "; the regions on its two sides may be taken for one"
REFUSED: Final = 1e-3  # distance, as part of the box, of two points of one type that are one


@dataclass(eq=False)
class Curves:
    """Follows curves through special points; `loci` are in the order found."""

    problem: EquilibriumProblem
    places: Places
    settings: Settings
    watch: Watcher | None
    orbits: bool  # curves of periodic and of connecting orbits, too
    notes: Notes
    loci: list[Branch] = field(default_factory=list)
    refused: list[tuple[str, Array]] = field(default_factory=list)  # points whose curves could not be followed
    generations: dict[str, int] = field(default_factory=dict)  # of curves, by name
    journal: Journal | None = None  # keeps each curve that is whole, before the next one begins
    steps: Journal | None = None  # ... and the chunks on the way, `OfSearch`
    spent: int = 0  # points of curves of orbits

    @property
    def is_map(self) -> bool:
        return bool(self.problem.system.kind == "map")

    def generation(self, point: SpecialPoint) -> int:
        """Of the family, or of the curve, that a special orbit is on."""
        return self.generations.get(point.branch, 0)

    def follow(self, point: SpecialPoint) -> list[SpecialPoint]:
        """Follow the curves through a point that are new; the codimension-two points on them."""
        if not self.places.holds(point) or self._was_refused(point) or self._is_left_out(point):
            return []
        seeds: Sequence[Seed] = ()
        place = f"{point.type} at {self.places.words(point)}: "
        with (
            noted(lambda text: self._refuse(point, f"{text}{UNCUT}")),
            contained(lambda text: self._refuse(point, place + text, defect=True)),
        ):
            seeds = births.loci(point.problem, point, self.places.parameters, self.orbits)
        found: list[SpecialPoint] = []
        for seed in seeds:
            with (
                noted(lambda text: self._refuse(point, f"{place}{text.rstrip('.')}{UNCUT}")),
                contained(lambda text: self._refuse(point, f"{place}{text.rstrip('.')}{UNCUT}", defect=True)),
            ):
                found.extend(self._curve(point, seed))
        return found

    def _is_left_out(self, point: SpecialPoint) -> bool:
        """True for cycles of a map that are too long, or shorter than they seem, and orbits on a curve that is known.

        Where a cycle is born it is a shorter one, on the curve of another type.
        """
        if self.is_map and point.values.get("period", 1) > LONGEST:
            self.notes.add(f"curves of cycles of more than {LONGEST} steps are not followed")
            return True
        if self.is_map:
            return is_shorter(point.problem, point.z)
        if point.type not in codes("orbit") or "period" not in point.values:
            return False
        names, place = self.problem.system.state_names, self.places.of(point)
        return is_known_point(self.loci, point, names, place, self.places.box)

    def _curve(self, point: SpecialPoint, seed: Seed) -> list[SpecialPoint]:
        """Follow one curve through a point, if it is new; the codimension-two points on it."""
        orbital = is_orbital(seed)
        if not (orbital or isinstance(seed.problem, LocusProblem)) or not self._wanted(seed, orbital):
            return []
        problem: Any = seed.problem
        branch = self._traced(replace(seed, problem=problem.within(*self.places.box)), orbital)
        if was_stopped(branch):
            self.loci.extend([branch] if len(branch) > 1 else [])
            raise KeyboardInterrupt
        if "unfolding" in branch.columns:  # an isolated branch point: no curve of this model
            self._refuse(point, f"the branch point at {self.places.words(point)} is isolated in this plane")
            return []
        if len(branch) < 2:
            self._tell(branch, branch.defects)
            if all(end.reason == "corrector" for end in branch.ends):
                text = branch.ends[0].text.rstrip(".")
                self._refuse(point, f"{point.type} at {self.places.words(point)}: {text}{UNCUT}")
            return []
        if (repeats_curve if orbital else repeats)(branch, self.loci, self.places.box):
            return []
        self.loci.append(branch)
        if self.journal is not None:
            self.journal.finished(branch)
        self.generations[branch.name] = self.generation(point)
        self._tell(branch, branch.notes)
        for end in branch.ends:
            if end.reason == "steps":
                self.notes.add(f"{branch.name} was cut short: {end.text}")
        return [p for p in branch.points if p.type in crossings()]

    def _traced(self, seed: Seed, orbital: bool) -> Branch:
        """The curve through a seed, named."""
        number = 1 + sum(b.locus == seed.problem.locus for b in self.loci)
        name = f"phase/{seed.problem.locus}-{number}"
        branch = trace(
            seed, self.places.box[0], name=name, settings=self._settings_of(seed), watch=self.watch, journal=self.steps
        )
        self.spent += len(branch) if orbital else 0
        return branch

    def _wanted(self, seed: Seed, orbital: bool) -> bool:
        """True where the curve through this seed is new, and of a kind that is looked for."""
        box = self.places.box
        if not orbital:
            return not is_known_locus([b for b in self.loci if not is_orbital(b)], seed, box)
        problem: Any = seed.problem
        if problem.locus == "HOM" and problem.curve.node:  # a part of a curve of folds
            return False
        if problem.locus == "HOM" and problem.curve.unstable_count > 1:
            self.notes.add(
                "curves of orbits homoclinic to saddles with several unstable directions are not followed: "
                "no stable orbit is born there"
            )
            return False
        if not self.orbits or is_known_curve(self.loci, seed, box):
            return False
        if self.spent > TOTAL:
            self.notes.add(f"curves of orbits were followed for {self.spent} points; there are more")
        elif sum(is_orbital(b) for b in self.loci) >= MOST_ORBITAL:
            self.notes.add(f"{MOST_ORBITAL} curves of orbits were followed; there are more")
        else:
            return True
        return False

    def _settings_of(self, seed: Seed) -> Settings:
        if not is_orbital(seed):
            return self.settings
        if seed.problem.locus == "HOM":
            return replace(self.settings, steps=FEW, min_step=LEAST, max_step=max(COARSE, self.settings.max_step))
        return replace(self.settings, steps=min(MOST_STEPS, self.settings.steps), min_step=SHORTEST)

    def _tell(self, branch: Branch, notes: Sequence[str]) -> None:
        """Notes of a curve, under its name."""
        for note in notes:
            add = self.notes.defect if note in branch.defects else self.notes.add
            add(f"{branch.name}: {note}")

    def _refuse(self, point: SpecialPoint, note: str, defect: bool = False) -> None:
        self.refused.append((point.type, self.places.of(point)))
        add = self.notes.defect if defect else self.notes.add
        add(note)

    def _was_refused(self, point: SpecialPoint) -> bool:
        here = self.places.of(point)
        return any(type_ == point.type and float(np.abs(at - here).max()) < REFUSED for type_, at in self.refused)
