"""How a branch leaves a branch point, in scaled unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class Outset:
    """z(s) = y + s direction + s^2 curvature / 2 + ...; or points on the branch where no order of terms tells it.

    beside : by arm, +1 along the direction and -1 the other half, a point (n + 1,) on the branch.
    """

    direction: Array
    curvature: Array
    beside: Mapping[int, Array] = field(default_factory=dict)
