"""The curve of cusps of boundary-value problems in three parameters."""

from __future__ import annotations

from collections.abc import Sequence

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.of_boundary import cusps
from contin.transitions.registry import born


@born(AdaptiveCurve, "CP", "the curve of such points in three parameters", parameters=3)
def cusps_in_three(problem: AdaptiveCurve, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Seed of the curve of cusps."""
    return [cusps(problem, point.z, parameters, Parent(point.branch, point.label))]
