"""The zero of a function of samples along a curve, from a sample near it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.secant import SecantRules, secant

SECANT: Final = SecantRules(trial=1e-3, far=0.5, stalled=1e-5, good=1e-5)  # scaled lengths


def zero_along(
    problem: Any, near: Sample, frame: Frame, function: Callable[[Sample], float]
) -> tuple[Sample, float, float] | None:
    """(sample, value left, error of the parameter) at the zero of `function`; None where it is not found.

    problem : with `probe`.  The error is that of steps which no longer fall, in the parameter's own unit.
    """
    settings = Settings()

    def look(s: float, _: Sample | None) -> tuple[Sample, float] | None:
        sample = problem.probe(near, s, near.z + s * frame.scale * near.tangent, frame, settings)
        return None if sample is None else (sample, function(sample))

    found = secant(look, SECANT)
    if found is None:
        return None
    sample = found.at
    slope = abs(float(sample.tangent[-1])) * float(frame.scale[-1])
    return sample, found.value, slope * found.step + 4.0 * np.finfo(float).eps * abs(float(sample.z[-1]))
