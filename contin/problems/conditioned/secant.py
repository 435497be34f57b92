"""The zero of a function of samples along a curve, from a sample near it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings

TRIAL: Final = 1e-3  # scaled length of the first step
BUDGET: Final = 30
EXACT: Final = 1e-13
GOOD: Final = 1e-5


def zero_along(
    problem: Any, near: Sample, frame: Frame, function: Callable[[Sample], float]
) -> tuple[Sample, float, float] | None:
    """(sample, value left, error of the parameter) at the zero of `function`; None where it is not found.

    problem : with `probe`.  The error is that of steps which no longer fall, in the parameter's own unit.
    """
    settings = Settings()

    def at(s: float) -> Sample | None:
        return problem.probe(near, s, near.z + s * frame.scale * near.tangent, frame, settings)  # type: ignore[no-any-return]

    one, other = at(0.0), at(TRIAL)
    if one is None or other is None:
        return None
    s0, v0, s1, v1, sample = 0.0, function(one), TRIAL, function(other), other
    last = np.inf
    for _ in range(BUDGET):
        if v1 == v0:
            break
        step = -v1 * (s1 - s0) / (v1 - v0)
        if not np.isfinite(step) or abs(step) > 0.5 or (abs(step) >= 0.5 * last and last < GOOD):
            break
        found = at(s1 + step)
        if found is None:
            return None
        s0, v0, s1, v1, sample, last = s1, v1, s1 + step, function(found), found, abs(step)
        if last < EXACT:
            break
    if not last < GOOD:
        return None
    slope = abs(float(sample.tangent[-1])) * float(frame.scale[-1])
    return sample, v1, slope * last + 4.0 * np.finfo(float).eps * abs(float(sample.z[-1]))
