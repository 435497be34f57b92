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
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.records import Record
from contin.search.deflated_newton import LONGEST, SHORT, beside, is_new
from contin.search.guesses import images, moved, with_window
from contin.search.index_sums import index_between, words

MOST: Final = 200  # branches
SAMPLES: Final = 11  # values of the parameter that are searched
TRIES: Final = 20  # guesses with a window, without success, after which the search at a value ends


def deflated(
    model: Any,
    parameter: str,
    range: tuple[float, float] | None = None,
    *,
    start: Any = None,
    parameters: Record | None = None,
    samples: int | Sequence[float] = SAMPLES,
    tries: int = TRIES,
    most: int = MOST,
    settings: Settings | Record | None = None,
) -> Diagram:
    """All branches of equilibria that deflation finds at `samples` values of the parameter in `range`.

    At each value, up through the range and down again, Newton's method, from which the known solutions are deflated,
    begins at every known solution and every start of the model, moved a little, at their mirror images and negatives,
    and at known solutions with a window of another one. What is found is followed through the range, with the branches
    that cross its own, and is known then. `notes` say how many solutions are known at each value, how many came from
    deflation there, and whether the sums of their indices differ, so that some are missing. There is no guarantee
    that all are found; more `samples` and `tries` find more.
    Farrell, Birkisson and Funke, SIAM J. Sci. Comput. 37 (2015) A2026.

    start : the start of the first branch, or several of them, as `contin.equilibrium` takes them; also guesses.
    samples : how many values, evenly spaced; or the values themselves, in the order in which they are searched.
    tries : guesses with a window that may fail one after the other before the search at a value ends.
    """
    if isinstance(samples, int):
        check_count("samples", samples)
    check_count("tries", tries, 0)
    check_count("most", most)
    search = _Search(model, parameter, range, dict(parameters or {}), tries, most, settings)
    search.begin(start)
    values = np.linspace(*search.bounds, samples) if isinstance(samples, int) else _within(samples, search.bounds)
    for value in values.tolist():
        search.at(value)
    for value in values[::-1].tolist():  # branches that were found later give guesses at the earlier values
        search.at(value)
    return search.result(values.tolist())


def _within(samples: Sequence[float], bounds: tuple[float, float]) -> Array:
    """The values as an array, all inside the bounds."""
    values = np.asarray(samples, dtype=float)
    if values.ndim != 1 or not len(values) or not np.all((values >= bounds[0]) & (values <= bounds[1])):
        raise InputError(f"samples must be a number, or values of the parameter within {bounds}; got {samples!r}")
    return values


@dataclass
class _Search:
    model: Any
    parameter: str
    range: tuple[float, float] | None
    parameters: dict[str, Any]
    tries: int
    most: int
    settings: Settings | Record | None
    branches: list[Branch] = field(default_factory=list)
    bounds: tuple[float, float] = (0.0, 1.0)
    guesses: list[Array] = field(default_factory=list)
    found: dict[float, int] = field(default_factory=dict)  # by deflation, by value
    searched: dict[float, int] = field(default_factory=dict)  # known at a value when its search ended
    problem: Any = None
    full: bool = False
    random: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))  # of windows

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
                if z is not None and is_new(z[:-1], solutions, self._size([])):
                    solutions.append(z[:-1])
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
            self._follow(Seed(self.problem, np.append(u, value)))
            self.full = len(self.branches) >= self.most
            after = self.known(value)
            known[:] = after if not is_new(u, after, size) else [*after, u]
            return True
        return False

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
        return Diagram(self.parameter, self.bounds, self.branches, notes)
