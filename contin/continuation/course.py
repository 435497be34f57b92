"""What an arm heeds wherever it is, and what lies just behind it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from contin.abi import Array
from contin.continuation.location.sameness import same_point
from contin.continuation.location.targets import Wanted
from contin.continuation.outcome import Verified
from contin.continuation.position import position
from contin.continuation.problem import Problem
from contin.continuation.settings import Settings


@dataclass(frozen=True, eq=False)
class Behind:
    """A labelled point in the step that led to a chunk's first row, and its arclength along the tangent there (< 0)."""

    point: Verified
    length: float


@dataclass(frozen=True, eq=False)
class Course:
    """What an arm heeds wherever it is."""

    problem: Problem
    bounds: tuple[float, float]
    settings: Settings
    targets: Sequence[Wanted] = ()
    known: list[Verified] = field(default_factory=list)  # points already labelled, so that none is labelled twice
    symmetries: tuple[str, ...] = ()  # broken at the branch's birth: where it meets its own image, it is complete
    foundling: bool = False  # no other branch has the branch point at which it meets its own image as a label
    met: list[Verified] = field(default_factory=list)  # known points that were located again

    def is_known(self, point: Verified, scale: Array) -> bool:
        """True for a point that is labelled already."""
        label = next((k for k in self.known if same_point(self.problem, point, k, scale)), None)
        if label is not None:
            self.met.append(label)
        return label is not None

    def position(self, z: Array) -> str:
        """In words."""
        return position(self.problem, z)
