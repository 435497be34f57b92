"""Everything that is connected to some starts: diagrams in one parameter, phase diagrams in two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.api.fixed_totals import for_branches, varying
from contin.api.responses import responses_in
from contin.api.searches import find_equilibria, reach_of
from contin.api.seeds import FoundByItself, Range, as_seed, bounds_of, targets_of
from contin.api.solutions import solution
from contin.api.starts import equilibrium
from contin.continuation.journal import Journal
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import Watcher
from contin.diagram.explore import Budget, Explorer
from contin.diagram.phase.compute import phase as compute
from contin.errors import ContinError, InputError, NoSolutionError, NotFiniteError
from contin.machine.one_thread import one_thread
from contin.model.advice import place_of_parameter
from contin.model.kinds import need_model, need_time
from contin.problems.sparse.as_dense import SMALL
from contin.problems.symmetry_group import group_note
from contin.records import Record
from contin.search.equilibrium_from_guess import Equilibrium
from contin.search.large_equilibrium import as_small
from contin.symbolic.passes.conserved import conserved_notes
from contin.systems.functions.function_problem import FunctionProblem

if TYPE_CHECKING:
    from contin.continuation.problem import Problem
    from contin.model.model import Model

FUNCTION: Final = (
    "periodic orbits of a Python function are not followed in phase diagrams: curves of equilibria and their regions "
    "only; a cycle's own curves start at its labels (contin.periodic_orbit, point.locus)"
)
EVERYWHERE: Final = "all"  # the start of a diagram that stands for all equilibria
SHOWN: Final = 6  # states whose bounds are told


@one_thread
def diagram(
    model: Any,
    parameter: str,
    range: Range | None = None,
    *,
    start: Any = None,
    box: Any = None,
    parameters: Record | None = None,
    orbits: bool = True,
    values: Mapping[str, Sequence[float]] | None = None,
    columns: Sequence[str] = (),
    settings: Settings | Record | None = None,
    budget: Any = None,
    watch: Watcher | None = None,
    journal: Journal | None = None,
) -> Any:
    """Follow every branch that is reachable from the starts through special points, each once: a `Diagram`.

    Of a forced flow its periodic responses are followed: from each start the one that its trajectory settles on.

    start : a named start, a mapping of states, or a list of them; default the states' values. 'all' (unless the model
        has a start of this name) looks for all equilibria in `box` (see `find_equilibria`), at the parameter's value
        and at some others in the range, so that disconnected branches are found.
    orbits : follow families of periodic orbits from Hopf points too.
    columns : of these families, formulas such as 'mean(x^2)' that become columns (see `continuation`).
    budget : {branches, steps, seconds}: the exploration stops there and says what it left.
    """
    model = for_branches(model)
    named, everywhere = _named_starts(model, start)
    seeds: list[tuple[str, Seed]] = []
    notes: list[str] = []
    failure: ContinError | None = None
    for name, one in named:
        try:
            found = solution(model, one, parameters)
            seeds.append((name, as_seed(found, parameter)))
            if isinstance(found, FoundByItself):
                notes.append(f"start {name!r}: {found.words}")
        except (NoSolutionError, NotFiniteError) as error:
            notes.append(f"start {name!r}: {error}")
            failure = error
    if not seeds and failure is not None and not everywhere:
        raise failure
    reserve: list[Seed] = []
    if everywhere:
        limits = None if range is None else bounds_of(None, parameter, range)
        reserve = everywhere_in(model, parameter, limits, box, parameters)
        notes += [] if box is not None else [_default_box(model, parameters)]
    if not seeds and not reserve:
        raise failure or NoSolutionError(f"no {_noun(model)} found in the box; give a larger box")
    first = seeds[0][1] if seeds else reserve[0]
    problem = first.problem
    bounds = bounds_of(problem, parameter, range)
    targets = targets_of(first, values)
    explorer = Explorer(
        parameter, bounds, Settings.of(settings), Budget.of(budget), targets, orbits, watch, journal, columns=columns
    )
    result = explorer.explore(seeds, reserve)
    result.notes[:0] = [*conserved_notes(model), *_of_group(problem), *notes]
    return result


@one_thread
def phase(
    model: Any,
    pair: Sequence[str],
    range: Mapping[str, Sequence[float]] | None = None,
    *,
    start: object = None,
    parameters: Record | None = None,
    orbits: bool = True,
    settings: Settings | Record | None = None,
    watch: Watcher | None = None,
    journal: Journal | None = None,
) -> Any:
    """The phase diagram of a model in two parameters: a `PhaseDiagram` of curves and regions.

    pair : the two names; the first is drawn horizontally.  range : {name: (lo, hi)}, by default the model's own.
    start : a named start, a mapping of states, or a list of them.  parameters : values of the others.
    orbits : periodic orbits and their curves too (LPC, PD, NS, BPC and homoclinic ones), not only equilibria.

    journal : keeps every chunk and curve, and answers with those of an earlier, killed run.

    Ctrl-C ends the search: what was computed is returned, with `stopped` true.

    Raises NoSolutionError where no start leads to an equilibrium.
    """
    need_model(model)
    need_time(model, "phase diagrams")
    model = for_branches(model)
    if getattr(model, "forcing", None) is not None:
        raise InputError(
            "phase diagrams start from equilibria, which a forced flow has none of: write the forcing as two states "
            "more, such as c' = c - w*s - c*(c^2 + s^2), s' = s + w*c - s*(c^2 + s^2) for cos(w*t) and sin(w*t), or "
            "follow curves of LPC, PD and NS from its diagram in one parameter"
        )
    named, _ = _named_starts(model, start)
    found, failure = [], None
    for _, one in named:
        try:
            found.append(equilibrium(model, one, parameters))
        except (NoSolutionError, NotFiniteError) as error:
            failure = error
    if not found:
        raise failure or NoSolutionError("a phase diagram needs a start")
    found = [as_small(e) for e in found]
    if any(not isinstance(e, Equilibrium) for e in found):
        raise InputError(
            "phase diagrams need a model of formulas of fewer than 150 states, or a function of at most "
            f"{SMALL} states or with a dense Jacobian, and no singular mass matrix"
        )
    known = varying(found[0].system.parameter_names)
    for name in pair:
        place_of_parameter(name, known)
    box = {name: bounds_of(found[0].problem(name), name, range) for name in pair}
    result = compute(found, pair, box, settings, watch, orbits, journal)
    alone = (FUNCTION,) if orbits and isinstance(model, FunctionProblem) and model.kind == "flow" else ()
    return replace(result, notes=(*conserved_notes(model), *group_note(found[0].system), *alone, *result.notes))


def _of_group(problem: Problem) -> tuple[str, ...]:
    """What to say of the declared symmetries of a problem that has a system."""
    system = getattr(problem, "system", None)
    return () if system is None else group_note(system)


def _named_starts(model: Model, start: object) -> tuple[list[tuple[str, Any]], bool]:
    """Starts with their names, and whether all equilibria are wanted too."""
    given = list(start) if isinstance(start, list | tuple) else [start]
    everywhere = any(isinstance(one, str) and one == EVERYWHERE for one in given) and not any(
        s.name == EVERYWHERE for s in model.starts
    )
    if everywhere:
        given = [one for one in given if not (isinstance(one, str) and one == EVERYWHERE)]
    named = []
    for k, one in enumerate(given):
        name = one if isinstance(one, str) else "start" if len(given) == 1 else f"start{k + 1}"
        named.append((name, one))
    return named, everywhere


def everywhere_in(
    model: Any, parameter: str, limits: tuple[float, float] | None, box: Any, parameters: Record | None
) -> list[Seed]:
    """Seeds of all equilibria (of a forced flow: periodic responses) at the parameter's own value and some others."""
    _, p = model.start_point(None, dict(parameters or {}))
    own = float(p[list(model.parameter_names).index(parameter)])
    lo, hi = limits or bounds_of(_Ranges(model), parameter, None)
    spread = lo + (hi - lo) * np.array([0.5, 0.25, 0.75, 0.05, 0.95])
    values = ([own] if lo <= own <= hi else []) + spread.tolist()
    if getattr(model, "forcing", None) is not None:
        return responses_in(model, parameter, values, box, parameters)
    seeds = []
    for value in values:
        found = find_equilibria(model, box, {**(parameters or {}), parameter: value})
        seeds += [as_seed(one, parameter) for one in found if one.isolated]
    return seeds


def _default_box(model: Any, parameters: Record | None) -> str:
    """Where 'all' was looked for when nobody said where."""
    within = [f"{name} within {high:g}" for name, (_, high) in reach_of(model, parameters).items()]
    shown = ", ".join(within[:SHOWN]) + (", ..." if len(within) > SHOWN else "")
    where = f"with {shown} of 0 (twice as far as starts and `scale` say)" if within else "at all angles"
    return f"start 'all': looked for {where}; a `box` says where else to look"


def _noun(model: Model) -> str:
    return "equilibrium" if getattr(model, "forcing", None) is None else "periodic response"


class _Ranges:
    """The default ranges of a model, for `bounds_of`."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        found: tuple[float, float] | None = self.model.parameter_range(parameter)
        return found
