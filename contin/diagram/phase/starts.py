"""Where branches begin on a line across the box: starts brought there, and what is known to cross it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.sample import opposite
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.continuation.trace import trace
from contin.diagram.phase.lines import Box
from contin.errors import ContinError
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.maps.cycle import CycleProblem


def was_stopped(branch: Branch) -> bool:
    """True where Ctrl-C ended it."""
    return any(end.reason == "stopped" for end in branch.ends)


def brought(
    problem: EquilibriumProblem, start: tuple[Array, Array], names: tuple[str, str], box: Box, axis: int, value: float,
    settings: Settings,
) -> list[Seed]:  # fmt: skip
    """A start with the other parameter brought to `value`, then the parameter itself into its range."""
    u, p = start
    own = list(problem.system.parameter_names)
    k, j = (own.index(names[i]) for i in (axis, 1 - axis))
    inside = float(np.clip(p[k], *box[axis]))
    for order in ((k, inside), (j, value)), ((j, value), (k, inside)):
        state, at = u, p.copy()
        for active, wanted in order:
            reached = _bring(replace(problem, base=at.copy(), active=active), state, wanted, settings)
            if reached is None:
                break
            state, at[active] = reached, wanted
        else:
            return [Seed(replace(problem, base=at, active=k), np.append(state, at[k]))]
    return []


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
        except ContinError:  # the start is not brought there, which the caller tells
            return None
        if was_stopped(branch):
            raise KeyboardInterrupt
        row = -1 if sense > 0 else 0
        if abs(float(branch.z[row, -1]) - value) < 1e-9 * width:
            return np.asarray(branch.z[row, :-1])
    return None


def _where_zero(column: Array, z: Array) -> Iterator[Array]:
    """Rows z (N, .) at which the column (N,) vanishes, as at labelled values, and points of chords where it does."""
    yield from z[column == 0.0]
    for row in np.flatnonzero(opposite(column[:-1], column[1:])):
        t = column[row] / (column[row] - column[row + 1])
        yield (1.0 - t) * z[row] + t * z[row + 1]


def on_branch(branch: Branch, parameter: str, bounds: Sequence[float], value: float) -> list[Seed]:
    """Equilibria of a branch in the other parameter where that has this value, as starts of branches."""
    problem: Any = branch.problem
    column = branch.z[:, -1] - value
    k = list(problem.system.parameter_names).index(parameter)
    seeds = []
    for guess in _where_zero(column, branch.z):
        z = problem.at_parameter(guess, value, problem.initial_scale(guess, bounds))
        if z is not None:
            p = getattr(problem, "inner", problem).full_parameters(z)
            inner = getattr(problem, "inner", problem)
            other = replace(inner, base=p, active=k)
            seeds.append(Seed(other if inner is problem else CycleProblem(other), np.append(z[:-1], p[k])))
    return seeds


def on_curve(locus: Branch, problem: EquilibriumProblem, axis: int, value: float) -> list[Seed]:
    """Points of a curve on the line where the parameter across `axis` has this value, as starts of branches."""
    along: Any = locus.problem
    curve = along.curve
    index = len(locus.z[0]) - (1 if axis == 1 else 2)  # where the other parameter stands
    column = locus.z[:, index] - value
    seeds = []
    for guess in _where_zero(column, locus.z):
        z = along.at_unknown(index, guess, value, along.initial_scale(guess, along.first_bounds))
        if z is None:
            continue
        p = curve.full_parameters(z)
        k = curve.first if axis == 0 else curve.second
        states = np.append(z[: curve.n], p[k])
        if curve.system is problem.system:
            seeds.append(Seed(replace(problem, base=p, active=k), states))
        else:  # cycles of a map: fixed points of its iterate
            cycle = CycleProblem(replace(problem, system=curve.system, base=p, active=k))
            seeds.append(Seed(cycle, cycle.lift(states)))
    return seeds
