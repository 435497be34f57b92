"""Whether a branch ends on another one inside a step, where the other cannot be followed back for the whole step.

Beyond a pitchfork the other branch may be so unstable before it that no orbit of it is shot, or that Newton's method
leaves it. Then the step is halved, at fixed parameters: what is found in its middle goes on from one end, or from the
other, as secants lead. Beside the place that is left the other branch is followed back a little.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Problem

HALVINGS: Final = 12
OUTSIDE: Final = 0.125  # of the step: for the first secants
CLEAR: Final = 1e3  # times what solutions are known to: changes that are asked
NEARER: Final = 0.25  # of how far a solution is from the one secant: so near to the other's one beyond the place
BACK: Final = (4.0, 16.0, 64.0)  # widths of what is left, so far is the other branch followed back
APART: Final = 0.5  # of the branch's change over so much: two solutions that differ by more are two
RETURNED: Final = 1e-2  # of how far apart they are: where the way back begins, found again from its end


def singular_between(
    problem: Problem, first: Array, last: Array, scale: Array, apart: Callable[[Array, Array], Array], known: Array
) -> bool:
    """True where two solutions are of two branches that come together between them.

    apart : (k,) how far two solutions are from each other, in what is asked each by itself.
    known : (k,) how far each is known.
    """
    ends = _halved(problem, first, last, scale, apart, known)
    if ends is None:
        return False
    low, high = ends
    width = float(high[0][-1] - low[0][-1])
    for far in BACK:
        place = float(low[0][-1]) - far * width
        own = problem.at_parameter(low[0] - far * width * low[1], place, scale)
        other = problem.at_parameter(high[0] - (far + 1.0) * width * high[1], place, scale)
        if own is None or other is None:
            return False
        gap, moved = apart(other, own), apart(own, high[0])
        if not np.any((gap > APART * moved) & (gap > CLEAR * known)):
            continue
        again = problem.at_parameter(other + (far + 1.0) * width * high[1], float(high[0][-1]), scale)
        if again is not None and np.all(apart(again, high[0]) <= np.maximum(RETURNED * gap, known)):
            return True
    return False


def _halved(
    problem: Problem, first: Array, last: Array, scale: Array, apart: Callable[[Array, Array], Array], known: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]] | None:  # fmt: skip
    """Solutions on both sides of a short part of the step, each with its slope; None where there are none."""
    whole, width = apart(last, first), float(last[-1] - first[-1])
    asked = whole > CLEAR * known
    if width == 0.0:  # along a continuum at one parameter
        return None
    before = problem.at_parameter(first.copy(), float(first[-1]) - OUTSIDE * width, scale)
    behind = problem.at_parameter(last.copy(), float(last[-1]) + OUTSIDE * width, scale)
    if not asked.any() or before is None or behind is None:
        return None
    if np.any(np.maximum(apart(first, before), apart(behind, last))[asked] > whole[asked]):  # of a branch that turns
        return None
    low, high = (first, (first - before) / (OUTSIDE * width)), (last, (behind - last) / (OUTSIDE * width))
    for _ in range(HALVINGS):
        width *= 0.5
        ahead, back = low[0] + width * low[1], high[0] - width * high[1]
        middle = problem.at_parameter(ahead.copy(), float(ahead[-1]), scale)
        if middle is None:
            return None
        off, beside = (float(np.max(apart(middle, v)[asked] / whole[asked])) for v in (ahead, back))
        if beside >= NEARER * off:
            low = (middle, (middle - low[0]) / width)
        else:
            high = (middle, (high[0] - middle) / width)
    return low, high
