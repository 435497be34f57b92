"""Pairs of events next to a bound or to the start, where no further row tells of them: points beyond stand for it.

Between two rows with equal signs a pair shows only in a third row: a test is lowest at the one in the middle. Behind a
bound or the last step that is allowed, and before the start, the branch has no rows, so one point of it is computed
there, and what is found beyond the end is dropped. Nothing is looked for where the equations have no value beyond.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np

from contin.continuation.curve import Stretch
from contin.continuation.location.dips import dips, resolve_dip
from contin.continuation.location.found import Found, Note
from contin.continuation.location.isolate import isolate
from contin.continuation.problem import in_two_parameters
from contin.continuation.sample import Sample, opposite
from contin.errors import InputError, NotFiniteError
from contin.linalg.vectors import dot

WITHIN: Final = (0.02, 0.1, 0.25, 0.5, 0.75)  # parts of the first step
MANY: Final = 1000  # unknowns
ROUNDED: Final = 1e-8  # relative change of a test that may be the error of eigenvalues that are found by iteration
AHEAD: Final = 0.5  # cosine of the tangents at a point beyond an end and at the last row
EXACT: Final = ("equilibrium", "fixed-point", "algebraic")  # kinds that are looked at beyond a bound for little


def after_start(stretch: Stretch, first: Sample, second: Sample | None) -> Iterator[Found | Note]:
    """What lies between the start (`stretch.base`) and the first row behind a test that is low at the start.

    Of many unknowns the second row, where there is one, has to say so, too: a point before the start costs a step.
    Tests of points of codimension two are relative to their own terms, beside a zero only they change, and no row
    before the start has made the first step shorter for that: points within it are looked at.
    """
    start = stretch.base
    if _changes(start, first) or not _may_dip(start, first):
        return
    if len(start.z) > MANY and second is not None and not _falls(stretch, start, first, second):
        return
    beyond = _on_from(stretch, start, -stretch.distance(start, first))
    within = stretch.several(start, first, WITHIN) if in_two_parameters(stretch.problem) else ()
    points = [s for s in (beyond, start, *within, first) if s is not None]
    found: list[Found | Note] = []
    for low, here, high in zip(points, points[1:], points[2:], strict=False):
        for test in dips(stretch, low, here, high):
            found += resolve_dip(stretch, low, here, high, test)
    for low, high in pairwise(points if beyond is None else points[1:]):
        if _changes(low, high):
            found += isolate(stretch, low, high)
    yield from (item for item in found if _length(stretch, item, 0.0) >= 0.0)


def before_end(stretch: Stretch, earlier: Sample | None, last: Sample, marched: Sample) -> Iterator[Found | Note]:
    """What the step from `stretch.base` to `last`, at an end of the arm, may hide; with what lies beyond that end.

    earlier : the row before `stretch.base`.  marched : the row beyond the end.
    """
    base = stretch.base
    triples = [] if earlier is None else [(earlier, base, last)]
    if stretch.distance(last, marched) > 0.0:
        triples += [] if earlier is None else [(earlier, base, marched)]
        triples += [(base, last, marched)]
    looked: set[int] = set()
    for low, here, high in triples:
        for test in dips(stretch, low, here, high):
            if test not in looked:
                looked.add(test)
                yield from resolve_dip(stretch, low, here, high, test)
    if _may_dip(marched, base):
        further = _on_from(stretch, marched, stretch.distance(base, marched))
        for test in [] if further is None else dips(stretch, base, marched, further):
            if test not in looked and further is not None:
                yield from resolve_dip(stretch, base, marched, further, test)
    if stretch.problem.kind in EXACT and _changes(last, marched) and not _changes(base, last):
        yield from (item for item in isolate(stretch, base, marched) if isinstance(item, Found))


def before_last(stretch: Stretch, last: Sample) -> Iterator[Found | Note]:
    """What the step from `stretch.base` to `last`, beyond which no step is allowed, may hide behind a low test."""
    if not _may_dip(last, stretch.base):
        return
    further = _on_from(stretch, last, stretch.distance(stretch.base, last))
    for test in [] if further is None else dips(stretch, stretch.base, last, further):
        for item in resolve_dip(stretch, stretch.base, last, further, test) if further is not None else ():
            if _length(stretch, item, 0.0) <= stretch.length_of(last):
                yield item


def _may_dip(here: Sample, row: Sample) -> bool:
    """True where a test is lower here than at a row, with the same sign: the other side of it decides."""
    here_, row_ = here.tests, row.tests
    return here_.shape == row_.shape and bool(np.any((here_ * row_ > 0.0) & (np.abs(here_) < np.abs(row_))))


def _falls(stretch: Stretch, start: Sample, first: Sample, second: Sample) -> bool:
    """True where a test is lower at the start than at the first row, and falls in size behind it by the parabola of
    three rows' values; by more than rounding: of what is planted or symmetric, multipliers do not move at all.
    """
    if not start.tests.shape == first.tests.shape == second.tests.shape:
        return True
    h, k = stretch.distance(start, first), stretch.distance(start, second)
    if not 0.0 < h < k:
        return True
    a, b = (first.tests - start.tests) / h, (second.tests - start.tests) / k
    slopes, least = (a * k - b * h) / (k - h) * np.sign(start.tests), ROUNDED * np.abs(start.tests)
    lower = (start.tests * first.tests > 0.0) & (np.abs(first.tests) - np.abs(start.tests) > least)
    return bool(np.any(lower & (slopes * h < -least)))


def _changes(a: Sample, b: Sample) -> bool:
    """True where a test changes its sign between two points, or the number of unstable eigenvalues does."""
    return a.unstable != b.unstable or a.tests.shape != b.tests.shape or bool(np.any(opposite(a.tests, b.tests)))


def _on_from(stretch: Stretch, row: Sample, length: float) -> Sample | None:
    """The point of the branch at a length along a row's tangent; None where it is not found, or has no value."""
    guess = row.z + length * stretch.frame.scale * row.tangent
    try:
        found = stretch.problem.probe(row, length, guess, stretch.frame, stretch.settings)
    except (InputError, NotFiniteError):  # the equations' domain ends there
        return None
    near = found is not None and stretch.distance(row, found) <= 2.0 * abs(length)
    return found if near and found is not None and dot(found.tangent, row.tangent) > AHEAD else None


def _length(stretch: Stretch, item: Found | Note, unknown: float) -> float:
    """Arclength of an item along the stretch; `unknown` where a note has no place."""
    if isinstance(item, Found):
        return item.length
    place = item.place
    if place is None or place.shape != stretch.base.z.shape:
        return unknown
    return dot(stretch.base.tangent, (place - stretch.base.z) / stretch.frame.scale)
