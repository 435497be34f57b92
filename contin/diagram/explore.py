"""The explorer: follow every branch that is reachable through branch points, each once, within bounds and budgets."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Literal, cast

import numpy as np

from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.defects import noted
from contin.continuation.journal import Journal
from contin.continuation.location.user_value import Target
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher, trace
from contin.diagram.diagram import Diagram
from contin.diagram.identity import is_known
from contin.diagram.images import images, images_through
from contin.diagram.orbits import family_through, generation, known_family, left_to_the_user, mirrored_families
from contin.errors import InputError
from contin.kernels.clock import computing_time
from contin.model.advice import closest
from contin.problems.conditioned.requested_columns import with_columns
from contin.problems.contracts import InOneParameter
from contin.problems.symmetry import apply_symmetry
from contin.records import Record
from contin.transitions.births import departures, explored
from contin.transitions.halved import halved
from contin.transitions.registry import Explored, families_at


@dataclass(frozen=True)
class Budget:
    """When the explorer stops: number of computed branches, accepted points over all of them, work, seconds.

    work : accepted points times unknowns, over all branches; 1e8 are some twenty minutes of orbits of three states.
    Seconds are counted only where they are given: what is found would depend on the machine.
    """

    branches: int = 100
    steps: int = 200_000
    work: float = 1e8
    seconds: float = math.inf

    @classmethod
    def of(cls, given: Budget | Record | None) -> Budget:
        if given is None or isinstance(given, Budget):
            return given or cls()
        unknown = sorted(set(given) - {f.name for f in fields(cls)})
        if unknown:
            known = [f.name for f in fields(cls)]
            advice = closest(unknown[0], known) or f"there are {', '.join(known)}"
            raise InputError(f"budget: unknown {', '.join(unknown)}: {advice}")
        return cls(**given)


@dataclass(frozen=True, eq=False)
class Task:
    """A branch to follow: its name, where it starts, and the types of the points that its ancestors were born at."""

    name: str
    seed: Seed
    born_at: tuple[str, ...] = ()


@dataclass(eq=False)
class Explorer:
    """Breadth first: branches from the starts, then from their branch points, then from those of the new branches."""

    parameter: str
    bounds: tuple[float, float]
    settings: Settings
    budget: Budget = field(default_factory=Budget)
    targets: Sequence[Target] = ()
    orbits: bool = True
    watch: Watcher | None = None
    journal: Journal | None = None
    doublings: int = 64  # how many period doublings in a row are followed
    generations: int = 64  # how many families of orbits in a row that are born on others
    unstable_births: bool = True  # families born on others where those are unstable already
    columns: Sequence[str] = ()  # of families of orbits, on request

    def explore(self, starts: Sequence[tuple[str, Seed]], reserve: Sequence[Seed] = ()) -> Diagram:
        """`starts` are named seeds; a start that lies on a branch already found is noted and not followed again.

        `reserve` are seeds that are tried when all else is followed: those on no branch yet begin `all1`, `all2`...
        """
        diagram = Diagram(self.parameter, self.bounds, explorer=self)
        queue = deque(Task(name, seed) for name, seed in starts)
        self._work(diagram, queue)
        number = 1
        for seed in reserve:
            if diagram.stopped:
                break
            known = None
            with noted(_teller(diagram, f"all{number}")):
                known = self._known(diagram, seed)
            if known is None and self._work(diagram, deque([Task(f"all{number}", seed)])):
                number += 1
        return diagram

    def add(self, diagram: Diagram, name: str, seed: Seed) -> list[Branch]:
        """Follow one more start, and what is reachable from it."""
        return self._work(diagram, deque([Task(name, seed)]))

    def _work(self, diagram: Diagram, queue: deque[Task]) -> list[Branch]:
        began = computing_time()
        added: list[Branch] = []
        while queue:
            reason = self._spent(diagram, began)
            if reason:
                waiting = ", ".join(task.name for task in queue)
                diagram.unfinished.append(f"{reason}; not followed: {waiting}")
                diagram.notes.append(diagram.unfinished[-1])
                break
            task = queue.popleft()
            branch = None
            try:
                with noted(_teller(diagram, task.name, failed=not task.born_at)):
                    branch = self._follow(diagram, task, began + self.budget.seconds)
                if branch is None:
                    continue
                added.append(branch)
                diagram.stopped = any(end.reason == "stopped" for end in branch.ends)
                if not diagram.stopped:
                    for point in branch.points:
                        queue.extend(self._departures(diagram, branch, point))
                    queue.extend(self._halves(diagram, branch))
            except KeyboardInterrupt:  # between two branches
                diagram.stopped = True
            if diagram.stopped:
                diagram.notes.append("stopped by the user")
                break
        return added

    def _spent(self, diagram: Diagram, began: float) -> str | None:
        computed = [b for b in diagram.branches if b.image_of is None]
        if len(computed) >= self.budget.branches:
            return f"budget of {self.budget.branches} branches used"
        if sum(b.steps for b in computed) >= self.budget.steps:
            return f"budget of {_steps(self.budget)} used"
        if sum(b.steps * b.z.shape[1] for b in computed) >= self.budget.work:
            return f"budget of {_work(self.budget)} used"
        if computing_time() - began >= self.budget.seconds:
            return f"budget of {self.budget.seconds:g} s used"
        return None

    def _steps_left(self, diagram: Diagram, seed: Seed) -> int:
        """Of the budget, for all arms of the seed's branch together."""
        computed = [b for b in diagram.branches if b.image_of is None]
        steps = self.budget.steps - sum(b.steps for b in computed)
        work = self.budget.work - sum(b.steps * b.z.shape[1] for b in computed)
        return max(1, min(steps, int(min(work / float(seed.z.size), 1e9))))

    def _follow(self, diagram: Diagram, task: Task, deadline: float) -> Branch | None:
        name, seed = task.name, task.seed
        known = self._known(diagram, seed)
        if known is not None:
            if not seed.born:
                diagram.notes.append(f"start {name!r} lies on branch {known.name!r}")
            elif known.parent is not None and known.kind != "orbit":
                diagram.branches.extend(images_through(known, seed.z, diagram.branches))
            return None
        left = self._steps_left(diagram, seed)
        branch = trace(
            with_columns(seed, self.columns),
            self.bounds,
            name=name,
            settings=self.settings,
            targets=self.targets,
            watch=self.watch,
            journal=self.journal,
            deadline=deadline,
            most=left,
        )
        branch = replace(branch, born_at=task.born_at)
        diagram.branches.append(branch)
        if branch.steps >= left and any(end.reason == "steps" for end in branch.ends):
            diagram.unfinished.append(
                f"budget of {_steps(self.budget)} or {_work(self.budget)} used; {name} ends there"
            )
            diagram.notes.append(diagram.unfinished[-1])
        with noted(_teller(diagram, f"images of {name}")):
            diagram.branches.extend(images(branch))
            self._mirror_births(diagram, branch, seed)
            diagram.branches.extend(mirrored_families(branch, diagram.branches))
        if self.journal is not None:
            for whole in diagram.branches[diagram.branches.index(branch) :]:
                self.journal.finished(whole)
        diagram.notes.extend(f"{name}: {note}" for note in branch.notes)
        return branch

    def _mirror_births(self, diagram: Diagram, branch: Branch, seed: Seed) -> None:
        """What is born on a branch is born, mirrored, on that branch's images."""
        if branch.kind not in ("equilibrium", "fixed-point"):
            return
        for mirror in [b for b in diagram.branches if b.image_of and branch.parent]:
            if mirror.image_of and branch.parent and mirror.image_of.branch == branch.parent.branch:
                born_at = apply_symmetry(cast(InOneParameter, seed.problem), mirror.image_of.symmetry, seed.z)[0]
                diagram.branches.extend(images_through(branch, born_at, diagram.branches))

    def _known(self, diagram: Diagram, seed: Seed) -> Branch | None:
        problem = seed.problem
        if problem.kind == "orbit":
            if not seed.born:
                return family_through(diagram.branches, seed, self.bounds)
            return known_family(diagram.branches, seed, self.bounds[1] - self.bounds[0])
        scale = seed.scale if seed.scale is not None else problem.initial_scale(seed.z, self.bounds)
        if seed.beside:  # others have the same tangent
            known = [is_known(diagram.branches, problem, z, None, scale) for z in seed.beside.values()]
            return known[0] if all(branch is not None for branch in known) else None
        tangent = None if seed.direction is None else seed.direction * scale
        return is_known(diagram.branches, problem, seed.z, tangent, scale)

    def _departures(self, diagram: Diagram, branch: Branch, point: SpecialPoint, asked: bool = False) -> list[Task]:
        """What is born at a point; `asked` for by the user, whatever it is."""
        rule = explored(branch.problem, point)
        if rule is None or not (asked or self._wanted(diagram, branch, point, rule)):
            return []
        base = f"{branch.name}/{point.label}"
        seeds: Sequence[Seed] = ()
        with noted(_teller(diagram, base)):
            seeds = departures(branch.problem, point, self.parameter, self.orbits)
        born_at = (*branch.born_at, point.type)
        return [Task(base if k == 0 else f"{base}.{k + 1}", seed, born_at) for k, seed in enumerate(seeds)]

    def _wanted(self, diagram: Diagram, branch: Branch, point: SpecialPoint, rule: Explored) -> bool:
        """False, with a note, where families of orbits are too many or too late to be followed by themselves."""
        reason = left_to_the_user(branch, point, rule)
        if reason:
            return self._note_once(diagram, f"{branch.name}: {reason}")
        if rule.cascade and branch.born_at.count(point.type) >= self.doublings:
            return self._note_once(diagram, f"{self.doublings} doublings in a row were followed; there may be more")
        if rule.generation and generation(branch.born_at, families_at(branch.problem)) >= self.generations:
            return self._note_once(
                diagram, f"families of orbits of the generation after {branch.name} were not followed"
            )
        late = rule.generation and not rule.uncertain and not self.unstable_births
        if late and point.values.get("unstable", 0) > 0:
            return self._note_once(diagram, f"families born at unstable orbits of {branch.name} were not followed")
        return True

    def _halves(self, diagram: Diagram, branch: Branch) -> list[Task]:
        """Families of half the period that a family of orbits ended on."""
        found: list[Task] = []
        for row, end in ((0, branch.ends[0]), (-1, branch.ends[1])):
            if end.data.get("halved"):
                name = f"{branch.name}/half{'.2' if found else ''}"
                with noted(_teller(diagram, name)):
                    seed = halved(branch.problem, branch.z[row])
                    if self._known(diagram, seed) is None:
                        found.append(Task(name, seed, branch.born_at))
        return found

    @staticmethod
    def _note_once(diagram: Diagram, note: str) -> Literal[False]:
        if note not in diagram.notes:
            diagram.notes.append(note)
        return False

    def follow(self, diagram: Diagram, branch: str, label: str) -> list[Branch]:
        """See `Diagram.follow`."""
        origin = diagram[branch]
        return self._work(diagram, deque(self._departures(diagram, origin, origin[label], asked=True)))

    def extend(self, diagram: Diagram, branch: str, end: str, bounds: tuple[float, float] | None) -> Branch:
        """See `Diagram.extend`."""
        if end not in ("first", "last"):
            raise InputError(f"end must be 'first' or 'last'; got {end!r}")
        origin = diagram[branch]
        row = 0 if end == "first" else -1
        outward = origin.tangents[row] if end == "last" else -origin.tangents[row]
        limits = bounds or self.bounds
        scale = origin.problem.initial_scale(origin.z[row], limits)
        direction = outward / scale
        seed = Seed(origin.problem, origin.z[row], direction / np.linalg.norm(direction), None, scale, (1,))
        used = {b.name for b in diagram.branches}
        name = next(f"{branch}+{k}" for k in range(1, 10_000) if f"{branch}+{k}" not in used)
        piece = trace(
            seed,
            limits,
            name=name,
            settings=self.settings,
            targets=self.targets,
            watch=self.watch,
            journal=self.journal,
        )
        piece = replace(piece, born_at=origin.born_at)
        diagram.branches.append(piece)
        queue = deque(item for point in piece.points for item in self._departures(diagram, piece, point))
        replace(self, bounds=limits)._work(diagram, queue)
        return piece


def _steps(budget: Budget) -> str:
    return f"{budget.steps} steps"


def _work(budget: Budget) -> str:
    return f"{budget.work:g} points times unknowns"


def _teller(diagram: Diagram, name: str, failed: bool = False) -> Callable[[str], None]:
    """Appends texts to the notes of the diagram, each under this name; the name of a start, to those that `failed`."""

    def tell(text: str) -> None:
        diagram.notes.append(f"{name}: {text}")
        if failed:
            diagram.failed.append(name)

    return tell
