"""Whether solutions inside a step lie on the cubic in arclength through its two rows and their tangents.

Rows of one smooth branch do so, beside its folds, too. Of two branches, what lies between them is of the one or of the
other, and at one place at most as near to the cubic as to pass for a point of it; so two are asked.
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
    """From a row to the next one: unknowns on the first one's mesh, and what both tangents foretell for the whole."""

    ends: tuple[Array, Array]  # (N,) each
    rise: Array  # (N,) the change that the first row's tangent foretells
    parameter: tuple[Array, Array]  # (1,) each: its changes that the two rows' tangents foretell
    scale: Array  # (N,) for corrections


def on_cubic(
    problem: Problem, step: Step, values: tuple[Array, Array], slopes: tuple[Array, Array],
    seen: Callable[[Array], Array], length: Callable[[Array], Array], noise: Array,
) -> bool:  # fmt: skip
    """True where solutions inside a step lie on the cubic, to a part `SMOOTH` of what changes, or to noise.

    What changes is the larger one of a step and what its slopes foretell: of many unknowns, as the values of a field,
    some end where they began.

    values : at the two rows, as `seen` makes them of unknowns.  slopes : changes of these that each row's tangent
    foretells for the whole step.  length : of values and noise, each compared by itself.
    """
    here, there = step.ends
    changes = np.maximum(length(values[1] - values[0]), np.maximum(length(slopes[0]), length(slopes[1])))
    allowed = np.maximum(SMOOTH * changes, noise)
    between = sorted((float(here[-1]), float(there[-1])))
    for s in INSIDE:
        place = float(_cubic(s, (here[-1:], there[-1:]), step.parameter)[0])
        if not between[0] < place < between[1]:
            return False
        found = problem.at_parameter(here + s * step.rise + s * s * (there - here - step.rise), place, step.scale)
        if found is None or np.any(length(seen(found) - _cubic(s, values, slopes)) > allowed):
            return False
    return True


def _cubic(s: float, values: tuple[Array, Array], slopes: tuple[Array, Array]) -> Array:
    """At s in [0, 1], from values and slopes at its ends."""
    (start, end), (rise, fall) = values, slopes
    moved = end - start
    return np.asarray(start + s * rise + s * s * (3.0 * moved - 2.0 * rise - fall + s * (rise + fall - 2.0 * moved)))
