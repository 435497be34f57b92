"""Points of codimension two on curves of special orbits by shooting, with trajectories of the highest accuracy."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.continuation.problem import Frame, Outcome, Sample, Verified
from contin.loci.orbits import events
from contin.problems.shooting.events import COARSE, FINE
from contin.problems.shooting.locate import accuracy_of_equations

if TYPE_CHECKING:
    from contin.loci.shooting.shot_locus import ShotLocusProblem




def verify(problem: ShotLocusProblem, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The zero of a test function along the curve, and how much it depends on the accuracy of the trajectories."""
    found = events.verify(problem.precise(FINE), type_, near, frame)
    if not isinstance(found, Verified):
        return found
    coarse = max(COARSE, accuracy_of_equations(problem.curve.orbits))
    rough = events.verify(problem.precise(coarse), type_, near, frame)
    apart = 0.0
    if isinstance(rough, Verified):
        apart = float(np.max(np.abs(rough.z[-2:] - found.z[-2:]) / frame.scale[-2:]))
    return replace(found, error=found.error + apart * float(frame.scale[-1]))
