"""Where the equations jump at a value of the parameters, whatever the solution is: a branch ends there, and says so.

Functions of the parameters alone choose formulas by their signs. Where one changes its sign between two rows, points of
the branch are computed on both sides, ever closer: solutions that stay apart belong to equations that jump. A corner,
where they come together, is passed, and so is a jump of formulas that does not move the solution. Where the jump is so
large that the corrector does not find the other side, the arm has ended before it, and the function lies just ahead.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.arm import JUMPS, Arm
from contin.continuation.branch import End
from contin.continuation.position import position
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Frame, Sample
from contin.continuation.segment import Row, Segment
from contin.linalg.vectors import norm

NARROW: Final = 1e-10  # arclength between the two nearest points on both sides,
WIDER: Final = 16.0  # ... and between the ones farther away, with which they are compared
APART: Final = 3e-8  # scaled: points this close to each other have each other's errors
SAME: Final = 2.0  # distances of points on both sides of a jump do not grow by more; of a root's, fourfold
LEAST_SLOPE: Final = 0.05  # of the parameter along the branch, scaled
REACH: Final = (1.0, 1.5, 2.5, 4.0)  # steps back from a row in which the row before is looked for
HALVINGS: Final = 60
AHEAD: Final = 1e-6  # scaled: how far beyond the last row of a failed corrector a function changes its sign


def until_jump(segments: Iterable[Segment], arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm up to a jump of its equations; then `arm.end` says so."""
    problem = arm.problem
    texts, values = problem.choices(start[None])
    if not texts:
        yield from segments
        return
    last, before, row = None, values[0], start
    for segment in segments:
        if not len(segment.z):
            yield segment
            continue
        _, values = problem.choices(segment.z)
        heights = np.vstack([before[None], values])
        for k, j in np.argwhere((heights[:-1] > 0.0) != (heights[1:] > 0.0)):
            found = _jump(arm, segment, int(k), int(j), row if k == 0 else segment.z[k - 1])
            if found is None:
                continue
            kept = [m for m in segment.found if m.before <= k or (m.before == k + 1 and found.is_before(problem, m))]
            notes = tuple(note for note in segment.notes if not note.startswith(JUMPS))
            yield replace(segment.cut(int(k), kept), notes=notes)
            yield Segment.single(found.limit, segment.scale)
            arm.end = _end(problem, texts[j], found.at)
            return
        yield segment
        before, row, last = values[-1], segment.z[-1], segment
    if last is not None and arm.end is not None and arm.end.reason == "corrector":
        arm.end = _just_ahead(problem, texts, last) or arm.end


@dataclass(frozen=True, eq=False)
class _Met:
    """Function j changes its sign at `at`; `limit`: the branch there, on the side that it comes from."""

    j: int
    at: Array
    limit: Sample
    below: bool  # the function is not positive on that side

    def is_before(self, problem: Problem, mark: Row) -> bool:
        """True for a labelled point on that side."""
        value = problem.choices(mark.point.z[None])[1][0, self.j]
        return bool((value > 0.0) != self.below)


def _jump(arm: Arm, segment: Segment, k: int, j: int, row: Array) -> _Met | None:
    """What function j meets between `row` and row k of a segment; None where the solution does not jump."""
    problem, scale = arm.problem, segment.scale
    z = segment.z[k]
    pairs = _by_unknown(problem, z, row, scale, j) or _by_length(arm, segment, k, j, row)
    if pairs is None:
        return None
    gaps = [norm((beyond - limit) / scale) for limit, beyond in pairs]
    if gaps[0] <= APART or gaps[1] > SAME * gaps[0]:
        return None
    limit, beyond = pairs[0]
    below, above = problem.choices(np.array([limit, beyond]))[1][:, j]
    share = below / (below - above) if below != above else 0.5
    moved = beyond - limit
    at = limit + np.where(np.abs(moved) <= WIDER * NARROW * scale, share * moved, 0.0)
    near = Sample(limit, segment.tangents[k], np.empty(0), int(segment.unstable[k]), segment.eigenvalues[k])
    measured = problem.probe(near, 0.0, limit, Frame(scale), arm.course.settings)
    return _Met(j, at, near if measured is None else replace(measured, z=limit), bool(below <= 0.0))


def _by_unknown(problem: Problem, z: Array, row: Array, scale: Array, j: int) -> list[tuple[Array, Array]] | None:
    """Points (before, beyond) next to the sign change with one unknown held, where function j depends on that alone."""
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
        beyond = _held(problem, index, z, near + step, scale)
        limit = None if beyond is None else _held(problem, index, beyond, far - step, scale)
        if beyond is None or limit is None:
            return None
        pairs.append((limit, beyond))
    return pairs


def _held(problem: Problem, index: int, guess: Array, value: float, scale: Array) -> Array | None:
    """The solution next to a guess at which one of the parameters has this value."""
    if in_two_parameters(problem):
        return problem.at_unknown(index, guess, value, scale)
    return problem.at_parameter(guess, value, scale)


def _by_length(arm: Arm, segment: Segment, k: int, j: int, row: Array) -> list[tuple[Array, Array]] | None:
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
    pairs = []
    for width in (NARROW, WIDER * NARROW):
        limit, beyond = at(far - width), at(near + width)
        if limit is None or beyond is None:
            return None
        pairs.append((limit[0], beyond[0]))
    return pairs


def _just_ahead(problem: Problem, texts: Iterable[str], last: Segment) -> End | None:
    """The end at a function that changes its sign just beyond the last row."""
    z = last.z[-1].copy()
    ahead = z + AHEAD * last.scale * last.tangents[-1]
    (_, here), (_, there) = problem.choices(z[None]), problem.choices(ahead[None])
    for text, a, b in zip(texts, here[0], there[0], strict=True):
        if (a > 0.0) != (b > 0.0):
            return _end(problem, text, z + (ahead - z) * a / (a - b))
    return None


def _end(problem: Problem, text: str, at: Array) -> End:
    words = f"at {position(problem, at)}, the equations jump at {text}, whatever the states are"
    return End("surface", words, {"surface": text, "at": {problem.parameters[0]: float(at[-1])}})
