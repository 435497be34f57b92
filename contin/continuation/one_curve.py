"""Whether solutions inside a step lie on the cubic in the parameter through its two rows and their slopes.

Rows of one smooth branch do so. Of two branches, what lies between them is of the one or of the other, and at one place
at most as near to the cubic as to pass for a point of it; so two are asked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Problem

SMOOTH: Final = 0.03  # part of a change in a step: solutions inside that lie as near to the cubic are of its branch
INSIDE: Final = (0.5, 0.75)  # places in a step


@dataclass(frozen=True, eq=False)
class Step:
    """From a row `here` (N,) along its slope: `first` (N,) is the change that it foretells, `width` the parameter's."""

    here: Array
    first: Array
    width: float
    scale: Array  # (N,), for corrections


def on_cubic(
    problem: Problem, step: Step, values: tuple[Array, Array], slopes: tuple[Array, Array],
    seen: Callable[[Array], Array], length: Callable[[Array], Array], noise: Array,
) -> bool:  # fmt: skip
    """True where solutions inside a step lie on the cubic, to a part `SMOOTH` of what changes, or to noise.

    values : at the two rows, as `seen` makes them of unknowns.  slopes : changes of these that each row's slope
    foretells for the whole step.  length : of values and noise, each compared by itself.
    """
    (start, end), (rise, fall) = values, slopes
    moved, bend = end - start, np.zeros_like(step.here)
    allowed = np.maximum(SMOOTH * length(moved), noise)
    for s in INSIDE:
        place = float(step.here[-1] + s * step.width)
        found = problem.at_parameter(step.here + s * step.first + s * s * bend, place, step.scale)
        if found is None:
            return False
        bend = (found - step.here - s * step.first) / (s * s)
        cubic = start + s * rise + s * s * (3.0 * moved - 2.0 * rise - fall + s * (rise + fall - 2.0 * moved))
        if np.any(length(seen(found) - cubic) > allowed):
            return False
    return True
