"""What a curve of special solutions holds at zero beside its equations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from contin.abi import Array
from contin.loci.augmented.elimination import Scalars

if TYPE_CHECKING:
    from contin.loci.augmented.augmented_curve import AugmentedCurve


class Held(Protocol):
    """One or more scalars."""

    @property
    def text(self) -> str:
        """What vanishes, in words."""

    def near(self, problem: AugmentedCurve, z: Array, scale: Array) -> Scalars:
        """The scalars as smooth functions around z, with borders and references from there."""


def joined(held: tuple[Held, ...], problem: AugmentedCurve, z: Array, scale: Array) -> Scalars:
    """All scalars near z as one function."""
    parts = [one.near(problem, z, scale) for one in held]
    if len(parts) == 1:
        return parts[0]

    def values(at: Array) -> Array:
        return np.concatenate([part(at) for part in parts]) if parts else np.zeros(0)

    return values
