"""Where a branch starts, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.problem import Problem


@dataclass(frozen=True, eq=False, repr=False)
class Seed:
    """Where a branch starts.

    `direction` and `scale` are given for branches born at a special point: the unit tangent there in scaled unknowns.
    `curvature` is the second-order term of the branch: z(s) = z + scale * (s direction + s^2 curvature / 2).
    `arms` are the senses to follow: -1 against, +1 along the direction (or the parameter, at an ordinary start).
    """

    problem: Problem
    z: Array
    direction: Array | None = None
    curvature: Array | None = None
    scale: Array | None = None
    arms: tuple[int, ...] = (-1, 1)
    parent: Parent | None = None
    symmetries: tuple[str, ...] = ()  # declared symmetries that map one half of the new branch onto the other
    reach: float | None = None  # a scaled distance from z at which the branch is told from its neighbours
    beside: Mapping[int, Array] = field(default_factory=dict)  # by arm: a point on it, where no order of terms tells it
    measured: tuple[int, NDArray[np.complex128]] | None = None  # unstable count and eigenvalues at z, where known
    remarks: tuple[str, ...] = ()  # about the start: notes of the branch
    passing: bool = False  # on the way to what its end is for: whether rows are of one branch is not asked

    def __repr__(self) -> str:
        born = f" born at {self.parent.branch}.{self.parent.label}" if self.parent is not None else ""
        varied = " and ".join(getattr(self.problem, "parameters", ()))
        return f"<start of a branch of kind {self.problem.kind!r} in {varied}{born}>"

    @property
    def born(self) -> bool:
        return self.direction is not None
