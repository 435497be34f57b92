"""Where a branch goes on beyond a point at which others have its tangent."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.equilibria.branching.degenerate import fan_at, scaled_own

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations


def beyond(problem: AlgebraicEquations, point: Verified, frame: Frame, settings: Settings) -> Sample | None:
    """A point of the branch on the other half than its anchor `beside`, its tangent leading away."""
    own = scaled_own(point, frame.scale)
    found = None if own is None else fan_at(problem, point.z, frame.scale, int(point.vectors.get("kernel", 1)))
    mine = None if found is None or own is None else found.curve_of(own)
    if found is None or mine is None or mine[1] is None:
        return None
    other = mine[1].point
    z, away = other * frame.scale, other - found.y
    base = Sample(z, away / float(np.linalg.norm(away)), np.full(4, np.nan), 0, np.empty(0, complex))
    sample: Sample | None = problem.probe(base, 0.0, z, frame, settings)
    return sample
