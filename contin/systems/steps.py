"""Iterates of a map one after the other: in one call of machine code for many of them, where there is some."""

from __future__ import annotations

from typing import Final, Protocol, runtime_checkable

import numpy as np

from contin.abi import Array
from contin.systems.protocol import System

AT_ONCE: Final = 256


@runtime_checkable
class Stepping(Protocol):
    """A system whose machine code takes several steps in one call."""

    def steps(self, points: Array, p: Array) -> None:
        """From points[0], the iterates points[1:]."""


def iterates(system: System, u: Array, p: Array, count: int, box: Array | float) -> Array:
    """u and its next `count` iterates, (count + 1, n), or up to the first one with a state beyond `box` (or NaN)."""
    points = np.empty((count + 1, int(system.n)))
    points[0] = u
    if not isinstance(system, Stepping):
        for k in range(count):
            points[k + 1] = x = system.value(points[k], p)
            if not (np.abs(x) <= box).all():
                return points[: k + 2]
        return points
    for first in range(0, count, AT_ONCE):
        part = points[first : first + AT_ONCE + 1]
        system.steps(part, p)
        outside = ~(np.abs(part[1:]) <= box).all(axis=1)
        if outside.any():
            return points[: first + 2 + int(np.argmax(outside))]
    return points
