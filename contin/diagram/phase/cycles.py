"""Stable cycles of maps on which iteration settles, and which cycles are one up to a shift and the symmetries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.diagram.identity import copies, wrapped
from contin.diagram.sizes import length, sizes_among
from contin.errors import ContinError
from contin.problems.maps.cycle import CycleProblem
from contin.problems.symmetry import apply_symmetry, every_symmetry
from contin.search.equilibrium_from_guess import converge
from contin.systems.iterate import iterate
from contin.systems.steps import iterates

if TYPE_CHECKING:
    from contin.systems.protocol import System

FIRST, LAST = 600, 6_000  # steps after which a point is looked at, and after which it is wandering for good
LONGEST: Final = 64  # period up to which a cycle is looked for
SETTLED: Final = 1e-7  # of the states' sizes: how well a cycle repeats
FAR: Final = 1e8  # ... beyond which a point has escaped
REPEATS: Final = 1e-4  # ... distance of points of a cycle that are one
SAME: Final = 1e-6  # ... distance of two cycles that are one


def cycles_reached(
    problem: Any, known: Sequence[Array], value: float, starts: Sequence[Array]
) -> tuple[list[Seed], int, list[str]]:
    """Seeds of the stable cycles (and fixed points) on which `starts` settle, 1 where one wanders for ever, and why
    some cycles could not be solved for.

    known : (k n,) of cycles that need no seed.
    """
    p = problem.full_parameters(np.append(np.zeros(problem.n), value))[: len(problem.base)]
    periods = np.asarray(problem.angle_periods, dtype=float)
    found = list(known)
    seeds: list[Seed] = []
    aperiodic = 0
    failed: list[str] = []
    sizes = sizes_among(problem, [*known, *starts], value)
    for u in starts:
        end, steps = _settled(problem.system, u, p, periods, sizes)
        if end is None:
            continue
        if steps == 0:
            aperiodic = 1
            continue
        try:
            seed = converge(iterate(problem.system, steps), end, p, periods).seed(problem.parameters[0])
        except (ContinError, np.linalg.LinAlgError) as error:
            failed.append(str(error))
            continue
        if not any(is_one(seed.problem, seed.z, other) for other in found):
            found.append(seed.z[:-1])
            seeds.append(seed)
    return seeds, aperiodic, failed


def is_one(problem: Any, z: Array, other: Array) -> bool:
    """True where the cycles of z (k n + 1,) and `other` (k n,) are one, shifted or mirrored."""
    if other.size != z.size - 1:
        return False
    sizes = _sizes(problem, z)
    return any(
        length(wrapped(image[:-1] - other, problem.angle_periods), sizes) <= SAME for image, _ in copies(problem, z)
    )


def is_shorter(problem: object, z: Array) -> bool:
    """True where z repeats a cycle of fewer steps, as beside a period doubling."""
    if not isinstance(problem, CycleProblem):
        return False
    sizes = _sizes(problem, z)
    parts = [k for k in range(1, problem.period) if problem.period % k == 0]
    turned = (wrapped((problem.shifted(z, k) - z)[:-1], problem.angle_periods) for k in parts)
    return any(length(gap, sizes) <= REPEATS for gap in turned)


def distinct_images(problem: Any, z: Array) -> int:
    """How many cycles the declared symmetries make of one."""
    found = [z]
    for name in every_symmetry(problem):
        image = apply_symmetry(problem, name, z)[0]
        if not any(_is_shifted(problem, image, one) for one in found):
            found.append(image)
    return len(found)


def _is_shifted(problem: Any, z: Array, other: Array) -> bool:
    sizes = _sizes(problem, z)
    turns = problem.period if isinstance(problem, CycleProblem) else 1
    shifted = (problem.shifted(z, k) if k else z for k in range(turns))
    return any(length(wrapped((one - other)[:-1], problem.angle_periods), sizes) <= SAME for one in shifted)


def _sizes(problem: Any, z: Array) -> Array:
    """Of the states among the points of a cycle (k n + 1,), one for each unknown, (k n,)."""
    sizes = sizes_among(problem, [z[:-1]], float(z[-1]))
    return np.tile(sizes, (z.size - 1) // sizes.size)


def _settled(system: System, u: Array, p: Array, periods: Array, sizes: Array) -> tuple[Array | None, int]:
    """Where a point settles, and the period: 0 where it has none, (None, 0) where it escapes."""
    x = np.array(u, dtype=float)
    far = FAR * max(1.0, length(x, sizes)) * sizes
    done = 0
    for until in (FIRST, LAST):
        before = iterates(system, x, p, until - done, far)
        x = before[-1].copy()
        if len(before) <= until - done or not np.all(np.abs(x) <= far):
            return None, 0
        done = until
        path = iterates(system, x, p, LONGEST, np.inf)
        if len(path) <= LONGEST:
            return None, 0
        scale = length(path, sizes)
        for steps in range(1, LONGEST + 1):
            if length(wrapped(path[steps] - x, periods), sizes) <= SETTLED * scale:
                return x, steps
    return x, 0
