"""Where a branch comes back to its start: a closed loop."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.continuation.branch import End
from contin.continuation.curve import Stretch
from contin.continuation.location.sameness import offset, seen, wrapped
from contin.continuation.sample import Sample

CLOSED: Final = 1e-5  # a branch has returned to its start when it passes it closer than this (scaled)
NEAR: Final = 4.0  # last steps: how close to its start a branch is where that is worth a look


def back_at_start(stretch: Stretch, last: Sample, loop: Sample, earlier: Sample | None) -> tuple[Sample, End] | None:
    """The start `loop` again, where the step to `last` passed it, and the end of the arm there.

    Angles are as the branch brought them, some periods further, and so are the auxiliary vectors of a locus, whose sign
    may have turned.  earlier : the row before the step, None in the first one, which leaves the start and does not
    come back to it, though the start solved again may lie behind it by rounding.
    """
    problem, scale = stretch.problem, stretch.frame.scale
    near = NEAR * stretch.distance(stretch.base, last)
    if problem.apart(loop.z, last.z, scale) > near:
        return None
    start = problem.in_phase(loop, last.z, scale)

    def along(sample: Sample) -> float:
        return float(start.tangent @ offset(problem, sample.z, start.z, scale))

    if not (along(stretch.base) < 0.0 <= along(last)):
        return None
    if np.linalg.norm(offset(problem, last.z, start.z, scale)) > near:
        return None
    if earlier is None and np.linalg.norm(offset(problem, stretch.base.z, start.z, scale)) <= CLOSED:
        return None
    _, high = stretch.zero(along, stretch.base, last, 1e-9)
    start = problem.in_phase(loop, high.z, scale)
    if np.linalg.norm(offset(problem, high.z, start.z, scale)) > CLOSED:
        return None
    winding = (high.z - start.z) - wrapped(problem, high.z - start.z)
    z = start.z + winding
    z = np.where(seen(problem, np.ones(len(z))) > 0.0, z, high.z)
    where = f"{problem.parameters[0]} = {start.z[-1]:.10g}"
    return replace(high, z=z), End("closed", f"closed loop: back at the start, {where}")
