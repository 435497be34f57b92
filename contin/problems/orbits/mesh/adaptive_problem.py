"""What mesh adaption needs of a problem, whether its solutions are periodic or not."""

from __future__ import annotations

from typing import Protocol

from contin.abi import Array
from contin.problems.orbits.mesh.layout import Profile


class Meshed(Protocol):
    """Solutions by collocation, z as in `contin.problems.orbits.mesh.layout`."""

    @property
    def n(self) -> int:
        """Number of functions."""

    @property
    def tolerance(self) -> float:
        """Of the error inside an interval, relative to the functions' sizes."""

    @property
    def intervals(self) -> int | None:
        """Their number where it is fixed."""

    @property
    def closed(self) -> bool:
        """Whether solutions are periodic."""

    @property
    def state_periods(self) -> Array:
        """Period of each function (n,), 0 where it is not an angle."""

    def profile(self, z: Array) -> Profile:
        """The solution over [0, 1]."""

    def laid(self, h: Array, profile: Profile) -> Array:
        """The mesh h with the places among its nodes where the equations change formula; h itself where it has them."""
