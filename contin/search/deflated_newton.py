"""Deflated Newton: solutions of F(u) = 0 at fixed parameters beside those that are known.

Newton's method on m(u) F(u), m = prod (1/|u - u_i|^2 + 1) over the known solutions u_i, does not converge to these. Its
step is Newton's own, d = -F_u^-1 F, divided by 1 - g.d with g = grad log m: one solution of a linear system, as
without deflation (Farrell, Birkisson and Funke, SIAM J. Sci. Comput. 37 (2015) A2026).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import dot, norm

STEPS: Final = 30
FAR: Final = 30.0  # sizes: where nothing is to be found
ACCURATE: Final = 1e-11  # of the last correction, relative to the solution's size
SAME: Final = 1e-6  # solutions nearer than this part of their size are one
LONGEST: Final = 4.0  # longest step, in sizes
SHORT: Final = 0.3  # ... from a guess that is a solution in every part: longer ones leave its neighbourhood
STUCK: Final = 1e-8  # denominators below this: the step has no direction

Correction = Callable[[Array], "Array | None"]  # Newton's step at u, None where there is none


def beside(
    correction: Correction, guess: Array, known: Sequence[Array], size: float, longest: float = LONGEST
) -> Array | None:
    """A solution from a guess that is none of the known ones; None where there is none within `STEPS`."""
    u = guess.copy()
    if any(norm(u - v) <= SAME * size for v in known):  # the deflation has no slope there
        return None
    for _ in range(STEPS):
        d = correction(u)
        if d is None or not np.all(np.isfinite(d)):
            return None
        if norm(d) <= ACCURATE * max(size, norm(u)):
            return u if is_new(u, known, size) else None
        denominator = 1.0 - dot(_slope(u, known, size), d)
        if abs(denominator) < STUCK:
            return None
        d = d / denominator
        length = norm(d)
        u = u + d * min(1.0, longest * size / length)
        if not norm(u) < FAR * size:
            return None
    return None


def _slope(u: Array, known: Sequence[Array], size: float) -> Array:
    """grad log m, lengths in units of `size`."""
    total = np.zeros_like(u)
    for v in known:
        gap = (u - v) / size
        square = max(dot(gap, gap), 1e-300)
        total -= 2.0 * gap / (square * (1.0 + square)) / size
    return total


def is_new(u: Array, known: Sequence[Array], size: float) -> bool:
    """True where u is none of the known solutions."""
    return all(norm(u - v) > SAME * max(size, norm(u)) for v in known)
