"""Whether the parameter turns at a point that was verified as a fold, by the residual alone.

Derivatives that are wrong, or differences taken across a corner, can make F_u look singular. The curve itself says: at
distance s along its tangent the parameter has moved by P(s) = a s^2 + b s^3 + ... at a fold, by about |s| at a corner
where it turns, and by c s where it does not turn.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.corrector import Linearisation
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import dot, norm
from contin.machine import elementary

NEAR, FAR = 0.006, 0.03  # distances in the metric, beyond the reach of differences across a corner
NOISE: Final = 1e-9  # moves of the parameter that say nothing
SQUARE: Final = 1.5  # power of s below which the parameter does not turn smoothly
PLAIN: Final = 1e-3  # part of the parameter's way: shorter corrections do not change what is told from it
CHORDS: Final = Rules(settled=1e-2 * NOISE, stalled=NOISE, ratio=0.9, growth=10.0, budget=25)  # they fall slowly


def no_fold(residual: Callable[[Array], Array], here: Linearisation | None, z: Array, scale: Array) -> str | None:
    """Why the point z (n + 1,), verified as a fold, is none; None where it is one or nothing can be said.

    here : solves with [J; t] at z in scaled unknowns, t a tangent of the branch near it.
    """
    if here is None:
        return None
    t = here.solve(np.append(np.zeros(len(z) - 1), 1.0))
    if not np.all(np.isfinite(t)) or norm(t) == 0.0:
        return None
    t = t / norm(t)
    even, odd = [], []
    bend = np.zeros(len(z))
    for s in (NEAR, FAR):
        sides = []
        for side in (1.0, -1.0):
            y = _moved(residual, here, z, t, scale, side * s, bend)
            if y is None:
                return None
            bend = (y - side * s * t) / (s * s)  # the next one starts on this parabola
            sides.append(float(y[-1]))
        even.append(abs(sides[0] + sides[1]) / 2.0)
        odd.append(abs(sides[0] - sides[1]) / 2.0)
    if max(even[0], odd[0]) < NOISE:
        return None
    if odd[0] > even[0] and odd[1] > even[1]:
        return "the parameter does not turn here: the derivatives are wrong, or the function is not smooth"
    if even[1] < even[0] * elementary.pow(FAR / NEAR, SQUARE):
        return "the parameter turns at a corner, where the function is not smooth"
    return None


def _moved(
    residual: Callable[[Array], Array], here: Linearisation, z: Array, t: Array, scale: Array, s: float,
    bend: Array,
) -> Array | None:  # fmt: skip
    """The way (scaled) from z to where the curve has gone s along t, from a guess s t + s^2 bend; by chords."""

    def correct(y: Array) -> tuple[float, Array] | None:
        f = residual(z + scale * y)
        if not np.all(np.isfinite(f)):
            return None
        d = here.solve(np.append(-f / scale[:-1], 0.0))
        d = d + (s - dot(t, y + d)) * t
        size, there = norm(d), np.asarray(y + d)
        return (0.0 if size <= PLAIN * abs(float(there[-1])) else size), there

    found = newton(correct, s * t + s * s * bend, CHORDS)
    return None if found is None else found.at
