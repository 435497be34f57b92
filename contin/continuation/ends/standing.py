"""Branches along which the parameters stand still: a continuum of solutions, none of which is isolated.

Oscillators that are not coupled at one parameter value have it, with any difference of their phases. Such a family
never ends, and what tells its points apart is rounding. Two of its multipliers are 1 all along, unlike those of a
canard explosion, in which the parameter stands still to rounding too. Curves of special points in two parameters lead
into lines of equilibria, as where two species compete alike: both parameters stand still there, and every point
satisfies the equations of a fold.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.problem import in_two_parameters
from contin.continuation.segment import Segment
from contin.linalg.vectors import norm

ROWS: Final = 400  # in succession at which the parameter stands still
STILL: Final = 1e-7  # of its scale: as far as it moves then
NEUTRAL: Final = 1e-4  # distance from 1 of two multipliers
EXACT: Final = 1e-12  # of their scales: as far as rounding moves the parameters of a curve of special points
FAR: Final = 1.0  # scaled distance that it goes while they stand still


def until_standing(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm, up to the one in which the parameters have stood still for long.

    Families that are born at a Hopf point of a system with a first integral know that they do so, and are followed.
    """
    if arm.problem.kind == "locus" and in_two_parameters(arm.problem):
        yield from _until_both_stand(segments, arm)
        return
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


def _until_both_stand(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """Up to the segment in which both parameters have stood still for a length of `FAR`."""
    at, way, last = np.full(2, np.nan), 0.0, np.empty(0)
    for segment in segments:
        widths, values = segment.scale[-2:], segment.z[:, -2:]
        if len(values) and not _rest(values, at, widths).any():  # mostly: a parameter moves in every step
            at, way, last = values[-1], 0.0, segment.z[-1]
            yield segment
            continue
        for z in segment.z:
            if np.all(np.abs(z[-2:] - at) <= EXACT * widths):
                way += norm((z - last) / segment.scale)
            else:
                at, way = z[-2:], 0.0
            last = z
        yield segment
        if way >= FAR and not arm.is_over():
            names = arm.problem.parameters
            near = dict(zip(names, (float(value) for value in at[::-1]), strict=True))
            place = ", ".join(f"{name} = {value:.6g}" for name, value in near.items())
            text = f"both parameters stand still at {place}: solutions are a continuum there, none is isolated"
            arm.end = End("degenerate", text, {"at": near})
            return


def _rest(values: Array, before: Array, widths: Array) -> NDArray[np.bool_]:
    """Rows (K,) at which both parameters (K, 2) are as at the row before."""
    moved = np.abs(np.diff(values, axis=0, prepend=before[None]))
    return np.asarray((moved <= EXACT * widths).all(axis=1))


def _is_neutral(multipliers: Vector) -> bool:
    return bool(np.sum(np.abs(multipliers - 1.0) <= NEUTRAL) >= 2)
