"""Orbits at which several multipliers are critical at once: what is born there is refused, in words."""

from __future__ import annotations

from contin.continuation.branch import SpecialPoint
from contin.errors import InputError


def refuse_several(point: SpecialPoint, what: str) -> None:
    """InputError where more than one multiplier (or pair) is critical, as symmetries make them."""
    count = int(point.vectors.get("kernel", 1))
    if count > 1:
        pairs = "pairs of multipliers are on the unit circle" if point.type == "NS" else "multipliers are critical"
        raise InputError(f"{point.branch}.{point.label}: {count} {pairs} at once: {what}")
