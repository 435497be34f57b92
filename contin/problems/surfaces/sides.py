"""On which side of a surface of discontinuity a solution is, also where it lies on the surface itself.

There its height has no sign, or that of its rounding errors. It is a solution of the equations of one side, though, and
not of those of the other one, for they jump.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.problems.surfaces.jumps import Jump

BESIDE: Final = 1e-6  # of the change of a height: below this its sign may be that of rounding errors

Place = tuple[Array, Array, Array]  # states, parameters, and what the equations are there: 0 at rest, or the next point


def side_of(jump: Jump, u: Array, p: Array, target: Array, change: float) -> bool | None:
    """True above the surface, False below it; None on it, where both sides, or none, have the solution.

    target (n,) : the value of the equations at the solution u.  change : how much the height changes beside it.
    """
    height = jump.height(u, p)[0]
    if abs(height) > BESIDE * abs(change):
        return height > 0.0
    below, above = (float(np.abs(side.value(u, p) - target).max()) for side in (jump.lower, jump.upper))
    return above < below if above != below else None


def between(jumps: Sequence[Jump], a: Place, b: Place) -> bool:
    """True where two solutions are on different sides of a surface on which the equations jump."""
    for jump in jumps:
        before, after = jump.height(a[0], a[1])[0], jump.height(b[0], b[1])[0]
        if before * after > 0.0 or before == after:
            continue
        t = before / (before - after)
        u, p = ((1.0 - t) * a[k] + t * b[k] for k in (0, 1))
        if not jump.is_jump(u, p):
            continue
        change = after - before
        sides = side_of(jump, *a, change), side_of(jump, *b, change)
        if None not in sides and sides[0] != sides[1]:
            return True
    return False
