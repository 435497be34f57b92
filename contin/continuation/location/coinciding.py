"""Multipliers that pass the unit circle at one place, as many as a symmetry makes equal: one label for all of them.

With an even number of them no test changes its sign, and defining systems of simple points are singular there. But the
mean of log|m| over all of them is as smooth as one of them is, and vanishes where they pass: its zero is located like
that of a test, and once more on a finer mesh, which gives the error.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found, Note, at_point, noted
from contin.continuation.outcome import Verified
from contin.continuation.sample import Sample
from contin.continuation.together import Together
from contin.linalg.vectors import norm
from contin.machine import elementary

NARROW: Final = 1e-4  # of the step: a bracket whose ends differ by more than rounding, which gives the slope
LAST: Final = 1e-10  # arclength: of the bracket that is taken for the place
SAFETY: Final = 2.0  # of a change from one mesh to the next: the finer one has an error of its own
ROUNDING: Final = float(np.finfo(float).eps)


def located(stretch: Stretch, a: Sample, b: Sample, together: Together) -> tuple[Sample, Sample, Found | Note]:
    """The place between a and b where they pass: a bracket of it, and the label or why there is none."""

    def value(sample: Sample) -> float:
        return together.level(sample).mean

    low, high = stretch.zero(value, a, b, NARROW * stretch.distance(a, b))
    apart = stretch.length_of(high) - stretch.length_of(low)
    slope = (value(high) - value(low)) / apart if apart != 0.0 else 0.0
    bend = abs(float(high.tangent[-1] - low.tangent[-1]) / apart) if apart != 0.0 else 0.0
    if slope == 0.0 or not np.isfinite(slope):
        return low, high, noted(stretch, low, f"{together.type} not verified: the multipliers that pass are lost", True)
    spread = max(together.level(sample).spread for sample in (low, high))
    first, last = stretch.zero(value, low, high, max(LAST, spread / abs(slope)))
    near = first if abs(value(first)) <= abs(value(last)) else last
    error = _error(stretch, near, together, slope, bend)
    if error is None:
        text = f"{together.type} not verified: the orbit is not found on a finer mesh"
        return low, high, noted(stretch, near, text, True)
    unstable = min(a.unstable, b.unstable)
    point = Verified(
        together.type, near.z, abs(value(near)), error, near.eigenvalues, unstable,
        vectors={"theta": together.theta, "kernel": together.count}, remark=together.words,
    )  # fmt: skip
    return low, high, Found(stretch.length_of(near), point, at_point(stretch, near, point))


def _error(stretch: Stretch, near: Sample, together: Together, slope: float, bend: float) -> float | None:
    """Error of the parameter: by the mesh, by what the multipliers differ by, and by what is left at the place."""
    finer = stretch.problem.refined(near, stretch.frame)
    if finer is None:
        return None
    there = finer[1]
    here, beyond = together.level(near), together.level(there)
    rate, width = float(near.tangent[-1]), float(stretch.frame.scale[-1])
    ahead = -beyond.mean / slope
    moved = float(there.z[-1] - near.z[-1]) / width + ahead * rate
    unsure = (abs(here.mean) + here.spread + beyond.spread) / abs(slope) + LAST
    error = SAFETY * (abs(moved) + 0.5 * bend * elementary.square(ahead)) + unsure * (abs(rate) + 0.5 * bend * unsure)
    error = error * width + ROUNDING * (abs(float(near.z[-1])) + width)
    return error if np.isfinite(error) and norm(there.tangent) > 0.0 else None
