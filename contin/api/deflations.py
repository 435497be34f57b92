"""All branches through an interval of a parameter, connected or not: deflated continuation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.branches import continuation
from contin.api.seeds import as_seed, bounds_of
from contin.api.starts import equilibrium
from contin.continuation.branch import Branch
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.diagram.diagram import Diagram
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.limits import check_count
from contin.model.kinds import need_model
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.records import Record
from contin.search.deflated_branches import DeflatedBranches

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
    need_model(model)
    if isinstance(samples, int):
        check_count("samples", samples)
    check_count("tries", tries, 0)
    check_count("most", most)
    seeds, guesses = _starts(model, start, dict(parameters or {}), parameter)
    problem = seeds[0].problem
    if not isinstance(problem, LargeProblem | EquilibriumProblem):
        raise InputError("deflated continuation is for equilibria of flows")

    def follow(seed: Seed, name: str) -> Branch:
        return continuation(seed, parameter, range, name=name, settings=settings)

    bounds = bounds_of(problem, parameter, range)
    search = DeflatedBranches(problem, parameter, bounds, guesses, follow, tries, most)
    for seed in seeds:
        search.add(seed)
    values = np.linspace(*bounds, samples) if isinstance(samples, int) else _within(samples, bounds)
    for value in values.tolist():
        search.at(value)
    for value in values[::-1].tolist():  # branches that were found later give guesses at the earlier values
        search.at(value)
    return Diagram(parameter, bounds, search.branches, search.notes(values.tolist()))


def _starts(model: Any, start: Any, parameters: Record, parameter: str) -> tuple[list[Seed], list[Array]]:
    """The equilibria that the given starts, and those of the model, lead to; and all of these starts as guesses."""
    seeds, guesses = [], []
    for one in [*(start if isinstance(start, list) else [start]), *(s.name for s in getattr(model, "starts", ()))]:
        u, _ = model.start_point(one, parameters)
        guesses.append(np.asarray(u, dtype=float))
        try:
            seeds.append(as_seed(equilibrium(model, one, parameters), parameter))
        except (NoSolutionError, NotFiniteError):  # another start, or deflation, may lead to what this one missed
            continue
    if not seeds:
        raise NoSolutionError(
            "no start leads to an equilibrium; give `start` near one, or other `parameters`, for the first branch"
        )
    return seeds, guesses


def _within(samples: Sequence[float], bounds: tuple[float, float]) -> Array:
    """The values as an array, all inside the bounds."""
    values = np.asarray(samples, dtype=float)
    if values.ndim != 1 or not len(values) or not np.all((values >= bounds[0]) & (values <= bounds[1])):
        raise InputError(f"samples must be a number, or values of the parameter within {bounds}; got {samples!r}")
    return values
