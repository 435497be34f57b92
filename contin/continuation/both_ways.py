"""Closed curves of which neither way from the start is long enough to come back to it: both ways meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.metric import measured_in
from contin.continuation.problem import Problem
from contin.continuation.sample import Sample
from contin.continuation.segment import Segment
from contin.linalg.vectors import norm


def far_end(problem: Problem, segments: Sequence[Segment], end: End, scale: Array) -> Sample | None:
    """Where a way has used up its steps, as the other way comes there if the curve is closed; measured in `scale`.

    None where there is no such place, or on meshes, which both ways do not share.
    """
    last = next((segment for segment in reversed(segments) if len(segment.z)), None)
    if problem.adaptive or last is None or end.reason != "steps":
        return None
    here = Sample(last.z[-1], -last.tangents[-1], np.empty(0), int(last.unstable[-1]), last.eigenvalues[-1])
    return measured_in(here, last.scale, scale)


def lies_between(far: Sample, start: Array, origin: Array, scale: Array) -> bool:
    """Whether the one way has ended between the start and the point beside it where the other one sets out."""
    before, after = (float(far.tangent @ ((z - far.z) / scale)) for z in (start, origin))
    return before < 0.0 <= after and norm((start - far.z) / scale) <= norm((origin - start) / scale)


def meeting(far: Sample, parameter: str) -> End:
    """The end of both ways."""
    return End("closed", f"closed loop: both ways from its start meet, {parameter} = {far.z[-1]:.10g}")
