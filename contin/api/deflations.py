"""All branches through an interval of a parameter, connected or not: deflated continuation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.branches import continuation
from contin.api.seeds import as_seed, bounds_of
from contin.api.starts import equilibrium
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.diagram.diagram import Diagram
from contin.errors import ContinError, InputError, NoSolutionError, NotFiniteError
from contin.limits import check_count
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.records import Record
from contin.search.deflated_newton import beside, is_new

MOST: Final = 200  # branches
MOVED: Final = (1e-2, 0.1, -0.1, 0.5, -0.5, 0.5)  # sizes, by which guesses are moved off what is deflated
WAVES: Final = 5
SAMPLES: Final = 11  # values of the parameter that are searched


def deflated(
    model: Any,
    parameter: str,
    range: tuple[float, float] | None = None,
    *,
    start: Any = None,
    parameters: Record | None = None,
    samples: int = SAMPLES,
    most: int = MOST,
    settings: Settings | Record | None = None,
) -> Diagram:
    """All branches of equilibria that deflation finds at `samples` values of the parameter in `range`.

    At each value, up through the range and down again, every known solution and every start of the model is a guess of
    Newton's method, from which the known solutions are deflated. What is found is followed through the range, with
    the branches that cross its own, and is known then. `notes` say how many solutions are known at each value, and how
    many came from deflation there. There is no guarantee that all are found; more `samples` find more.
    Farrell, Birkisson and Funke, SIAM J. Sci. Comput. 37 (2015) A2026.

    start : the start of the first branch, or several of them, as `contin.equilibrium` takes them; also guesses.
    """
    check_count("samples", samples)
    check_count("most", most)
    search = _Search(model, parameter, range, dict(parameters or {}), most, settings)
    search.begin(start)
    values = np.linspace(*search.bounds, samples)
    for value in values.tolist():
        search.at(value)
    for value in values[::-1].tolist():  # branches that were found later give guesses at the earlier values
        search.at(value)
    return search.result(values.tolist())


@dataclass
class _Search:
    model: Any
    parameter: str
    range: tuple[float, float] | None
    parameters: dict[str, Any]
    most: int
    settings: Settings | Record | None
    branches: list[Branch] = field(default_factory=list)
    bounds: tuple[float, float] = (0.0, 1.0)
    guesses: list[Array] = field(default_factory=list)
    found: dict[float, int] = field(default_factory=dict)  # by deflation, by value
    problem: Any = None
    full: bool = False

    def begin(self, start: Any) -> None:
        """The first branches, through the given starts."""
        starts = start if isinstance(start, list) else [start]
        seeds = []
        for one in [*starts, *(s.name for s in getattr(self.model, "starts", ()))]:
            u, _ = self.model.start_point(one, self.parameters)
            self.guesses.append(np.asarray(u, dtype=float))
            try:
                seeds.append(as_seed(equilibrium(self.model, one, self.parameters), self.parameter))
            except (NoSolutionError, NotFiniteError):  # another start, or deflation, may lead to what this one missed
                continue
        if not seeds:
            raise NoSolutionError(
                "no start leads to an equilibrium; give `start` near one, or other `parameters`, for the first branch"
            )
        for seed in seeds:
            if not isinstance(seed.problem, LargeProblem | EquilibriumProblem):
                raise InputError("deflated continuation is for equilibria of flows")
            if self.problem is None:
                self.problem, self.bounds = seed.problem, bounds_of(seed.problem, self.parameter, self.range)
            if self.branches and not self._new(seed.z):
                continue
            self._follow(seed)

    def _new(self, z: Array) -> bool:
        known = self.known(float(z[-1]))
        return is_new(z[:-1], known, self._size(known))

    def _follow(self, seed: Seed) -> None:
        branch = continuation(
            seed, self.parameter, self.range, name=f"branch{len(self.branches) + 1}", settings=self.settings
        )
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
            name = f"{branch.name}/{point.label}"
            crossing = continuation(seed, self.parameter, self.range, name=name, settings=self.settings)
            rows = [k for k in (0, -1) if self._is_row_new(crossing, k)]
            if rows:
                self.branches.append(crossing)

    def _is_row_new(self, branch: Branch, row: int) -> bool:
        known = self.known(float(branch.z[row, -1]))
        return is_new(branch.z[row, :-1], known, 1e2 * self._size(known))

    def _size(self, known: Sequence[Array]) -> float:
        """The largest norm of what is known; where all is zero, that of states of the size in the problem's metric."""
        largest = max((norm(u) for u in [*known, *self.guesses]), default=0.0)
        if largest > 0.0:
            return largest
        scale = self.problem.initial_scale(np.append(self.guesses[0], self.bounds[0]), self.bounds)
        return float(np.median(scale[:-1]))

    def known(self, value: float) -> list[Array]:
        """The solutions (n,) of all branches at a value of the parameter, each once."""
        solutions: list[Array] = []
        for branch in self.branches:
            gaps = branch.z[:, -1] - value
            for k in np.flatnonzero((gaps[:-1] * gaps[1:] <= 0.0) & (gaps[:-1] != gaps[1:])):
                weight = gaps[k] / (gaps[k] - gaps[k + 1])
                guess = branch.z[k] + weight * (branch.z[k + 1] - branch.z[k])
                z = branch.problem.at_parameter(guess, value, branch.problem.initial_scale(guess, self.bounds))
                if z is not None and is_new(z[:-1], solutions, self._size([])):
                    solutions.append(z[:-1])
        return solutions

    def at(self, value: float) -> None:
        """Deflate what is known at a value until no guess leads to anything else."""
        known = self.known(value)
        waiting = [*known, *self.guesses]
        while waiting and not self.full:
            guess = waiting.pop(0)
            size = self._size(known)
            u = self._beside(guess, value, known, size)
            if u is None:
                continue
            self.found[value] = self.found.get(value, 0) + 1
            seed = Seed(self.problem, np.append(u, value))
            self._follow(seed)
            self.full = len(self.branches) >= self.most
            after = self.known(value)
            if all(not is_new(u, [v], size) for v in after) or is_new(u, after, size):
                after.append(u)
            known = after
            waiting = [*known, *self.guesses]

    def _beside(self, guess: Array, value: float, known: list[Array], size: float) -> Array | None:
        """A new solution from a guess, moved a little in several directions; None where none leads to one."""
        rng = np.random.default_rng(len(known))
        for part in MOVED:
            moved = guess + part * size * _smooth(rng, len(guess)) / np.sqrt(len(guess))
            u = beside(lambda v: self._step(v, value), moved, known, size)
            if u is not None:
                return u
        return None

    def _step(self, u: Array, value: float) -> Array | None:
        """Newton's step at u."""
        problem, z = self.problem, np.append(u, value)
        if isinstance(problem, LargeProblem):
            f = problem.residual(z)
            linear = problem.linear(z) if np.all(np.isfinite(f)) else None
            return None if linear is None else np.asarray(linear.solve(-f))
        f, matrix = problem.system.jacobian(u, problem.full_parameters(z))
        try:
            return np.asarray(np.linalg.solve(matrix[:, : len(u)], -f))
        except np.linalg.LinAlgError:  # the search from this guess ends, and is counted among those without success
            return None

    def result(self, values: Sequence[float]) -> Diagram:
        """The branches, and what is known at each value in words."""
        notes = []
        for value in values:
            count, by = len(self.known(value)), self.found.get(value, 0)
            came = f", {by} of them by deflation there" if by else ""
            notes.append(f"{self.parameter} = {value:.6g}: {count} solution{'s' * (count != 1)}{came}")
        if self.full:
            notes.append(f"the search ended at {self.most} branches; write more in `most`")
        return Diagram(self.parameter, self.bounds, self.branches, notes)


def _smooth(rng: np.random.Generator, n: int) -> Array:
    """A direction that is no symmetry's: a few random waves over the numbering of unknowns, of root mean square 1."""
    k = np.arange(1.0, n + 1.0) / (n + 1.0)
    total = np.zeros(n)
    for mode in np.arange(1, WAVES + 1):
        total += rng.normal() * elementary.sin(np.pi * mode * k)
    return np.asarray(total / max(norm(total) / np.sqrt(n), 1e-300))
