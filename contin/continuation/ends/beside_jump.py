"""Points of a branch on both sides of a value of the parameters at which a function changes its sign.

With that parameter held where the function depends on it alone, by arclength otherwise; at two distances, so that a
jump can be told from a slope.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Frame, Sample
from contin.continuation.segment import Segment

NARROW: Final = 1e-10  # arclength between the two nearest points on both sides,
WIDER: Final = 16.0  # ... and between the ones farther away, with which they are compared
LEAST_SLOPE: Final = 0.05  # of the parameter along the branch, scaled
REACH: Final = (1.0, 1.5, 2.5, 4.0)  # steps back from a row in which the row before is looked for
HALVINGS: Final = 60
PARTS: Final = 24  # trials in which a solution is followed from a row to the sign change

Pair = tuple[Array, Array | None]  # points before and beyond a sign change; None: nothing lies across it


def by_unknown(problem: Problem, z: Array, row: Array, scale: Array, j: int) -> list[Pair] | None:
    """Points next to the sign change with one unknown held, where function j depends on that alone."""
    walls = [wall[0] for wall in problem.walls] if in_two_parameters(problem) else [-1]
    counted = [index - len(z) if index >= 0 else index for index in walls]  # from the end: meshes may differ

    def height(index: int, value: float) -> float:
        moved = z.copy()
        moved[index] = value
        return float(problem.choices(moved[None])[1][0, j])

    there = height(-1, float(z[-1])) > 0.0
    index = next((i for i in counted if (height(i, float(row[i])) > 0.0) != there), None)
    if index is None:
        return None
    near, far = float(z[index]), float(row[index])
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        near, far = (middle, far) if (height(index, middle) > 0.0) == there else (near, middle)
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
    problem, frame = arm.problem, Frame(segment.scale)
    base = Sample(segment.z[k], segment.tangents[k], np.empty(0), int(segment.unstable[k]), segment.eigenvalues[k])

    def at(length: float) -> tuple[Array, float] | None:
        guess = base.z + length * segment.scale * base.tangent
        found = problem.probe(base, length, guess, frame, arm.course.settings)
        return None if found is None else (found.z, float(problem.choices(found.z[None])[1][0, j]))

    there = bool(problem.choices(base.z[None])[1][0, j] > 0.0)
    slope = max(abs(float(base.tangent[-1])), LEAST_SLOPE)
    step = abs(float(base.z[-1] - row[-1])) / float(segment.scale[-1]) / slope
    backs = ((-times * step, at(-times * step)) for times in REACH)
    near, far = 0.0, next((length for length, b in backs if b is not None and (b[1] > 0.0) != there), None)
    if far is None:
        return None
    for _ in range(HALVINGS):
        if abs(near - far) <= NARROW:
            break
        middle = 0.5 * (near + far)
        found = at(middle)
        if found is None:
            return None
        near, far = (middle, far) if (found[1] > 0.0) == there else (near, middle)
    pairs: list[Pair] = []
    for width in (NARROW, WIDER * NARROW):
        limit, beyond = at(far - width), at(near + width)
        if limit is None or beyond is None:
            return None
        pairs.append((limit[0], beyond[0]))
    return pairs
