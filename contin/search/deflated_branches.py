"""Branches of equilibria that deflation finds, value by value of a parameter, and what crosses them.

Newton's method, from which the known solutions are deflated, begins at known solutions and guesses, moved a little, and
at known solutions with a window of another one. Farrell, Birkisson and Funke, SIAM J. Sci. Comput. 37 (2015) A2026.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import ContinError
from contin.linalg.newton import solution
from contin.linalg.vectors import norm
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.search.deflated_newton import LONGEST, SHORT, beside, is_new
from contin.search.guesses import images, moved, with_window
from contin.search.index_sums import index_between, words

UNLIKE: Final = 100.0  # times a state's size, that another one's is where their units differ

Follow = Callable[[Seed, str], Branch]  # the branch from a seed, under a name


@dataclass
class DeflatedBranches:
    """What is known so far; `problem` is that of the first branch.

    guesses : states (n,) from which solutions are looked for, too. Here these, and all solutions known, are in `units`,
    those of the metric where sizes of states are unlike: lengths of states in different units mean nothing.
    tries : guesses with a window that may fail one after the other before the search at a value ends.  most : branches.
    """

    problem: EquilibriumProblem | LargeProblem
    parameter: str
    bounds: tuple[float, float]
    guesses: Sequence[Array]
    follow: Follow
    tries: int
    most: int
    branches: list[Branch] = field(default_factory=list)
    found: dict[float, int] = field(default_factory=dict)  # by deflation, by value
    searched: dict[float, int] = field(default_factory=dict)  # known at a value when its search ended
    full: bool = False
    random: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))  # of windows
    units: Array = field(init=False)

    def __post_init__(self) -> None:
        scale = self.problem.initial_scale(np.append(self.guesses[0], self.bounds[0]), self.bounds)[:-1]
        self.units = scale if float(scale.max()) > UNLIKE * float(scale.min()) else np.ones_like(scale)
        self.guesses = [guess / self.units for guess in self.guesses]

    def add(self, seed: Seed) -> None:
        """Follow the branch through a solution, unless that is known, and those that cross it."""
        known = self.known(float(seed.z[-1]))
        if not self.branches or is_new(seed.z[:-1] / self.units, known, self._size(known)):
            self._followed(seed)

    def _followed(self, seed: Seed) -> None:
        branch = self.follow(seed, f"branch{len(self.branches) + 1}")
        self.branches.append(branch)
        for point in branch.points:
            if point.type == "BP" and len(self.branches) < self.most:
                self._cross(branch, point)

    def _cross(self, branch: Branch, point: SpecialPoint) -> None:
        """The branches that cross at a branch point, unless their neighbourhood is known."""
        try:
            seeds = point.switch()
        except ContinError:
            return  # degenerate: deflation finds what is born there
        for seed in seeds:
            crossing = self.follow(seed, f"{branch.name}/{point.label}")
            rows = [k for k in (0, -1) if self._is_row_new(crossing, k)]
            if rows:
                self.branches.append(crossing)

    def _is_row_new(self, branch: Branch, row: int) -> bool:
        known = self.known(float(branch.z[row, -1]))
        return is_new(branch.z[row, :-1] / self.units, known, 1e2 * self._size(known))

    def _size(self, known: Sequence[Array]) -> float:
        """The largest norm of what is known; where all is zero, that of states of the size in the problem's metric."""
        largest = max((norm(u) for u in [*known, *self.guesses]), default=0.0)
        if largest > 0.0:
            return largest
        scale = self.problem.initial_scale(np.append(self.guesses[0] * self.units, self.bounds[0]), self.bounds)
        return float(np.median(scale[:-1] / self.units))

    def known(self, value: float) -> list[Array]:
        """The solutions (n,) of all branches at a value of the parameter, each once."""
        return self._known_with_indices(value)[0]

    def _known_with_indices(self, value: float) -> tuple[list[Array], list[int]]:
        """... and (-1)^unstable of each, 0 where it is not known."""
        solutions: list[Array] = []
        indices: list[int] = []
        for branch in self.branches:
            gaps = branch.z[:, -1] - value
            for k in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
                weight = gaps[k] / (gaps[k] - gaps[k + 1])
                guess = branch.z[k] + weight * (branch.z[k + 1] - branch.z[k])
                z = branch.problem.at_parameter(guess, value, branch.problem.initial_scale(guess, self.bounds))
                if z is not None and is_new(z[:-1] / self.units, solutions, self._size([])):
                    solutions.append(z[:-1] / self.units)
                    indices.append(index_between(branch.columns.get("unstable"), int(k)))
        return solutions, indices

    def at(self, value: float) -> None:
        """Deflate what is known at a value until no guess leads to anything else."""
        known = self.known(value)
        waiting = [] if self.searched.get(value) == len(known) else [*known, *self.guesses]
        while waiting and not self.full:
            guess = waiting.pop(0)
            size = self._size(known)
            rng = np.random.default_rng(len(known))
            if self._found([*images(guess), *moved(guess, size, rng)], value, known, size):
                waiting = [*known, *self.guesses]
        failed = 0
        while known and failed < self.tries and not self.full:
            size = self._size(known)
            guess = with_window(known, size, self.random)
            failed = 0 if self._found([guess], value, known, size, SHORT) else failed + 1
        self.searched[value] = len(known)

    def _found(
        self, guesses: Sequence[Array], value: float, known: list[Array], size: float, longest: float = LONGEST
    ) -> bool:
        """Whether one of the guesses leads to a new solution; its branch is followed, and `known` renewed."""
        for guess in guesses:
            u = beside(lambda v: self._step(v, value), guess, known, size, longest)
            if u is None:
                continue
            self.found[value] = self.found.get(value, 0) + 1
            self._followed(Seed(self.problem, np.append(u * self.units, value)))
            self.full = len(self.branches) >= self.most
            after = self.known(value)
            known[:] = after if not is_new(u, after, size) else [*after, u]
            return True
        return False

    def _step(self, u: Array, value: float) -> Array | None:
        """Newton's step at u."""
        problem, z = self.problem, np.append(u * self.units, value)
        if isinstance(problem, LargeProblem):
            f = problem.residual(z)
            linear = problem.linear(z) if np.all(np.isfinite(f)) else None
            return None if linear is None else np.asarray(linear.solve(-f)) / self.units
        f, matrix = problem.system.jacobian(z[:-1], problem.full_parameters(z))
        step = solution(matrix[:, : len(u)], -f)
        return None if step is None else step / self.units  # None: the search from this guess ends, without success

    def notes(self, values: Sequence[float]) -> list[str]:
        """What is known at each value, in words."""
        notes = []
        indices = {value: self._known_with_indices(value)[1] for value in values}
        for value in values:
            count, by = len(indices[value]), self.found.get(value, 0)
            came = f", {by} of them by deflation there" if by else ""
            notes.append(f"{self.parameter} = {value:.6g}: {count} solution{'s' * (count != 1)}{came}")
        missing = words(self.parameter, indices)
        if missing:
            notes.append(missing)
        if self.full:
            notes.append(f"the search ended at {self.most} branches; write more in `most`")
        return notes
