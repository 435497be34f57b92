"""A plane that trajectories cross."""

from dataclasses import dataclass

import numpy as np

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class Section:
    """The plane normal . u = offset; crossings upwards (direction 1), downwards (-1) or both (0)."""

    normal: Array
    offset: float
    direction: int = 1


def plane_of(section: Section | None, n: int) -> Array:
    """(normal, offset, direction) as kernels take it, (n + 2,); zeros without a section."""
    if section is None:
        return np.zeros(n + 2)
    return np.concatenate([section.normal, [section.offset, section.direction]])
