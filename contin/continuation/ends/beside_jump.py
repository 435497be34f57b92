"""Points of a branch on both sides of a value of the parameters at which a function changes its side.

With that parameter held where the function depends on it alone, by arclength otherwise; at two distances, so that a
jump can be told from a slope.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Frame, Sample
from contin.continuation.segment import Segment
from contin.linalg.vectors import norm

NARROW: Final = 1e-10  # arclength between the two nearest points on both sides,
WIDER: Final = 16.0  # ... and between the ones farther away, with which they are compared
LEAST_SLOPE: Final = 0.05  # of the parameter along the branch, scaled
REACH: Final = (1.0, 1.5, 2.5, 4.0)  # steps back from a row in which the row before is looked for
HALVINGS: Final = 60
ROUNDS: Final = 12  # of a search for the last point of a side
THOUSANDFOLD: Final = 10  # halvings in one of them
PARTS: Final = 24  # trials in which a solution is followed from a row to the sign change

Pair = tuple[Array, Array | None]  # points before and beyond a sign change; None: nothing lies across it


def by_unknown(problem: Problem, z: Array, row: Array, scale: Array, j: int) -> list[Pair] | None:
    """Points next to the sign change with one unknown held, where function j depends on that alone."""
    index = int(problem.choices(z[None]).alone[j])
    if index == 0:
        return None

    def side(value: float) -> float:
        moved = z.copy()
        moved[index] = value
        return float(problem.choices(moved[None]).sides[0, j])

    near, far = float(z[index]), float(row[index])
    here = side(far)
    if side(near) == here:
        return None
    for _ in range(HALVINGS):  # to the first change on the way from the row
        middle = 0.5 * (near + far)
        near, far = (near, middle) if side(middle) == here else (middle, far)
    pairs = []
    for width in (NARROW, WIDER * NARROW):
        step = np.copysign(width * scale[index], near - far)
        pair = _across(problem, index, (row, z), (far - step, near + step), scale)
        if pair is None:
            return None
        pairs.append(pair)
    return pairs


def _across(
    problem: Problem, index: int, rows: tuple[Array, Array], values: tuple[float, float], scale: Array
) -> Pair | None:
    """Points at two values of an unknown, each from the other or followed from the row on its side."""
    beyond = _followed(problem, index, rows[1], values[1], scale)
    limit = None if beyond is None else _held(problem, index, beyond, values[0], scale)
    if limit is not None:
        return limit, beyond
    if len(rows[0]) == len(rows[1]):
        limit = _followed(problem, index, rows[0], values[0], scale)
    if limit is None:
        return None
    return limit, _held(problem, index, limit, values[1], scale) if beyond is None else beyond


def _followed(problem: Problem, index: int, z: Array, value: float, scale: Array) -> Array | None:
    """The solution at a value of an unknown, followed from a row in parts that halve where they fail."""
    share = 1.0
    for _ in range(PARTS):
        to = value if share == 1.0 else float(z[index]) + share * (value - float(z[index]))
        found = _held(problem, index, z, to, scale)
        if found is not None and share == 1.0:
            return found
        z, share = (z, 0.5 * share) if found is None else (found, min(2.0 * share, 1.0))
    return None


def _held(problem: Problem, index: int, guess: Array, value: float, scale: Array) -> Array | None:
    """The solution next to a guess at which one of the parameters has this value."""
    if in_two_parameters(problem):
        return problem.at_unknown(index, guess, value, scale)
    return problem.at_parameter(guess, value, scale)


def by_length(arm: Arm, segment: Segment, k: int, j: int, row: Array) -> list[Pair] | None:
    """Such points by arclength back from row k."""
    scale = segment.scale
    base = Sample(segment.z[k], segment.tangents[k], np.empty(0), int(segment.unstable[k]), segment.eigenvalues[k])
    beside = _Beside(arm, scale, j)
    slope = max(abs(float(base.tangent[-1])), LEAST_SLOPE)
    step = abs(float(base.z[-1] - row[-1])) / float(scale[-1]) / slope
    there = beside.side(base)
    backs = (beside.at(base, -times * step) for times in REACH)
    far = next((sample for sample in backs if sample is not None and beside.side(sample) != there), None)
    if far is None:
        return None
    length = norm((base.z - far.z) / scale)
    before, behind = beside.last(far, length), beside.last(base, -length)
    pairs: list[Pair] = []
    for width in (NARROW, WIDER * NARROW):
        limit, beyond = beside.at(before, -width), beside.at(behind, width)
        if limit is None or beyond is None:
            return None
        pairs.append((limit.z, beyond.z))
    return pairs


@dataclass(frozen=True, eq=False)
class _Beside:
    """Points of a branch by arclength, and the side of function j that they are on."""

    arm: Arm
    scale: Array
    j: int

    def side(self, sample: Sample) -> float:
        return float(self.arm.problem.choices(sample.z[None]).sides[0, self.j])

    def at(self, base: Sample, length: float) -> Sample | None:
        guess = base.z + length * self.scale * base.tangent
        return self.arm.problem.probe(base, length, guess, Frame(self.scale), self.arm.course.settings)

    def last(self, base: Sample, length: float) -> Sample:
        """The last point of a side on the way from one: between both, hyperplanes may meet no branch, or two.

        From each point reached anew, for a point may also be missed where the branch is too bent.
        """
        side = self.side(base)
        for _ in range(ROUNDS):
            found, inside, outside = self.at(base, length), 0.0, length
            if found is not None and self.side(found) == side:
                base = found
                continue
            for _ in range(THOUSANDFOLD):
                middle = 0.5 * (inside + outside)
                found = self.at(base, middle)
                reached = found is not None and self.side(found) == side
                inside, outside = (middle, outside) if reached else (inside, middle)
            base = (self.at(base, inside) if inside else None) or base
            length = outside - inside
            if abs(length) <= NARROW:
                break
        return base
