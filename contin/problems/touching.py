"""A branch that touches another: where it goes on beyond the point, and where the other one is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.continuation.problem import Frame, Sample, Verified
from contin.continuation.settings import Settings
from contin.problems.describe import sheets_at

if TYPE_CHECKING:
    from contin.problems.equilibrium import EquilibriumProblem


def beyond(problem: EquilibriumProblem, point: Verified, frame: Frame, settings: Settings) -> Sample | None:
    """A point of the branch on the other side than its anchor `beside`, its tangent leading away."""
    own = point.vectors.get("beside")
    if own is None:
        return None
    sheets = sheets_at(problem, point.z, frame.scale)
    y = own / frame.scale
    side = -1 if float(sheets.tangent @ (y - sheets.y)) > 0.0 else 1
    pair = sheets.beside(y).get(side)
    if pair is None:
        return None
    z = pair[0] * frame.scale
    base = Sample(z, side * sheets.tangent, np.full(4, np.nan), 0, np.empty(0, complex))
    found: Sample | None = problem.probe(base, 0.0, z, frame, settings)
    return found
