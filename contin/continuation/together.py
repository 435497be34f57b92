"""Multipliers that a symmetry makes equal, which pass the unit circle together: what the engine is told of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from contin.continuation.sample import Sample


@dataclass(frozen=True, eq=False)
class Level:
    """Of multipliers that pass the unit circle together, at one sample: the mean of log|m|, and by how much they
    differ from it (the largest difference of log m, also of the angles)."""

    mean: float
    spread: float


@dataclass(frozen=True, eq=False)
class Together:
    """All that changes between two samples: `count` multipliers (of NS: pairs) that are one to rounding.

    theta : their angle.  level : of them at a sample in between.  words : what is not known about such a point.
    """

    type: str
    count: int
    theta: float
    level: Callable[[Sample], Level]
    words: str
