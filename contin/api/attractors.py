"""The attractors that a survey starts from: what the starts lead to, and the stable equilibria in the box."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from contin.abi import Array
from contin.api.auto_start import find_start
from contin.api.fixed_totals import for_branches
from contin.api.found_start import FoundStart
from contin.api.searches import find_equilibria
from contin.errors import ContinError, NoSolutionError
from contin.records import Record
from contin.search.equilibrium_from_guess import Equilibrium
from contin.simulate.relax import relax
from contin.systems.functions.function_problem import FunctionProblem

MOST: Final = 4
SAME: Final = 1e-5  # relative difference of two states that are one
SAME_ORBIT: Final = 1e-3  # ... of periods and extents
NEGATIVE: Final = 1e-9  # part of the largest state below which a negative one is rounding
BOX_UP_TO: Final = 30  # states: beyond, the box is too large to search in some tenths of a second


@dataclass(frozen=True, eq=False)
class Attractors:
    """The solutions, with how each was found, and what is to be said of others."""

    found: tuple[FoundStart, ...]
    notes: tuple[str, ...] = ()


def attractors(
    model: Any, parameters: Record | None = None, starts: tuple[Any, ...] = (), most: int = MOST
) -> Attractors:
    """At most `most` different ones: from the starts (default: the states' values and every named start), then the box.

    Equilibria in the box with negative states are left out where no start has any.
    """
    wanted = starts or (None, *(s.name for s in getattr(model, "starts", ())))
    found: list[FoundStart] = []
    notes: list[str] = []
    for start in wanted:
        try:
            one = find_start(model, parameters, None if start == "auto" else start, deflate=not found)
            _add(found, _pushed(model, one))
        except ContinError as error:
            notes.append(f"start {start or 'of the states'}: {error}")
    model = for_branches(model)
    if _searchable(model):
        positive = _is_positive(model, parameters, found)
        for each in find_equilibria(model, None, parameters):
            wanted_here = each.isolated and each.stable and each.image_of is None
            if wanted_here and not (positive and _negative(model, each.equilibrium)):
                _add(found, FoundStart(each.equilibrium, "deflation", "a stable equilibrium in the box"))
    found = [f for f in found if f.system.parameter_names == found[0].system.parameter_names]
    if not found:
        raise NoSolutionError("; ".join(notes) or "no start")
    if len(found) > most:
        notes.append(f"{len(found)} attractors were found; the first {most} are surveyed")
    return Attractors(tuple(found[:most]), tuple(notes))


def _searchable(model: Any) -> bool:
    return (
        getattr(model, "forcing", None) is None
        and 0 < len(model.state_names) <= BOX_UP_TO
        and not (isinstance(model, FunctionProblem) and model.method != "dense")
    )


def _pushed(model: Any, one: FoundStart) -> FoundStart:
    """What the trajectory beside an unstable given state comes to, where that is an equilibrium or a cycle."""
    solution = one.solution
    if one.how != "given" or not isinstance(solution, Equilibrium) or solution.system.kind == "map":
        return one
    end = relax(solution.system, solution.u, solution.p)
    moved = np.max(np.abs(end.u - solution.u) / np.maximum(np.abs(solution.u), float(np.abs(end.u).max()) or 1.0))
    if end.outcome not in ("rest", "moving") or moved < SAME:
        return one
    values = dict(zip(solution.system.parameter_names, solution.p.tolist(), strict=True))
    names = solution.system.state_names
    state = dict(zip(names, end.u.tolist(), strict=True)) if names else end.u
    try:
        return find_start(model, values, state)
    except ContinError:  # the given state is a solution all the same
        return one


def _add(found: list[FoundStart], one: FoundStart) -> None:
    if not any(_same(one.solution, other.solution) for other in found):
        found.append(one)


def _same(a: Any, b: Any) -> bool:
    if type(a) is not type(b):
        return False
    if isinstance(a, Equilibrium):
        size = np.maximum(np.maximum(np.abs(a.u), np.abs(b.u)), 1e-6 * float(np.abs(np.append(a.u, b.u)).max()))
        return bool(np.all(np.abs(a.u - b.u) <= SAME * size))
    if not hasattr(a, "period"):
        return False
    low, high = _extent(a), _extent(b)
    size = np.maximum(np.abs(low), np.abs(high))
    return bool(abs(a.period - b.period) <= SAME_ORBIT * a.period and np.all(np.abs(low - high) <= SAME_ORBIT * size))


def _extent(orbit: Any) -> Array:
    u = orbit.profile.u if hasattr(orbit, "profile") else orbit.nodes.u
    return np.concatenate([u.min(axis=0), u.max(axis=0)])


def _is_positive(model: Any, parameters: Record | None, found: list[FoundStart]) -> bool:
    """True where no start and no solution found has a negative state."""
    names = (None, *(s.name for s in getattr(model, "starts", ())))
    states = [model.start_point(name, dict(parameters or {}))[0] for name in names]
    states += [f.solution.u for f in found if isinstance(f.solution, Equilibrium)]
    return all(bool(np.all(u >= -NEGATIVE * float(np.abs(u).max(initial=0.0)))) for u in states)


def _negative(model: Any, one: Equilibrium) -> bool:
    system = one.system
    values = [one.u]
    if getattr(model, "totals", ()):
        gone = {t.state.name for t in model.totals}
        observed = np.atleast_1d(system.observables(one.u, one.p)).ravel()
        values.append(np.array([v for n, v in zip(system.observable_names, observed, strict=True) if n in gone]))
    every = np.concatenate(values)
    return bool(np.any(every < -NEGATIVE * float(np.abs(every).max(initial=0.0))))
