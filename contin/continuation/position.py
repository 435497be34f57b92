"""Where a solution is, in the words of notes and ends."""

from __future__ import annotations

from contin.abi import Array
from contin.continuation.problem import Problem, in_two_parameters


def position(problem: Problem, z: Array) -> str:
    """`p = 1.25`, or `p = 1.25, q = 3` on a curve in several parameters, whose walls say where in z each stands."""
    places = [index for index, _, _ in reversed(problem.walls)] if in_two_parameters(problem) else [-1]
    return ", ".join(f"{name} = {z[place]:.10g}" for name, place in zip(problem.parameters, places, strict=False))


def elsewhere(others: int) -> str:
    """` and at 2 more places`, behind a note that names one; empty where there are no others."""
    return f" and at {others} more place{'s' * (others > 1)}" if others else ""
