"""What starts at a special point: branches in one parameter, curves in two, and what the explorer follows by itself."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.as_computed import as_computed
from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.continuation.stored_problem import StoredProblem
from contin.errors import InputError
from contin.machine.one_thread import one_thread
from contin.transitions.registry import Explored, at_point, known_labels

if TYPE_CHECKING:
    from contin.continuation.problem import Problem


LEVEL: Final = 1e-5  # scaled slope of the parameter along a branch, so small that it is the one that turns


@one_thread
def switch(problem: Problem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of the branches that start at a point of this problem's branch, with `parameter` free."""
    point = as_computed(point)
    problem = point.problem if isinstance(problem, StoredProblem) else problem
    rows = at_point(problem, point.type, 1)
    if not rows:
        raise InputError(
            f"{point.branch}.{point.label}: nothing is known to be born at points of type {point.type} here"
            + _where(problem, 1)
        )
    seeds = [seed for row in rows for seed in row.make(problem, point, parameter)]
    return [_level(seed) for seed in seeds] if point.normal_form.get("kind") == "pitchfork" else seeds


def _level(seed: Seed) -> Seed:
    """At a pitchfork the parameter does not change along the branch that turns there: what is left of it is rounding.

    From that branch's slope a fold beside the point would be foretold (`continuation.outset`).
    """
    if seed.direction is None or not 0.0 < abs(float(seed.direction[-1])) < LEVEL:
        return seed
    return replace(seed, direction=np.append(seed.direction[:-1], 0.0))


@one_thread
def loci(problem: Problem, point: SpecialPoint, parameters: Sequence[str], orbits: bool = True) -> list[Seed]:
    """Seeds of the curves in two (three) parameters that pass through a point of this problem's branch.

    orbits : those of orbits that grow from a point of equilibria, too; they take long to make.
    """
    point = as_computed(point)
    problem = point.problem if isinstance(problem, StoredProblem) else problem
    if point.type == "LP" and point.normal_form.get("of") == "curve":
        raise InputError(
            f"{point.branch}.{point.label} is a fold of the curve of solutions that meet the conditions, and none at "
            "fixed parameters: curves of such points are not followed"
        )
    count = max(2, len(parameters))  # one is too few, as whoever is asked for two says
    rows = at_point(problem, point.type, count)
    if not rows:
        words = {2: "two", 3: "three"}.get(count, str(count))
        raise InputError(
            f"{point.branch}.{point.label}: {point.type} has no curve in {words} parameters" + _where(problem, count)
        )
    wanted = [row for row in rows if orbits or row.explored is None or not row.explored.orbits]
    return [seed for row in wanted for seed in row.make(problem, point, tuple(parameters))]


def explored(problem: Problem, point: SpecialPoint) -> Explored | None:
    """What the explorer does about a point; None where it leaves it alone."""
    rows = [row for row in at_point(problem, point.type, 1) if row.explored is not None]
    rule = rows[0].explored if rows else None
    return None if rule is None or (rule.when is not None and not rule.when(problem)) else rule


@one_thread
def departures(problem: Problem, point: SpecialPoint, parameter: str, orbits: bool) -> list[Seed]:
    """Everything that is born at a labelled point, for the explorer."""
    rule = explored(problem, point)
    if rule is None or (rule.orbits and not orbits):
        return []
    if not rule.uncertain:
        return switch(problem, point, parameter)
    with suppress(InputError):  # marked as uncertain: there may be nothing
        return switch(problem, point, parameter)
    return []


def _where(problem: Problem, parameters: int) -> str:
    labels = known_labels(problem, parameters)
    return f"; {', '.join(labels)} have" if labels else ""
