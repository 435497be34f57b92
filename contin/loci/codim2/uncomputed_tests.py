"""Test functions that could not be computed at some points of a curve: zeros there are not found, which a note says."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints


def untold(problem: CurveOfPoints, label: str, reason: Exception) -> float:
    """The test's value, 0 (which has no sign), remembered as one that is not known."""
    problem.memory.setdefault("untold", {}).setdefault(label, []).append(str(reason))
    return 0.0


def remarks(problem: CurveOfPoints) -> Sequence[str]:
    """Which tests failed, how often and why."""
    return [
        f"the test of {label} could not be computed at {len(reasons)} places ({reasons[0]}); {label} there are not told"
        for label, reasons in problem.memory.get("untold", {}).items()
    ]
