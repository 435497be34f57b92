"""Where the equations jump at a value of the parameters, whatever the solution is: a branch ends there, and says so.

Functions of the parameters alone choose formulas by their signs. Where one changes its sign between two rows, points
of the branch are computed on both sides, ever closer: solutions that stay apart belong to equations that jump. A
corner, where they come together, is passed, and so is a jump of formulas that does not move the solution. Where
nothing lies across from the last point before, the rows beyond belong to something else. Where the jump is so large
that the corrector does not find the other side, the arm has ended before it, and the function lies just ahead. What
could not be computed is a note.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.ends.beside_jump import NARROW, WIDER, by_length, by_unknown
from contin.continuation.position import position
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.continuation.segment import Row, Segment
from contin.continuation.sentence import Sentence
from contin.linalg.vectors import norm

APART: Final = 3e-8  # scaled: points this close to each other have each other's errors
SAME: Final = 2.0  # distances of points on both sides of a jump do not grow by more; of a root's, fourfold
AHEAD: Final = 1e-6  # scaled: how far beyond the last row of a failed corrector a function changes its sign


def until_jump(segments: Iterable[Segment], arm: Arm, start: Array) -> Iterator[Segment]:
    """The segments of an arm up to a jump of its equations; then `arm.end` says so."""
    problem = arm.problem
    first = problem.choices(start[None])
    texts = first.texts
    if not texts:
        yield from segments
        return
    last, before, row = None, first.sides[0], start
    for segment in segments:
        if not len(segment.z):
            yield segment
            continue
        sides = np.vstack([before[None], problem.choices(segment.z).sides])
        unseen: list[Sentence] = []
        for k, j in np.argwhere(sides[:-1] != sides[1:]):
            found = _jump(arm, segment, int(k), int(j), row if k == 0 else segment.z[k - 1])
            if found is None:
                continue
            if isinstance(found, _Unseen):
                unseen.append(Sentence(found.words(problem, texts[j])))
                continue
            kept = [m for m in segment.found if m.before <= k or (m.before == k + 1 and found.is_before(problem, m))]
            notes = tuple(note for note in segment.notes if not note.corner)
            cut = replace(segment.cut(int(k), kept), notes=(*notes, *unseen), hiding=segment.hiding + len(unseen))
            yield cut
            yield Segment.single(found.limit, segment.scale)
            arm.end = _end(problem, texts[j], found.at)
            return
        yield replace(segment, notes=(*segment.notes, *unseen), hiding=segment.hiding + len(unseen))
        before, row, last = sides[-1], segment.z[-1], segment
    if last is not None and arm.end is not None and arm.end.reason == "corrector":
        arm.end = _just_ahead(problem, last) or arm.end


@dataclass(frozen=True, eq=False)
class _Met:
    """Function j changes its side at `at`; `limit`: the branch there, on the side that it comes from."""

    j: int
    at: Array
    limit: Sample

    def is_before(self, problem: Problem, mark: Row) -> bool:
        """True for a labelled point on that side."""
        here, there = problem.choices(np.array([mark.point.z, self.limit.z])).sides[:, self.j]
        return bool(here == there)


@dataclass(frozen=True, eq=False)
class _Unseen:
    """A sign change near row `near` beside which no point on the side that the branch comes from could be computed."""

    near: Array

    def words(self, problem: Problem, text: str) -> str:
        """The note."""
        return (
            f"before {position(problem, self.near)}, at {text}, the solution could not be computed: "
            "the rows beyond may belong to another branch"
        )


def _jump(arm: Arm, segment: Segment, k: int, j: int, row: Array) -> _Met | _Unseen | None:
    """What function j meets between `row` and row k of a segment; None where the solution does not jump."""
    problem, scale = arm.problem, segment.scale
    z = segment.z[k]
    pairs = by_unknown(problem, z, row, scale, j) or by_length(arm, segment, k, j, row)
    if pairs is None:
        return _Unseen(z)
    limit, beyond = pairs[0]
    near = Sample(limit, segment.tangents[k], np.empty(0), int(segment.unstable[k]), segment.eigenvalues[k])
    measured = problem.probe(near, 0.0, limit, Frame(scale), arm.course.settings)
    last = near if measured is None else replace(measured, z=limit)
    gaps = [norm((there - here) / scale) for here, there in pairs if there is not None]
    if beyond is None and not gaps:
        return _Met(j, limit, last)
    if beyond is None or len(gaps) < len(pairs):  # one distance alone tells no jump from a corner
        return _Unseen(z)
    if gaps[0] <= APART or gaps[-1] > SAME * gaps[0]:
        return None
    moved = beyond - limit
    share = problem.choices(np.array([limit, beyond])).share(j)
    return _Met(j, limit + np.where(np.abs(moved) <= WIDER * NARROW * scale, share * moved, 0.0), last)


def _just_ahead(problem: Problem, last: Segment) -> End | None:
    """The end at a function that changes its side just beyond the last row."""
    z = last.z[-1].copy()
    ahead = z + AHEAD * last.scale * last.tangents[-1]
    there = problem.choices(np.array([z, ahead]))
    for j in np.flatnonzero(there.sides[0] != there.sides[1]):
        return _end(problem, there.texts[j], z + (ahead - z) * there.share(int(j)))
    return None


def _end(problem: Problem, text: str, at: Array) -> End:
    words = f"at {position(problem, at)}, the equations jump at {text}"
    return End("surface", words, {"surface": text, "at": {problem.parameters[0]: float(at[-1])}})
