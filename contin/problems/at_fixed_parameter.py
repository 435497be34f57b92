"""A solution at a fixed value of the varying parameter, to full precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.abi import Array
from contin.linalg import newton

if TYPE_CHECKING:
    from contin.problems.contracts import Dense


def at_parameter(problem: Dense, guess: Array, value: float, scale: Array) -> Array | None:
    """Newton on F(u, value) = 0 from a guess, with the problem's `linearise`; None where it does not converge."""
    return newton.with_one_fixed(problem.linearise, len(guess) - 1, guess, value, scale)
