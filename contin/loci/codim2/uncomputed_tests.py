"""Test functions that could not be computed at some points of a curve: zeros there are not found, which a note says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contin.abi import Array

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints


def untold(problem: CurveOfPoints, label: str, z: Array, reason: Exception) -> float:
    """The test's value, 0 (which has no sign), remembered as one that is not known."""
    problem.memory.setdefault("untold", {}).setdefault(label, []).append((z.copy(), str(reason)))
    return 0.0


def remarks(problem: CurveOfPoints, z: Array) -> Sequence[str]:
    """Which tests failed, how often and why; not where all rows have them.

    z : the curve's rows. A step that lands on a pole is repeated a little shorter, and points between rows that come to
    one are there because the label of the pole is looked for: no sign of a row is missing then.
    """
    rows = {row.tobytes() for row in z}
    found = []
    for label, places in problem.memory.get("untold", {}).items():
        if not any(at.tobytes() in rows for at, _ in places):
            continue
        reason = places[0][1]
        found.append(
            f"the test of {label} could not be computed at {len(places)} places ({reason}); {label} there are not told"
        )
    return found
