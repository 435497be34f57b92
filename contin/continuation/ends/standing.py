"""Families of orbits along which the parameter stands still: a continuum of orbits, none of which is isolated.

Oscillators that are not coupled at one parameter value have it, with any difference of their phases. Such a family
never ends, and what tells its points apart is rounding. Two of its multipliers are 1 all along, unlike those of a
canard explosion, in which the parameter stands still to rounding too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np

from contin.abi import Vector
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.segment import Segment

ROWS: Final = 400  # in succession at which the parameter stands still
STILL: Final = 1e-7  # of its scale: as far as it moves then
NEUTRAL: Final = 1e-4  # distance from 1 of two multipliers


def until_standing(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm, up to the one in which the parameter has stood still for `ROWS` rows.

    Families that are born at a Hopf point of a system with a first integral know that they do so, and are followed.
    """
    if arm.problem.kind != "orbit" or arm.problem.may_stand:
        yield from segments
        return
    at, count = np.nan, 0
    for segment in segments:
        width = float(segment.scale[-1])
        values = segment.z[:, -1]
        if len(values) and not (np.abs(values - np.append(at, values[:-1])) <= STILL * width).any():
            at, count = float(values[-1]), 1  # mostly: the parameter moves in every step
        else:
            for here, multipliers in zip(values.tolist(), segment.eigenvalues, strict=True):
                if not (abs(here - at) <= STILL * width and _is_neutral(multipliers)):
                    at, count = here, 0
                count += 1
        yield segment
        if count >= ROWS and not arm.is_over():
            name = arm.problem.parameters[0]
            near = 0.0 if abs(at) <= STILL * width else at
            text = f"the orbits of this family all exist at {name} = {near:.6g}: they are a continuum, none is isolated"
            arm.end = End("degenerate", text, {"at": {name: at}})
            return


def _is_neutral(multipliers: Vector) -> bool:
    return bool(np.sum(np.abs(multipliers - 1.0) <= NEUTRAL) >= 2)
