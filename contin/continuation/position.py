"""Where a solution is, in the words of notes and ends."""

from __future__ import annotations

from contin.abi import Array
from contin.continuation.problem import Problem, is_planar


def position(problem: Problem, z: Array) -> str:
    """`p = 1.25`, or `p = 1.25, q = 3` on a curve in several parameters; the last unknown is the first parameter."""
    names = problem.parameters
    if not is_planar(problem):
        names = names[:1]
    return ", ".join(f"{name} = {z[-1 - k]:.10g}" for k, name in enumerate(names))
