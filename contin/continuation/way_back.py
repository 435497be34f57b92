"""Solutions that are followed at fixed parameters, from a row back to those before it."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto
from itertools import pairwise
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Problem

PARTS: Final = 8  # of a step
LED: Final = 0.2  # of what changes in the step: how far the way back is from what is foretold where it jumps itself
LEFT: Final = 0.1  # of how far the way back has led: what the corrector has left in the row where it begins
APART: Final = 0.5  # of a state's change: two solutions that differ by more are two
MET: Final = 0.05  # of a state's change: a row as near to the way back is of its branch
ASIDE: Final = 0.01  # of the way to another solution: a guess from which one is found again to what is known of it
CLEAR: Final = 10.0  # times what is not known of a solution: a difference that is none of it
RETURNED: Final = 1e-3  # of how far the way back has led: where it begins, found again from its end


class Answer(Enum):
    """What is known of some rows in turn."""

    ONE = auto()  # all of them are of one branch
    TWO = auto()  # the first one is of another branch than the last
    UNKNOWN = auto()


def followed(
    problem: Problem, start: Array, places: list[float], scale: Array,
    length: Callable[[Array, Array], Array] = lambda _, change: np.abs(change),
) -> tuple[list[Array], Array]:  # fmt: skip
    """Solutions at some parameters in turn: at the last part of each step; and how far one was from what was foretold.

    None of them where one is not found.
    length : (k,), each compared by itself, of a solution and how far it is from what was foretold.
    """
    at, before, hop, rows = start, None, np.zeros(1), []
    for number, place in enumerate(places, 1):
        guess = at.copy() if before is None else 2.0 * at - before
        found = problem.at_parameter(guess.copy(), place, scale)
        if found is None:
            return [], hop
        before, at, hop = at, found, np.maximum(hop, length(found, found - guess))
        if number % PARTS == 0:
            rows.append(at)
    return rows, hop


def way_back(parameters: Array) -> list[float]:
    """From the first of some values to the last, by all of them, each step in `PARTS` parts."""
    steps = [a + (b - a) * np.arange(1, PARTS + 1) / PARTS for a, b in pairwise(parameters)]
    return [float(place) for step in steps for place in step]
