"""What came of looking at a change: outcomes are data, and words are made of them at the edge."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.records import Record


@dataclass(frozen=True, eq=False)
class Verified:
    """A special point whose defining system was solved to full precision."""

    type: str
    z: Array
    residual: float
    error: float
    eigenvalues: NDArray[np.complex128]
    unstable: int  # critical ones not counted
    normal_form: Record = field(default_factory=dict)
    vectors: Record = field(default_factory=dict)
    also: tuple[str, ...] = ()
    remark: str = ""  # what could not be told about it, such as why its normal form is empty: a note of the branch
    touches: bool = False  # verified although its test need not change sign there: two branches with one tangent
    crowded: bool = False  # other eigenvalues are critical here too: more than this type may happen


@dataclass(frozen=True)
class Rejected:
    """No such point, and why; `suspect` where its defining system should have a solution and has none.

    A jump to another branch would explain that: the step is tried again with half the length.
    """

    reason: str
    suspect: bool = False
    defect: bool = False  # looking for it ended with an error that contin did not foresee


@dataclass(frozen=True)
class Nothing:
    """What changed is no event, such as a neutral saddle: nothing to label, and nothing to say."""


NOTHING: Final = Nothing()
Outcome = Verified | Rejected | Nothing


def unverified(type_: str, reason: str, defect: bool = False) -> Rejected:
    """The defining system of `type_` has no solution there."""
    return Rejected(f"{type_} not verified: {reason}", suspect=True, defect=defect)


class Failure(Enum):
    """Why Newton's method gave no point."""

    NOT_FINITE = "not finite"
    SINGULAR = "singular"
    DIVERGED = "diverged"
    NO_CONTRACTION = "no contraction"
    NO_CONVERGENCE = "no convergence"
    ELSEWHERE = "not the curve that the step set out on"


@dataclass(frozen=True, eq=False)
class Corner:
    """Where a branch turns sharply because the equations are not smooth, without a surface that anybody has named."""

    z: Array


@dataclass(frozen=True, eq=False)
class Jump:
    """Unstable values change by any number, for the equations are not smooth there: no special point, and no riddle."""

    text: str  # why
    at: Array | None = None  # exactly where, if that is known
