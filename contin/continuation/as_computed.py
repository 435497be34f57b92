"""Points that were read from a file, as they were computed."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from contin.continuation.stored_problem import StoredProblem

if TYPE_CHECKING:
    from contin.continuation.branch import SpecialPoint


def as_computed(point: SpecialPoint) -> SpecialPoint:
    """A point with its equations; one from a file as it was computed. InputError where the file does not have it."""
    problem = point.problem
    if not isinstance(problem, StoredProblem):
        return point
    return cast("SpecialPoint", problem.computed())
