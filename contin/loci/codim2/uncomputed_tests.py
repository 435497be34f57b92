"""Test functions that could not be computed at some points of a curve: zeros there are not found, which a note says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints


def untold(problem: CurveOfPoints, label: str, z: Array, reason: Exception) -> float:
    """The test's value, 0 (which has no sign), remembered as one that is not known."""
    problem.memory.setdefault("untold", {}).setdefault(label, []).append((z.copy(), str(reason)))
    return 0.0


def remarks(problem: CurveOfPoints, z: Array) -> Sequence[str]:
    """Which tests failed, how often and why; not where a row alone lies on a pole, whose label tells of it.

    z : the curve's rows. Of a row between two others at which the test is known nothing is lost: its sign changes from
    the one to the other, or does not.
    """
    found = []
    for label, places in problem.memory.get("untold", {}).items():
        known = {at.tobytes() for at, _ in places}
        missing = [k for k, row in enumerate(z) if row.tobytes() in known]
        if _alone(missing, len(z)):
            continue
        reason = places[0][1]
        found.append(
            f"the test of {label} could not be computed at {len(places)} places ({reason}); {label} there are not told"
        )
    return found


def _alone(rows: Sequence[int], count: int) -> bool:
    """Whether each is between two others."""
    return all(0 < k < count - 1 for k in rows) and not np.any(np.diff(rows) < 2)
