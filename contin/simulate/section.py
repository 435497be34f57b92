"""A plane that trajectories cross."""

from dataclasses import dataclass

from contin.abi import Array


@dataclass(frozen=True, eq=False)
class Section:
    """The plane normal . u = offset; crossings upwards (direction 1), downwards (-1) or both (0)."""

    normal: Array
    offset: float
    direction: int = 1
