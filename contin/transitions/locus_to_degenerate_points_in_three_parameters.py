"""Curves of cusps and of degenerate branch points of boundary-value problems in three parameters."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.of_boundary import degenerate
from contin.transitions.registry import born


@born(AdaptiveCurve, "CP DP", "the curve of such points in three parameters", parameters=3)
def degenerate_in_three(problem: AdaptiveCurve, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve."""
    return [degenerate(problem, point, parameters)]
