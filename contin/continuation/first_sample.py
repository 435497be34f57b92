"""The sample that a branch starts from, and the special points that the start coincides with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found, Note
from contin.continuation.location.isolate import isolate
from contin.continuation.location.sameness import same_point
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import NotFiniteError

NEAR_START = 1e-3  # half-width, in steps, of the interval around a start that is searched for special points


def first_sample(
    seed: Seed, scale: Array, settings: Settings
) -> tuple[Sample, list[Found | Note], tuple[Sample, Sample] | tuple[()]]:
    """The start with tangent and tests, the special points that it coincides with, and what could not be told there.

    Last, the samples on both sides of it between which these were looked for.
    """
    problem = seed.problem
    if seed.born:
        assert seed.direction is not None
        empty = np.full(4, np.nan)
        return Sample(seed.z, seed.direction, empty, 0, np.empty(0, complex)), [], ()
    tangents = problem.tangents(seed.z, scale)
    tangent = max(tangents, key=lambda t: abs(t[-1]))
    base = Sample(seed.z, _up(tangent), np.full(4, np.nan), 0, np.empty(0, complex))
    frame = Frame(scale)
    measured = problem.probe(base, 0.0, seed.z, frame, settings)
    if measured is not None and len(tangents) == 1:
        start = replace(measured, z=seed.z, tangent=_up(measured.tangent))
        if not _suspicious(start):
            return start, [], ()
    width = NEAR_START * settings.first_step
    for _ in range(8):
        a = problem.probe(base, -width, seed.z - width * scale * base.tangent, frame, settings)
        b = problem.probe(base, width, seed.z + width * scale * base.tangent, frame, settings)
        if a is not None and b is not None:
            break
        width *= 4
    else:
        raise NotFiniteError(f"the branch cannot be followed from the start. {problem.describe_failure(seed.z)}")
    stretch = Stretch(problem, base, frame, settings)
    return replace(b, z=seed.z, tangent=base.tangent), _once(problem, isolate(stretch, a, b), scale), (a, b)


def _once(problem: Problem, items: Iterable[Found | Note], scale: Array) -> list[Found | Note]:
    """Each point once: where several coincide, a search between them may come to one from either side."""
    kept: list[Found | Note] = []
    for item in items:
        points = [other.point for other in kept if isinstance(other, Found)]
        if isinstance(item, Note) or not any(same_point(problem, item.point, point, scale) for point in points):
            kept.append(item)
    return kept


def _suspicious(start: Sample) -> bool:
    """A start at or next to a special point: look on both sides of it."""
    size = np.abs(start.eigenvalues)
    largest = float(size.max()) if size.size else 0.0
    return bool(
        abs(start.tangent[-1]) < 1e-3
        or np.any(np.abs(start.tests[2:]) < 1e-4)
        or (largest > 0 and float(np.abs(start.eigenvalues.real).min()) < 1e-4 * largest)
        or (largest == 0.0)
    )


def _up(tangent: Array) -> Array:
    """Oriented with the parameter; at a fold with the first unknown that moves."""
    leading = tangent[-1] if abs(tangent[-1]) > 1e-7 else tangent[np.flatnonzero(np.abs(tangent) > 1e-7)[0]]
    return tangent if leading > 0 else -tangent
